"""The velocity-obstacle paper's formulation at walking pace: what its disc and its long steps leave out."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from controllers.arrays import FloatArray
from cosim.step.toy_road import ToyRoad, walk
from tests.controllers.toy_runs import Ride, ride

pytestmark = pytest.mark.long

SPEED = 10.0 / 3.6
PLACE = 25.0
"""Place of the crossing [m]."""
HALF, RADIUS = np.array([2.25, 0.9]), 0.25
"""Half of the body's length and width, and the pedestrian's disc [m]."""
LONG, FINE = "steps of a second", "steps of a quarter of a second"
PARAMETERS = {LONG: {}, FINE: {"euler_step_s": 0.25, "euler_steps": 44, "replan_s": 0.25}}
ADULT, RUNNER = (5.0 / 3.6, 4.0), (8.0 / 3.6, 6.0)
"""Speed [m/s], and distance of the start from the middle of the lane [m]."""
RUNNER_TOO = pytest.param(RUNNER, marks=pytest.mark.slow)
"""Where the drive is planned in fine steps: it takes seconds, and the adult's is another of the same kind."""


@cache
def _crossing(pedestrian: tuple[float, float], steps: str, disc: float | None = None) -> Ride:
    """Drive towards somebody who would be hit by the middle of the front, which comes at 10 km/h."""
    pace, beside = pedestrian
    meeting = PLACE / SPEED
    radius = {} if disc is None else {"disc_radius_m": disc}
    return ride(
        ToyRoad(speed_limit=SPEED),
        [walk(PLACE, -beside, 0.0, pace, start=meeting - beside / pace)],
        speed=SPEED,
        duration=meeting + 6.0,
        parameters={**PARAMETERS[steps], **radius},
        controller="vo_paper",
    )


def _gaps(record: Ride) -> tuple[FloatArray, FloatArray]:
    """Return after every step the distance of the centres, and that of body and disc [m]."""
    from_centre = np.array(
        [(s.persons.x[0] - s.egos[0].x + HALF[0], s.persons.y[0] - s.egos[0].y) for s in record.snapshots]
    )
    beside = np.maximum(np.abs(from_centre) - HALF, 0.0)
    return np.hypot(*from_centre.T), np.hypot(*beside.T) - RADIUS


@pytest.mark.parametrize(
    ("pedestrian", "steps"),
    [
        (ADULT, LONG),
        (RUNNER, LONG),
        *(pytest.param(one, FINE, marks=pytest.mark.slow) for one in (ADULT, RUNNER)),
    ],
)
def test_a_car_touches_somebody_before_they_are_in_the_papers_disc(
    pedestrian: tuple[float, float], steps: str
) -> None:
    record = _crossing(pedestrian, steps)
    to_centre, to_body = _gaps(record)
    touches = np.flatnonzero(to_body <= 0.0)
    assert len(touches)
    assert to_centre[: touches[0] + 1].min() > 2.0
    # By its own account it avoids the pedestrian all the time.
    assert all(plan.solved for plan in record.plans)


@pytest.mark.parametrize("pedestrian", [ADULT, RUNNER_TOO])
def test_a_disc_that_holds_the_car_keeps_it_off_them(pedestrian: tuple[float, float]) -> None:
    record = _crossing(pedestrian, FINE, disc=2.75)
    assert record.clearance() > 0.1
    assert record.track[2][-1] > 0.9 * SPEED


@pytest.mark.parametrize("pedestrian", [ADULT, RUNNER_TOO])
def test_in_steps_of_a_second_it_comes_up_to_half_a_metre_nearer_than_planned(
    pedestrian: tuple[float, float],
) -> None:
    # In an Euler step it moves with the old speed; a car that speeds up by 1 m/s gets 0.5 m farther.
    long, short = (_gaps(_crossing(pedestrian, steps))[0].min() for steps in (LONG, FINE))
    assert 1.5 < long < short - 0.2
