"""How people of the world walk near vehicles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from controllers import catalog
from controllers.arrays import FloatArray
from controllers.interface import Body
from cosim.pedestrians.line import Line
from cosim.pedestrians.manner import Pace
from cosim.pedestrians.start import AtTime
from cosim.pedestrians.steady import Steady
from cosim.pedestrians.swerving import Swerving
from cosim.pedestrians.walker import Walker
from cosim.pedestrians.walking_model import Aim, MiddleAxis, Motion, WalkingModel
from cosim.step.loop import run
from cosim.step.plant import CAR_DRIVE, Plant
from cosim.step.toy_road import ToyPedestrian, ToyRoad
from cosim.step.toy_world import ToyWorld
from tests.controllers.toy_runs import Ride
from tests.cosim.pedestrians.toy_walk import ToyWalk

MODEL = WalkingModel()
NORTH = Aim(0.0, 1.0, 1.25)
CAR = MiddleAxis(0.0, 0.0, 0.0, half_length=1.35)


def _walked(x: float, y: float, aim: Aim, car: MiddleAxis | None, duration: float, seed: int) -> FloatArray:
    """Return x, y, x speed and y speed after every step of 0.05 s, shape (steps, 4)."""
    drawn = np.random.default_rng(seed)
    walker = Motion(x, y, aim.speed * aim.east, aim.speed * aim.north)
    rows = []
    for _ in range(round(duration / 0.05)):
        walker = MODEL.walk(walker, aim, car, 0.05, float(drawn.standard_normal()))
        rows.append((walker.x, walker.y, walker.x_speed, walker.y_speed))
    return np.array(rows)


def test_without_a_vehicle_the_speed_stays_what_was_published() -> None:
    track = _walked(0.0, 0.0, NORTH, None, 400.0, seed=4)
    assert track[:, 3].mean() == pytest.approx(1.25, abs=0.01)
    assert track[:, 3].std() == pytest.approx(0.05, abs=0.01)
    assert not track[:, 0].any()


def test_who_is_slower_comes_up_to_their_mean_speed_with_the_relaxation_time() -> None:
    walker = Motion(0.0, 0.0, 0.0, 0.8)
    for _ in range(10):
        walker = MODEL.walk(walker, NORTH, None, 0.05, 0.0)
    assert walker.y_speed == pytest.approx(1.25 - 0.45 * math.exp(-1.0))


def test_the_push_is_that_of_the_formula_within_what_a_person_can_do() -> None:
    disc = MiddleAxis(0.0, 0.0, 0.0)
    for distance in (1.95, 2.2, 3.0, 6.0):
        size = 4.5 * math.exp(5.5 * (1.95 - distance))
        push = MODEL.push(0.6 * distance, 0.8 * distance, disc)
        assert push == pytest.approx((0.6 * size, 0.8 * size))
    assert MODEL.push(0.1, 0.0, disc) == pytest.approx((MODEL.hardest, 0.0))
    assert MODEL.push(0.0, 0.0, disc) == (0.0, 0.0)


@given(some.floats(-6.0, 6.0), some.floats(-6.0, 6.0), some.floats(-3.0, 3.0))
def test_the_push_leads_away_from_the_vehicle_and_turns_with_it(x: float, y: float, heading: float) -> None:
    push = MODEL.push(x, y, MiddleAxis(1.0, 2.0, heading, half_length=1.4))
    cosine, sine = math.cos(heading), math.sin(heading)
    along, beside = (x - 1.0) * cosine + (y - 2.0) * sine, (y - 2.0) * cosine - (x - 1.0) * sine
    straight = MODEL.push(along, beside, MiddleAxis(0.0, 0.0, 0.0, half_length=1.4))
    assert push[0] * cosine + push[1] * sine == pytest.approx(straight[0], abs=1e-9)
    assert push[1] * cosine - push[0] * sine == pytest.approx(straight[1], abs=1e-9)
    assert push[0] * (x - 1.0) + push[1] * (y - 2.0) >= -1e-12


def test_somebody_who_walks_towards_a_near_vehicle_steps_back() -> None:
    track = _walked(1.3, -2.2, NORTH, CAR, 1.0, seed=1)
    assert track[:, 3].min() < -0.1
    assert (track[:, 1] < -0.9 - 0.25).all()


def test_nobody_is_pushed_faster_than_people_run() -> None:
    track = _walked(4.0, 0.1, Aim(-1.0, 0.0, 1.25), CAR, 5.0, seed=1)
    assert np.hypot(track[:, 2], track[:, 3]).max() <= MODEL.fastest + 1e-9


def test_in_the_loop_a_walker_keeps_off_a_car_that_goes_past() -> None:
    line = Line(31.0, -4.0, 31.0, 40.0)
    walker = Walker(line, Pace(1.25), Steady(), AtTime(0.0), line.length)
    motion = ToyWalk(Swerving(walker, seed=3), Plant(Body(), CAR_DRIVE, 0.0, 0.0, 0.0, 13.0))
    world = ToyWorld(ToyRoad(lane_width=3.5), [ToyPedestrian("walker", motion)], speed=13.0, duration=4.0)
    ride = Ride()
    run(world, {"ego": catalog.build("constant_speed")}, ride)
    lateral = [float(snapshot.persons.y_speed[0]) for snapshot in ride.snapshots]
    assert min(lateral) < 0.5
    assert max(lateral) > 1.0
