"""An ego that people keep from starting leaves at walking pace, where that brings it nearer to nobody."""

from __future__ import annotations

import numpy as np
import pytest

from controllers.interface import Body, Perception
from controllers.prediction.discs import discs
from controllers.safety.last_check import WAY_OUT
from controllers.safety.way_out import SPEED, way_out
from cosim.toy_world import ToyRoad, walk
from tests.controllers.scenes import Car, Walker, ego, perception, straight_road
from tests.controllers.toy_runs import ride

BODY = Body()
TIMES = np.arange(0.0, 3.05, 0.1)
AT_THE_CORNER = Walker(BODY.front + 0.9, -1.05)
"""Somebody ahead of the right corner of a standing ego."""


def _angle(seen: Perception, margin: float = 0.05, wanted: float = 0.0) -> float | None:
    count = len(seen.pedestrians)
    people = discs(seen, np.arange(count), np.zeros(count, bool), None, TIMES)
    command = way_out(seen, people, np.full(count, margin), TIMES, wanted)
    return None if command is None else float(command.steering[0])


def test_with_nobody_in_the_way_it_steers_as_planned() -> None:
    aside = perception(ego(speed=0.0), walkers=[Walker(2.0, 3.0)])
    assert _angle(aside, wanted=0.1) == pytest.approx(0.1)
    assert _angle(aside, wanted=-0.31) == pytest.approx(-0.3)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_it_steers_away_from_somebody_at_a_corner(side: float) -> None:
    walker = Walker(AT_THE_CORNER.along, side * 1.05)
    angle = _angle(perception(ego(speed=0.0), walkers=[walker]))
    assert angle is not None
    assert angle * side < 0.0


def test_there_is_none_among_people_on_both_sides_or_beside_a_car() -> None:
    both = [AT_THE_CORNER, Walker(AT_THE_CORNER.along, 1.05)]
    assert _angle(perception(ego(speed=0.0), walkers=both)) is None
    car = Car(BODY.front + 3.0, 2.0, length=6.0)
    assert _angle(perception(ego(speed=0.0), straight_road(2), [AT_THE_CORNER], [car])) is None


def test_somebody_who_touches_the_body_may_be_left_but_not_approached() -> None:
    touching = perception(ego(speed=0.0), walkers=[Walker(1.0, -(0.5 * BODY.width + 0.25))])
    angle = _angle(touching, margin=-0.002)
    assert angle is not None
    assert angle >= 0.0


def test_in_closed_loop_it_gets_past_somebody_who_will_not_move() -> None:
    """He stands a metre ahead of the right corner of an ego that starts from a standstill."""
    record = ride(ToyRoad(), [walk(BODY.front + 0.9, -1.05, 0.0, 0.0)], speed=0.0, duration=60.0)
    ways_out = [i for i, plan in enumerate(record.plans) if plan.status == WAY_OUT]
    assert ways_out
    assert max(record.snapshots[i].egos[0].speed for i in ways_out) < SPEED + 0.3
    assert record.clearance() > 0.0
    assert record.arrival(20.0) < 55.0
