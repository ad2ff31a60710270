"""A pedestrian whose walk was recorded; it is replayed without reactions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.polylines import arc_lengths
from cosim.arrays import FloatArray
from cosim.pedestrians.behaviour import Scene, State
from cosim.pedestrians.line import LOOK_AHEAD


@dataclass(frozen=True, slots=True)
class Recorded:
    """A recorded trajectory, linear between its points.

    Parameters
    ----------
    points : time, x and y (n, 3); the person is present from the first time to the last [s, m]
    start : simulated time of the recording's time 0 [s]
    """

    points: FloatArray
    start: float = 0.0

    def at(self, time: float) -> tuple[float, float, float, float]:
        """Return place and velocity at a time; before and after the recording, the person stands [m, m/s].

        >>> Recorded(np.array([[0.0, 1.0, 0.0], [2.0, 1.0, 3.0]])).at(1.0)
        (1.0, 1.5, 0.0, 1.5)
        """
        local = time - self.start
        times = self.points[:, 0]
        x, y = (float(np.interp(local, times, self.points[:, axis])) for axis in (1, 2))
        if not times[0] <= local <= times[-1]:
            return x, y, 0.0, 0.0
        # At a point, the velocity is that of the piece that leads to it, as in the previous step.
        last = min(max(int(np.searchsorted(times, local - 1e-9, side="left")), 1), len(times) - 1)
        (t0, x0, y0), (t1, x1, y1) = self.points[last - 1].tolist(), self.points[last].tolist()
        return x, y, (x1 - x0) / (t1 - t0), (y1 - y0) / (t1 - t0)

    def first(self, scene: Scene) -> State | None:
        """Return the person once the recording has begun."""
        local = scene.time - self.start
        if local < self.points[0, 0] - 1e-9 or local > self.points[-1, 0] + 1e-9:
            return None
        return State(*self.at(scene.time))

    def next(self, state: State, scene: Scene, until: float) -> State | None:
        """Return the person at their recorded position."""
        if until > self.start + self.points[-1, 0] + 1e-9:
            return None
        return State(*self.at(until))

    def onward(self, state: State, time: float) -> FloatArray:
        """Return the recorded points along the next metres."""
        later = self.points[self.points[:, 0] > time - self.start, 1:]
        way = np.concatenate([[[state.x, state.y]], later])
        gone = arc_lengths(way)
        steps = np.arange(0.0, min(LOOK_AHEAD, float(gone[-1])) + 1e-9, 0.5)
        return np.column_stack([np.interp(steps, gone, way[:, axis]) for axis in (0, 1)])
