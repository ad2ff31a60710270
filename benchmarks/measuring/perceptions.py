"""Perceptions recorded while the controller drives towards a crossing with people on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from controllers import catalog
from controllers.interface import Controller, Perception
from cosim.step.toy_road import ToyCrossing, ToyPedestrian, ToyRoad, ToyVehicle, walk
from cosim.step.toy_world import ToyWorld
from measuring.solvers import DEFAULT

STEP = 0.1
"""Of the simulation [s]."""
APPROACHES = 4
"""Independent approaches per number of pedestrians."""
LONGEST = 5.0
"""What is recorded of each [s]."""

OFFSET = 0.3
"""Of the ego from the centre of its lane at the start, so that there is something to steer [m]."""

Approach = Sequence[Perception]
"""What one ego was told, step by step."""


@dataclass(frozen=True, slots=True)
class Case:
    """Size of the problem."""

    steps: int
    pedestrians: int

    def __str__(self) -> str:
        return f"{self.steps}/{self.pedestrians}"


CASES = tuple(Case(steps, people) for steps in (20, 30) for people in (0, 1, 5, 20))


def controller(case: Case, solver: str) -> Controller:
    """Return a fresh ``vo_mpc``."""
    return catalog.build("vo_mpc", seed=1, steps=case.steps, solver=solver)


def timed(driver: Controller, perception: Perception) -> float:
    """Return what one control step takes [s]."""
    began = perf_counter()
    driver.plan(perception, driver.decide(perception))
    return perf_counter() - began


def warm_up(case: Case, solver: str) -> None:
    """Plan every kind of step once, so that nothing is loaded while the clock runs."""
    for approach in record(case):
        driver = controller(case, solver)
        for perception in approach:
            driver.plan(perception, driver.decide(perception))


def record(case: Case, approaches: int = APPROACHES) -> list[Approach]:
    """Return the perceptions of all approaches, each until nobody is in the ego's way any more."""
    return [_approach(case, seed) for seed in range(1, approaches + 1)]


def _approach(case: Case, seed: int) -> Approach:
    rng = np.random.default_rng([seed, case.pedestrians])
    crossing = ToyCrossing(50.0)
    road = ToyRoad(lanes=3, crossings=(crossing,))
    world = ToyWorld(
        road=road,
        pedestrians=[_pedestrian(i, rng, crossing) for i in range(case.pedestrians)],
        vehicles=[ToyVehicle("leader", walk(45.0, road.lane_width, 12.0, 0.0))],
        speed=12.0,
        lane=1,
        duration=LONGEST,
        step=STEP,
    )
    world.plant.y += OFFSET
    driver = controller(case, DEFAULT)
    seen: list[Perception] = []
    while (perceptions := world.sense()) is not None:
        (perception,) = perceptions
        if world.plant.x > crossing.x + crossing.width:
            break
        seen.append(perception)
        plan = driver.plan(perception, driver.decide(perception))
        world.act(perception.ego.name, plan.command)
        world.advance()
    return seen


def _pedestrian(number: int, rng: np.random.Generator, crossing: ToyCrossing) -> ToyPedestrian:
    """Return somebody who walks over all three lanes while the ego approaches or waits."""
    x = crossing.x + rng.uniform(0.3, crossing.width - 0.3)
    speed = rng.uniform(1.0, 1.6)
    upwards = number % 2 == 0
    # On the middle lane's edge between 1 s and 8 s after the start: in the way for most of the approach.
    reached = rng.uniform(1.0, 8.0)
    edge = 1.75 if upwards else 5.25
    direction = 1.0 if upwards else -1.0
    return ToyPedestrian(f"p{number}", walk(x, edge - direction * speed * reached, 0.0, direction * speed))
