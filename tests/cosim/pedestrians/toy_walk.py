"""A behaviour as the motion of a pedestrian on the road without SUMO."""

from __future__ import annotations

import math

from cosim.pedestrians.behaviour import Behaviour, RoadUser, Scene, State
from cosim.step.plant import Plant

ELSEWHERE = (0.0, 1e4, 0.0, 0.0)
"""Where somebody is who is not there [m]: the toy road keeps everybody for the whole run."""


class ToyWalk:
    """Walks as a behaviour says, and sees the ego; one per pedestrian and run.

    Parameters
    ----------
    behaviour : of the pedestrian
    ego : as it is when the run begins
    time : then [s]
    """

    def __init__(self, behaviour: Behaviour, ego: Plant, time: float = 0.0) -> None:
        self._behaviour = behaviour
        self._scene = self._look(time, ego)
        self._state: State | None = behaviour.first(self._scene)
        self._gone = False

    def __call__(self, time: float) -> tuple[float, float, float, float]:
        """Return place and velocity at the time last told, or at the start [m, m/s]."""
        return ELSEWHERE if self._state is None else self._state.motion

    def react(self, time: float, ego: Plant) -> None:
        """Move on to that time; who decides within the step saw the ego as it was before it."""
        before, self._scene = self._scene, self._look(time, ego)
        if self._state is None and not self._gone:
            self._state = self._behaviour.first(self._scene)
        elif self._state is not None:
            self._state = self._behaviour.next(self._state, before, time)
            self._gone = self._state is None

    @staticmethod
    def _look(time: float, ego: Plant) -> Scene:
        body = ego.body
        x, y = ego.front
        wrapped = math.remainder(ego.heading, 2.0 * math.pi)
        return Scene(time, (RoadUser("ego", x, y, wrapped, ego.speed, body.length, body.width),))
