"""The lane an ego is in or moving to, kept over time, and the offset profile that takes it there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving.lanes.minimum_jerk import minimum_jerk
from controllers.driving.standing import STANDING
from controllers.interface import Lane, Perception

SETTLING = 0.5
"""Time from the planned end of a change until the body has settled in the lane [s]."""


@dataclass(slots=True)
class LaneManoeuvre:
    """The ego's lane change, in lane numbers, which stay the same while it drives.

    Parameters
    ----------
    duration
        Planned duration of a lane change [s].
    """

    duration: float
    target: int | None = None
    origin: int | None = None
    """Lane the running change began in; ``None`` when no change runs."""
    started: float = 0.0
    finished: float = -np.inf
    """When the last change ended or was aborted [s]."""
    _from: float = 0.0
    # Offset from the target lane's centre at the start of the change [m].

    def settle(self, perception: Perception) -> None:
        """Take note of where the ego is: adopt its lane, or end a completed change."""
        road, ego = perception.road, perception.ego
        if self.target is None:
            self.target = road.reference
        lane = road.lane(self.target)
        if lane is None:
            # The lane is gone (the road narrowed, or a junction rearranged it): stay where the ego is.
            self.end(perception)
            return
        passed = ego.time - self.started
        arrived = abs(ego.across - lane.offset) < 0.3 and passed > 0.6 * self.duration
        # An ego that stands in the lane gets no nearer to its middle, and the route may ask for another one.
        stopped = ego.speed < STANDING and self.target == road.reference and passed > self.duration
        if self.origin is not None and (arrived or stopped):
            self.origin = None
            self.finished = ego.time
        if self.origin is None and self.target != road.reference:
            self.target = road.reference

    def end(self, perception: Perception) -> None:
        """Stop changing lanes where the ego is."""
        self.target, self.origin = perception.road.reference, None
        self.finished = perception.ego.time

    @property
    def running(self) -> bool:
        """Whether a change is under way."""
        return self.origin is not None

    def begin(self, perception: Perception, target: int) -> None:
        """Start to move to another lane (or back to the origin)."""
        lane = perception.road.lane(target)
        self.origin = perception.road.reference if self.origin is None else self.origin
        self.target = target
        self.started = perception.ego.time
        self._from = perception.ego.across - (lane.offset if lane else 0.0)

    def settled_from(self, perception: Perception) -> float:
        """Return how far ahead the body has settled in the target lane, if it changes lanes now [m]."""
        passed = perception.ego.time - self.started if self.running else 0.0
        left = max(self.duration - passed, 0.0) + SETTLING
        return perception.ego.body.front + max(perception.ego.speed, 0.0) * left

    def lane(self, perception: Perception) -> Lane | None:
        """Return the target lane as perceived now."""
        return perception.road.lane(self.target if self.target is not None else perception.road.reference)

    def offsets(self, perception: Perception, times: FloatArray) -> FloatArray:
        """Return the wanted offset of the rear axle at times from now, shape (N,) [m]."""
        lane = self.lane(perception)
        goal = lane.offset if lane is not None else 0.0
        if not self.running:
            return np.full(len(times), goal)
        fraction = (perception.ego.time - self.started + times) / self.duration
        return goal + self._from * (1.0 - minimum_jerk(fraction))
