"""When the drivable-area method acts."""

from __future__ import annotations

import numpy as np

from controllers.conflicts.expected_behaviour import PedestrianAssumptions, Watch
from controllers.drivable_area.activation import in_reaction_space
from controllers.drivable_area.clearances import Shape
from controllers.drivable_area.conflict import Conflict, first_conflict, outlook, relevant
from tests.controllers.scenes import FRONT, Walker, ego, perception, straight_road

TIMES = np.arange(0.0, 5.01, 0.2)
SPEED = 11.0
STOPS = SPEED**2 / (2.0 * 0.8 * 9.80665)
"""7.7 m: how far the reaction space reaches."""


def _found(walker: Walker, speed: float = SPEED, lanes: int = 3) -> tuple[Conflict | None, Conflict | None]:
    """Return whom the method acts for, and who is on a collision course."""
    scene = perception(ego(speed), straight_road(lanes, lanes // 2), [walker])
    expected = outlook(scene, TIMES, np.zeros(len(TIMES)), 0.0)
    people = relevant(scene, Watch(), 5.0, PedestrianAssumptions())
    shape = Shape(scene.ego.body)
    met = first_conflict(expected, people, shape, np.full(len(people), 0.7), 1.0)
    return in_reaction_space(expected, people, shape, scene.road, 0.8, 1.0), met


def test_it_acts_for_somebody_who_crosses_within_reach_though_nobody_would_be_met() -> None:
    """6 m before the bumper the space is 2.1 m wide to each side; they are there and walk away."""
    acts, met = _found(Walker(FRONT + 6.0, 1.9, 0.0, 1.0))
    assert met is None
    assert acts is not None
    assert acts.name == "person0"


def test_it_acts_before_whoever_will_be_in_the_space_is_there() -> None:
    far = STOPS + 20.0
    acts, _ = _found(Walker(FRONT + far, 0.5, 0.0, 0.0))
    assert acts is None or acts.time > 0.0
    acts, _ = _found(Walker(FRONT + far, -3.4, 0.0, 1.3))
    assert acts is not None
    # The car is level with them once the bumper has come so far.
    assert abs(acts.time - far / SPEED) < 0.2


def test_it_does_not_act_for_somebody_on_the_pavement_nor_for_a_standing_car() -> None:
    assert _found(Walker(FRONT + 4.0, 8.0, 1.0, 0.0))[0] is None
    assert _found(Walker(FRONT + 4.0, 0.0, 0.0, 1.2), speed=0.0)[0] is None


def test_somebody_beyond_the_arcs_is_not_in_the_space() -> None:
    """1 m before the bumper it is hardly wider than the car."""
    assert _found(Walker(FRONT + 1.0, 3.0, 0.0, 0.9))[0] is None
