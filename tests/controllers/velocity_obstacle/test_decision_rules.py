"""The table of the decision rules, and where its borders lie."""

from __future__ import annotations

from itertools import product

import pytest

from controllers.interface import Neighbour, NeighbourGaps
from controllers.velocity_obstacle.decision_rules import (
    LaneGaps,
    Rule,
    least_gap,
    printed_rule,
    rule,
    towards,
)

G_MIN = 12.5


def _neighbour(gap: float | None, name: str = "car") -> Neighbour | None:
    return None if gap is None else Neighbour(name, gap, 10.0, 0.0, 4.5)


@pytest.mark.parametrize(
    ("ahead", "behind", "adjacent_ahead", "adjacent_behind"), list(product([True, False], repeat=4))
)
def test_each_of_the_sixteen_combinations_of_gaps_has_its_rule(
    ahead: bool, behind: bool, adjacent_ahead: bool, adjacent_behind: bool
) -> None:
    """True means room: a longer gap than the least one."""
    gaps = [_neighbour(30.0 if room else 5.0) for room in (ahead, behind, adjacent_ahead, adjacent_behind)]
    if not (adjacent_ahead and adjacent_behind):
        expected = Rule.STRAIGHT
    elif ahead and behind:
        expected = Rule.AUTONOMOUS
    else:
        expected = Rule.LANE_CHANGE
    assert rule(LaneGaps(1, *gaps), G_MIN) is expected


def test_nobody_is_as_far_away_as_one_could_wish() -> None:
    assert rule(LaneGaps(1, None, None, None, None), G_MIN) is Rule.AUTONOMOUS
    assert rule(LaneGaps(1, _neighbour(5.0), None, None, None), G_MIN) is Rule.LANE_CHANGE


def test_a_gap_of_exactly_the_least_one_is_short_and_so_is_an_overlap() -> None:
    for gap, expected in ((G_MIN, Rule.STRAIGHT), (-2.0, Rule.STRAIGHT), (G_MIN + 1e-9, Rule.AUTONOMOUS)):
        assert rule(LaneGaps(1, None, None, _neighbour(gap), None), G_MIN) is expected


def test_the_gaps_of_a_side_are_those_of_that_side() -> None:
    names = ("ahead", "behind", "left_ahead", "left_behind", "right_ahead", "right_behind")
    gaps = NeighbourGaps(*(_neighbour(9.0, name) for name in names))
    for side, prefix in ((1, "left"), (-1, "right")):
        found = towards(gaps, side)
        assert found.side == side
        assert found.ahead is gaps.ahead
        assert found.behind is gaps.behind
        assert found.adjacent_ahead is not None
        assert found.adjacent_ahead.name == f"{prefix}_ahead"
        assert found.adjacent_behind is not None
        assert found.adjacent_behind.name == f"{prefix}_behind"


def test_the_least_gap_grows_with_the_headway() -> None:
    assert least_gap(0.0, 2.5, 1.0) == 2.5
    assert least_gap(13.0, 2.5, 1.2) == pytest.approx(18.1)


@pytest.mark.parametrize(
    ("ahead", "behind", "adjacent_ahead", "adjacent_behind"), list(product([True, False], repeat=4))
)
def test_as_printed_both_gaps_of_a_lane_have_to_be_short(
    ahead: bool, behind: bool, adjacent_ahead: bool, adjacent_behind: bool
) -> None:
    """True means room."""
    gaps = [_neighbour(30.0 if room else 5.0) for room in (ahead, behind, adjacent_ahead, adjacent_behind)]
    if not adjacent_ahead and not adjacent_behind:
        expected = Rule.STRAIGHT
    elif not ahead and not behind and adjacent_ahead and adjacent_behind:
        expected = Rule.LANE_CHANGE
    else:
        expected = Rule.AUTONOMOUS
    assert printed_rule(LaneGaps(1, *gaps), G_MIN) is expected
