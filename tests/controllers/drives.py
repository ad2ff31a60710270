"""A closed loop on a straight road: a controller, a plant, and a scene that depends on both."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import Body, Controller, Drive, EgoState, Perception
from cosim.step.plant import CAR_DRIVE, Plant
from tests.controllers.scenes import ego

Scene = Callable[[EgoState, float], Perception]
"""Makes a perception of the ego's state and the distance it has travelled with its rear axle [m]."""


def drive(
    controller: Controller,
    scene: Scene,
    speed: float,
    duration: float,
    interval: float = 0.1,
    limits: Drive | None = None,
) -> FloatArray:
    """Return time, travelled, across, speed and acceleration at the beginning of every 0.05 s."""
    limits = limits or CAR_DRIVE
    plant = Plant(Body(), limits, 0.0, 0.0, 0.0, speed)
    rows = []
    for step in range(round(duration / interval)):
        now = step * interval
        state = ego(
            plant.speed, plant.y, plant.heading, interval, now, plant.acceleration, plant.steering, limits
        )
        seen = scene(state, plant.x)
        plan = controller.plan(seen, controller.decide(seen))
        for part in range(round(interval / 0.05)):
            rows.append((now + 0.05 * part, plant.x, plant.y, plant.speed, plant.acceleration))
            plant.follow(plan.command, part * 0.05, 0.05)
    return np.array(rows)
