"""Egos of one kind share their programs, and none of them notices."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from controllers import catalog
from controllers.arrays import FloatArray
from controllers.interface import Perception
from cosim.step.toy_road import ToyCrossing, ToyPedestrian, ToyRoad, walk
from cosim.step.toy_world import ToyWorld


def _approach(people: int, speed: float) -> list[Perception]:
    """Return what an ego is told on its way to a crossing, driven by a controller of its own."""
    crossing = ToyCrossing(45.0)
    walkers = [
        ToyPedestrian(f"p{i}", walk(46.0 + 0.5 * i, -7.0 + 2.0 * i, 0.0, (-1.0) ** i * 1.3))
        for i in range(people)
    ]
    world = ToyWorld(ToyRoad(crossings=(crossing,)), walkers, speed=speed, duration=4.0)
    driver = catalog.build("vo_mpc", seed=1)
    seen: list[Perception] = []
    while (perceptions := world.sense()) is not None:
        (perception,) = perceptions
        seen.append(perception)
        world.act(perception.ego.name, driver.plan(perception, driver.decide(perception)).command)
        world.advance()
    return seen


def _planned(driver: Any, perception: Perception) -> FloatArray:
    command = driver.plan(perception, driver.decide(perception)).command
    return np.concatenate((command.acceleration, command.steering))


@pytest.mark.long
@pytest.mark.parametrize("solver", ["daqp", "osqp"])
def test_who_else_drives_changes_nothing(solver: str) -> None:
    approaches = _approach(4, 12.0), _approach(2, 9.0)
    alone = []
    for approach in approaches:
        driver = catalog.build("vo_mpc", seed=1, solver=solver)
        alone.append([_planned(driver, perception) for perception in approach])
    drivers = [catalog.build("vo_mpc", seed=1, solver=solver) for _ in approaches]
    pairs = list(zip(*approaches, strict=True))
    assert len(pairs) > 20
    together = [[_planned(*one) for one in zip(drivers, pair, strict=True)] for pair in pairs]
    for number, expected in enumerate(alone):
        for step, commands in zip(together, expected, strict=True):
            np.testing.assert_array_equal(step[number], commands)
