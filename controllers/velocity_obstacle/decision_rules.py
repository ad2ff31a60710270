"""Decision rules (26)-(31) of the velocity-obstacle paper: straight, lane change or autonomous.

The rules look at four gaps: to the vehicles ahead and behind in the ego's lane and in an adjacent one,
and compare each with the least gap ``G_min = standstill gap + headway * v``. Without a neighbour, the gap is
infinite.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from controllers.interface import Neighbour, NeighbourGaps


class Reading(StrEnum):
    """How the conditions of the rules are read."""

    ADAPTED = "adapted"
    """One short gap in a lane is enough."""
    PRINTED = "printed"
    """Both gaps in a lane have to be short, as in the paper."""


class Rule(StrEnum):
    """The decision rules (26)-(31) of the velocity-obstacle paper."""

    STRAIGHT = "straight"
    LANE_CHANGE = "lane_change"
    AUTONOMOUS = "autonomous"


@dataclass(frozen=True, slots=True)
class LaneGaps:
    """The neighbours that one possible lane change involves, and the side it goes to (+1 left, −1 right)."""

    side: int
    ahead: Neighbour | None
    behind: Neighbour | None
    adjacent_ahead: Neighbour | None
    adjacent_behind: Neighbour | None


def towards(gaps: NeighbourGaps, side: int) -> LaneGaps:
    """Return the gaps that a change to the left (+1) or right (−1) involves."""
    if side > 0:
        return LaneGaps(side, gaps.ahead, gaps.behind, gaps.left_ahead, gaps.left_behind)
    return LaneGaps(side, gaps.ahead, gaps.behind, gaps.right_ahead, gaps.right_behind)


def least_gap(speed: float, standstill_gap: float, headway: float) -> float:
    """Return ``G_min = standstill_gap + headway * speed`` [m].

    >>> least_gap(10.0, 2.5, 1.0)
    12.5
    """
    return standstill_gap + headway * speed


def rule(gaps: LaneGaps, g_min: float) -> Rule:
    """Return which of the three rules holds for one adjacent lane.

    STRAIGHT when the adjacent lane has no room: its front gap or its rear gap is at most ``g_min``.
    LANE CHANGE when the ego's own lane has no room, ahead or behind, and the adjacent one does.
    AUTONOMOUS otherwise: both are possible, and the cheaper one is taken.

    Parameters
    ----------
    gaps
        The four neighbours.
    g_min
        Least gap [m].

    Notes
    -----
    Eqs. (26)-(31) of [VOMPC2019]_ ask for both adjacent gaps to be short before they rule the change
    out, and for both gaps of the ego's lane before they demand it; see :func:`printed_rule`. One short gap in
    the other lane already makes a change unsafe, and one in the ego's lane is reason enough to look for
    another lane, so one short gap is enough here.
    """
    if _short(gaps.adjacent_ahead, g_min) or _short(gaps.adjacent_behind, g_min):
        return Rule.STRAIGHT
    if _short(gaps.ahead, g_min) or _short(gaps.behind, g_min):
        return Rule.LANE_CHANGE
    return Rule.AUTONOMOUS


def printed_rule(gaps: LaneGaps, g_min: float) -> Rule:
    """Return which rule holds with the conditions as they are printed.

    STRAIGHT when both gaps of the adjacent lane are at most ``g_min``, LANE CHANGE when both gaps of the
    ego's lane are and neither gap of the adjacent lane is, AUTONOMOUS otherwise.

    Parameters
    ----------
    gaps, g_min
        As for :func:`rule`.

    Notes
    -----
    Eqs. (26)-(31) of [VOMPC2019]_. The printed conditions count a gap of exactly ``g_min`` both as short and
    as not short; here it counts as short.
    """
    adjacent = [_short(gaps.adjacent_ahead, g_min), _short(gaps.adjacent_behind, g_min)]
    if all(adjacent):
        return Rule.STRAIGHT
    if _short(gaps.ahead, g_min) and _short(gaps.behind, g_min) and not any(adjacent):
        return Rule.LANE_CHANGE
    return Rule.AUTONOMOUS


def _short(neighbour: Neighbour | None, g_min: float) -> bool:
    return neighbour is not None and neighbour.gap <= g_min
