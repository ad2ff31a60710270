"""Crossings to be kept clear: where to stop so that the ego does not stand on one."""

from __future__ import annotations

from collections.abc import Container, Iterator

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray, IntArray
from controllers.interface import Body, Crossing, Perception

STANDS_FOR = 1.0
"""An ego that would stand on a crossing for longer than this stops before it [s]."""
KEEP_CLEAR_BRAKING = 2.5
"""The ego keeps a crossing clear if braking no harder than this is enough [m/s^2]."""
ROOM_BEYOND = 0.5
"""Distance between the rear bumper and a crossing that is clear [m]."""
AT_THE_LINE = 0.5
"""An ego that stops this far beyond the stop line has still stopped at it [m]."""
BEGUN = 4.0
"""Once it brakes for that, it goes on if this is enough: a smooth plan brakes less at first [m/s^2]."""


def keep_clear_line(
    perception: Perception,
    times: FloatArray,
    leader_rest: FloatArray,
    gap: float,
    begun: Container[str] = (),
) -> tuple[float, str]:
    """Return where to stop for a crossing that has no room for the ego beyond it, and its name; inf for none.

    Parameters
    ----------
    perception
        What the ego is told.
    times, leader_rest
        Times, and where the rear bumper of the vehicle ahead could come to rest if it braked hard from then
        on; inf for no vehicle [s, m].
    gap
        Gap kept to that vehicle at a standstill [m].
    begun
        Names of the crossings that the ego brakes for already.
    """
    speed = max(perception.ego.speed, 3.0)
    for crossing, line, beyond in _avoidable(perception, begun):
        room = max(line - perception.ego.body.front, 0.0)
        if np.interp(room / speed, times, leader_rest) - gap < beyond:
            return line, crossing.name
    return float("inf"), ""


def keep_clear_of_people(
    perception: Perception, who: IntArray, along: FloatArray, places: FloatArray, until: FloatArray
) -> float:
    """Return where to stop for a crossing on which the ego would stand for people; inf for none.

    They are beyond the crossing, or beside it where they wait for something other than the ego.

    Parameters
    ----------
    perception
        What the ego is told.
    who, along, places, until
        Indices and places of the pedestrians who are let pass, places where the front bumper stops for them,
        and times until which it has to, shape (n,) [-, m, m, s].
    """
    body, speed = perception.ego.body, max(perception.ego.speed, 3.0)
    beside = _waits_for_others(perception)[who]
    for crossing, line, beyond in _avoidable(perception, ()):
        there = (beyond - body.front) / speed
        in_the_way = (along > crossing.exit) | (beside & (places > crossing.entry))
        if (in_the_way & (places < beyond) & (until > there + STANDS_FOR)).any():
            return line
    return float("inf")


def waiting_places(perception: Perception) -> list[float]:
    """Return where the front bumper waits for people at each crossing [m].

    This is before its stop line, or before that of an earlier crossing on which the body would stand.
    """
    body, found = perception.ego.body, list[float]()
    for number, crossing in enumerate(perception.road.crossings):
        place = crossing.stop_line
        for earlier, its_place in zip(perception.road.crossings[:number][::-1], found[::-1], strict=True):
            if body.front <= earlier.entry and place < _beyond(earlier, body):
                place = its_place
                break
        found.append(place)
    return found


def _beyond(crossing: Crossing, body: Body) -> float:
    """Return from where on the front bumper leaves room for the whole body beyond a crossing [m]."""
    return crossing.exit + body.length + ROOM_BEYOND


def _waits_for_others(perception: Perception) -> NDArray[np.bool_]:
    """Return who waits for lights, or for a crossing that the ego does not come to, shape (n,).

    Whoever waits for the ego stays until it has gone, so stopping for them ends nothing.
    """
    people, crossings = perception.pedestrians, perception.road.crossings
    red = np.array([crossing.pedestrians_have_green is False for crossing in crossings] + [True])
    return np.asarray(people.waiting & red[people.crossing])  # the last is for -1, no crossing of the ego's


def _avoidable(perception: Perception, begun: Container[str]) -> Iterator[tuple[Crossing, float, float]]:
    """Yield the crossings that the ego can stop before, with two places [m].

    The front bumper stops at the first: the stop line, or the crossing itself if the ego is past the line.
    From the second on, it leaves room for the whole body beyond the crossing.
    """
    ego, body = perception.ego, perception.ego.body
    for crossing in perception.road.crossings:
        if body.front > crossing.entry:
            continue
        past = crossing.stop_line < body.front - AT_THE_LINE
        line = crossing.entry if past else crossing.stop_line
        room = line - body.front if past else max(line - body.front, 0.0) + AT_THE_LINE
        braking = BEGUN if crossing.name in begun else KEEP_CLEAR_BRAKING
        if ego.speed**2 / (2.0 * braking) + 0.3 * ego.speed <= room:
            yield crossing, line, _beyond(crossing, body)
