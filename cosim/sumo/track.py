"""Which lane of its route a vehicle follows, told from where its front bumper is."""

from __future__ import annotations

import math

import numpy as np

from cosim.sumo.route import LanePath, Route

HYSTERESIS = 0.15
"""The front bumper's centre has to be this far beyond a lane line to count as in the other lane [m]."""
REMOVAL = 2.0
"""A vehicle this near its route's end has arrived [m]."""


class Track:
    """A vehicle's place on its route.

    Parameters
    ----------
    route
    step : index of the route's edge that the front bumper is on
    index : index of its lane
    """

    def __init__(self, route: Route, step: int, index: int) -> None:
        self.route = route
        self.step = step
        self.index = index
        self.number = 0
        """``Lane.number`` of the lane."""
        self.along = 0.0
        """Of the front bumper, on `path` [m]."""
        self.across = 0.0
        self.lost = False
        """Whether the vehicle has left the lanes that its route can use."""

    @property
    def path(self) -> LanePath:
        """The path along the lane."""
        return self.route.path(self.step, self.index)

    @property
    def arrived(self) -> bool:
        """Whether the route's end is reached."""
        path = self.path
        return path.leads_to_end and self.along >= path.chain_end - REMOVAL

    @property
    def remaining(self) -> float:
        """Distance to the route's end [m]; inf beyond the path."""
        path = self.path
        return path.chain_end - self.along if path.leads_to_end else math.inf

    def update(self, front_x: float, front_y: float) -> None:
        """Find the front bumper [m] again after it has moved a little."""
        front = np.array([[front_x, front_y]])
        self._locate(front)
        while self.along >= self.path.next_start:
            onward = self.route.next_lane(self.step, self.index)
            if onward is None:
                break
            self.step, self.index = self.step + 1, onward
            self._locate(front)
        for _ in range(len(self.route.network.edges[self.route.edges[self.step]])):
            if not self._change(front):
                break

    def place(self, step: int, index: int, front_x: float, front_y: float) -> None:
        """Begin anew on a lane that somebody else found."""
        self.step, self.index = step, index
        self.update(front_x, front_y)

    def beside(self) -> list[tuple[int, LanePath]]:
        """Return the neighbouring lanes and their indices; at most two, those of its edge that it may use."""
        return [
            (index, self.route.path(self.step, index))
            for index in (self.index - 1, self.index + 1)
            if self.route.usable(self.step, index)
        ]

    def _locate(self, front: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> None:
        along, across, _ = self.path.curve.project(front)
        self.along, self.across = float(along[0]), float(across[0])
        self.lost = abs(self.across) > 10.0

    def _change(self, front: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> bool:
        """Take the neighbouring lane if the front bumper is in it."""
        path = self.path
        if abs(self.across) <= 0.5 * path.piece_at(self.along).lane.width + HYSTERESIS:
            return False
        for index, other in self.beside():
            along, across, _ = other.curve.project(front)
            if float(along[0]) > other.chain_end or abs(float(across[0])) >= abs(self.across):
                continue
            self.number += 1 if self.across > 0.0 else -1
            self.index = index
            self._locate(front)
            return True
        return False
