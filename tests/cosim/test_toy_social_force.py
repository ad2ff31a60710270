"""Pedestrians on the toy road who walk by the social-force model."""

from __future__ import annotations

import math

import numpy as np
import pytest

from controllers import catalog
from controllers.drivable_area.social_force import SocialForceModel
from controllers.interface import Body, Drive, FloatArray
from cosim.loop import run
from cosim.plant import Plant
from cosim.toy_social_force import SocialForceWalk, social_force_walk
from cosim.toy_world import ToyPedestrian, ToyRoad, ToyWorld
from tests.controllers.toy_runs import Ride

ACROSS = 0.5 * math.pi


def _walked(motion: SocialForceWalk, car: Plant, duration: float = 40.0, step: float = 0.1) -> FloatArray:
    """Return x, y, x speed and y speed after every step, shape (steps, 4)."""
    rows = []
    for index in range(round(duration / step)):
        motion.react((index + 1) * step, car)
        rows.append(motion((index + 1) * step))
    return np.array(rows)


def _car(x: float, y: float = 0.0) -> Plant:
    return Plant(Body(), Drive(), x, y, 0.0, 0.0)


def test_without_a_car_the_speed_stays_what_was_published() -> None:
    track = _walked(social_force_walk(0.0, 0.0, ACROSS, seed=4), _car(500.0), 400.0)
    assert track[:, 3].mean() == pytest.approx(1.25, abs=0.01)
    assert track[:, 3].std() == pytest.approx(0.05, abs=0.01)
    assert np.abs(track[:, 0]).max() < 1e-9


def test_the_seed_decides_the_walk() -> None:
    first, again, other = (
        _walked(social_force_walk(0.0, 0.0, ACROSS, seed=seed), _car(500.0)) for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 0.01


def test_somebody_who_walks_towards_a_near_car_steps_back() -> None:
    beside = _walked(social_force_walk(1.3, -2.2, ACROSS, seed=1), _car(0.0), 1.0)
    assert beside[:, 3].min() < -0.1
    assert (beside[:, 1] < -0.9 - 0.25).all()


def test_nobody_moves_before_the_start() -> None:
    motion = social_force_walk(1.3, -1.2, ACROSS, seed=1, start=2.0)
    track = _walked(motion, _car(0.0), 4.0)
    assert (track[:19, :2] == [1.3, -1.2]).all()
    assert (track[:19, 2:] == 0.0).all()
    assert track[-1, 1] != -1.2


def test_nobody_is_pushed_faster_than_people_run() -> None:
    track = _walked(social_force_walk(4.0, 0.1, math.pi, seed=1), _car(0.0), 5.0)
    assert np.hypot(track[:, 2], track[:, 3]).max() <= SocialForceModel().fastest + 1e-9


def test_in_the_loop_a_walker_keeps_off_a_car_that_goes_past() -> None:
    world = ToyWorld(
        ToyRoad(lane_width=3.5),
        [ToyPedestrian("walker", social_force_walk(31.0, -4.0, ACROSS, seed=3))],
        speed=13.0,
        duration=4.0,
    )
    ride = Ride()
    run(world, {"ego": catalog.build("constant_speed")}, ride)
    lateral = [float(snapshot.persons.y_speed[0]) for snapshot in ride.snapshots]
    assert min(lateral) < 0.5
    assert max(lateral) > 1.0
