"""Manner ``social_force``: walking at a varying speed to the end of the line, pushed away by vehicles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from cosim.arrays import FloatArray
from cosim.pedestrians.behaviour import RADIUS, RoadUser, Scene, State
from cosim.pedestrians.line import Line
from cosim.pedestrians.walker import Walker
from cosim.pedestrians.walking_model import Aim, MiddleAxis, Motion, WalkingModel

LONGEST_STEP = 0.05
"""Longest integration step of the walking model [s]."""
TICK = 1e-3
"""Each random number belongs to an instant, rounded to a multiple of this [s]."""


@dataclass(frozen=True, slots=True)
class Swerving:
    """A pedestrian of manner ``social_force``, whom the nearest vehicle pushes off the line.

    Parameters
    ----------
    walker : line, pace, start and end of the walk; its manner is not used
    seed : seed of the speed variation
    model : model of walking; its v̄ is the walker's speed

    Notes
    -----
    Eqs. (37)-(43) of [Wu2023]_. The paper has one car; here, the nearest of all vehicles takes its place.
    """

    walker: Walker
    seed: int = 1
    model: WalkingModel = field(default_factory=WalkingModel)

    def first(self, scene: Scene) -> State | None:
        """Return the pedestrian standing at the start, once present."""
        return self.walker.first(scene)

    def next(self, state: State, scene: Scene, until: float) -> State | None:
        """Return a later state, in steps of at most 0.05 s; vehicles are taken to go straight on."""
        started = state.started
        if started is None:
            started = self.walker.start.instant(scene, until)
            if started is None:
                return state
            # The pedestrian sets off at full speed, as in the other manners.
            east, north = self.walker.line.direction
            pace = self.walker.pace.speed
            state = replace(state, x_speed=pace * east, y_speed=pace * north, started=started)
        if state.ended is not None:
            return None if until > state.ended + self.walker.stay else state
        now = max(started, scene.time)
        count = max(1, math.ceil((until - now) / LONGEST_STEP - 1e-9))
        step = (until - now) / count
        for number in range(count):
            at = now + number * step
            state = self._walked(state, at, step, scene)
            if self._is_over(state):
                return replace(state, x_speed=0.0, y_speed=0.0, ended=at + step)
        return state

    def onward(self, state: State, time: float) -> FloatArray:
        """Return the straight path to the end of the line."""
        line = self.walker.line
        if state.ended is not None:
            return np.array([[state.x, state.y]])
        return Line(state.x, state.y, line.end_x, line.end_y).onward(0.0)

    def _walked(self, state: State, time: float, step: float, scene: Scene) -> State:
        line = self.walker.line
        away = max(math.dist((state.x, state.y), (line.end_x, line.end_y)), 1e-9)
        aim = Aim((line.end_x - state.x) / away, (line.end_y - state.y) / away, self.walker.pace.speed)
        noise = float(np.random.default_rng((self.seed, round(time / TICK))).standard_normal())
        vehicle = _nearest(state, scene.vehicles, time - scene.time)
        walked = self.model.walk(Motion(*state.motion), aim, vehicle, step, noise)
        return State(walked.x, walked.y, walked.x_speed, walked.y_speed, state.started)

    def _is_over(self, state: State) -> bool:
        line = self.walker.line
        east, north = line.direction
        return (line.end_x - state.x) * east + (line.end_y - state.y) * north <= RADIUS


def _nearest(state: State, vehicles: Sequence[RoadUser], passed: float) -> MiddleAxis | None:
    """Return the nearest middle axis of a vehicle, after all vehicles went straight on for a time [s]."""
    axes = [_axis(one, passed) for one in vehicles]
    return min(axes, key=lambda axis: math.hypot(*axis.to(state.x, state.y)), default=None)


def _axis(vehicle: RoadUser, passed: float) -> MiddleAxis:
    back = vehicle.speed * passed - 0.5 * vehicle.length
    return MiddleAxis(
        vehicle.x + back * math.cos(vehicle.heading),
        vehicle.y + back * math.sin(vehicle.heading),
        vehicle.heading,
        0.5 * max(vehicle.length - vehicle.width, 0.0),
    )
