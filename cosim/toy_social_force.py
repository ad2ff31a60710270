"""Scripted pedestrians who keep away from a near car: the social-force model, walked once."""

from __future__ import annotations

import math

import numpy as np

from controllers.drivable_area.social_force import Aims, CarOutline, SocialForceModel, Walkers
from controllers.interface import Body
from cosim.plant import Plant

STEP = 0.05
"""Longest step of a walk [s]."""


class SocialForceWalk:
    """Somebody who walks in a direction with a varying speed, and is pushed away by the ego.

    It remembers where it is, so: one per pedestrian and run. See :class:`cosim.toy_world.ReactingMotion`.
    """

    def __init__(
        self,
        place: tuple[float, float],
        direction: tuple[float, float],
        model: SocialForceModel,
        seed: int,
        start: float,
    ) -> None:
        self._walkers = Walkers(
            np.array([place[0]]),
            np.array([place[1]]),
            np.array([model.mean_speed * direction[0]]),
            np.array([model.mean_speed * direction[1]]),
        )
        self._aims = Aims(np.array([direction[0]]), np.array([direction[1]]), np.array([model.mean_speed]))
        self._model = model
        self._drawn = np.random.default_rng(seed)
        self._start = start
        self._time = 0.0

    def __call__(self, time: float) -> tuple[float, float, float, float]:
        """Return place and velocity; who has not started yet stands."""
        one = self._walkers
        started = self._time >= self._start
        x_speed, y_speed = (one.x_speed[0], one.y_speed[0]) if started else (0.0, 0.0)
        return float(one.x[0]), float(one.y[0]), float(x_speed), float(y_speed)

    def react(self, time: float, ego: Plant) -> None:
        """Walk on to that time; the ego stays where it is then."""
        duration = time - max(self._time, self._start)
        self._time = time
        if duration <= 0.0:
            return
        steps = math.ceil(duration / STEP - 1e-9)
        for _ in range(steps):
            self._walkers = self._model.walk(
                self._walkers, self._aims, _outline(ego), duration / steps, self._drawn.standard_normal(1)
            )


def social_force_walk(
    x: float,
    y: float,
    heading: float,
    *,
    seed: int,
    start: float = 0.0,
    model: SocialForceModel | None = None,
) -> SocialForceWalk:
    """Return the motion of somebody at (x, y) who sets out in a direction.

    Parameters
    ----------
    x, y : where he begins [m]
    heading : where he wants to go, counter-clockwise from the road's direction [rad]
    seed : of the variation of his speed
    start : until then he stands, whatever the car does [s]
    model : of walking
    """
    direction = (math.cos(heading), math.sin(heading))
    return SocialForceWalk((x, y), direction, model or SocialForceModel(), seed, start)


def _outline(ego: Plant) -> CarOutline:
    body: Body = ego.body
    middle = body.front - 0.5 * body.length
    return CarOutline(
        ego.x + middle * math.cos(ego.heading),
        ego.y + middle * math.sin(ego.heading),
        ego.heading,
        0.5 * max(body.length - body.width, 0.0),
    )
