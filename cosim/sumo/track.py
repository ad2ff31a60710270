"""Which lane of its route a vehicle follows, given the place of its front bumper."""

from __future__ import annotations

from cosim.sumo.lane_path import LanePath, PathBend
from cosim.sumo.route import Route

HYSTERESIS = 0.15
"""The front bumper's centre has to be this far beyond a lane line to count as in the other lane [m]."""
REMOVAL = 2.0
"""A vehicle this near the end of its route has arrived [m]."""


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
        """Place of the front bumper on `path` [m]."""
        self.across = 0.0

    @property
    def path(self) -> LanePath:
        """The path along the lane."""
        return self.route.path(self.step, self.index)

    def bend(self, length: float = 0.0) -> PathBend | None:
        """Return the bend that the vehicle is in, if it is too tight for the vehicle; otherwise ``None``.

        Parameters
        ----------
        length : how far behind the front bumper the vehicle still counts as in the bend [m]
        """
        return self.path.bend_at(self.along, length)

    def lane_in_bend(self) -> str:
        """Return the lane that the front bumper is beside in such a bend; empty if it is in none."""
        return "" if self.bend() is None else self.path.piece_at(self.along).lane.name

    @property
    def arrived(self) -> bool:
        """Whether the route's end is reached."""
        path = self.path
        return path.leads_to_end and self.along >= path.chain_end - REMOVAL

    @property
    def on_last_edge(self) -> bool:
        """Whether the route's last edge is reached."""
        return self.step == len(self.route.edges) - 1

    def update(self, front_x: float, front_y: float) -> None:
        """Update the place on the route after the front bumper [m] has moved a little."""
        path = self._locate(front_x, front_y, self.along)
        while self.along >= path.next_start:
            onward = self.route.next_lane(self.step, self.index)
            if onward is None:
                break
            guess = self.along - path.next_start
            self.step, self.index = self.step + 1, onward
            path = self._locate(front_x, front_y, guess)
        for _ in range(len(self.route.network.edges[self.route.edges[self.step]])):
            if not self._change(path, front_x, front_y):
                break
            path = self.path
        if self.along > path.chain_end and not path.leads_to_end:
            self._rejoin(front_x, front_y)

    def beside(self) -> list[tuple[int, LanePath]]:
        """Return the neighbouring lanes of its edge that it may use, at most two, with their indices."""
        return [
            (index, self.route.path(self.step, index))
            for index in (self.index - 1, self.index + 1)
            if self.route.usable(self.step, index)
        ]

    def _locate(self, x: float, y: float, guess: float) -> LanePath:
        """Find the place on the present path, and return the path."""
        path = self.path
        self.along, self.across = path.curve.place_near(x, y, guess)
        return path

    def _change(self, path: LanePath, x: float, y: float) -> bool:
        """Take the neighbouring lane if the front bumper is in it.

        Parameters
        ----------
        path : the present path
        x, y : position of the front bumper [m]
        """
        if abs(self.across) <= 0.5 * path.piece_at(self.along).lane.width + HYSTERESIS:
            return False
        for index, other in self.beside():
            along, across = other.curve.place_near(x, y, self.along)
            if along > other.chain_end or abs(across) >= abs(self.across):
                continue
            self.number += 1 if self.across > 0.0 else -1
            self.index, self.along, self.across = index, along, across
            return True
        return False

    def _rejoin(self, x: float, y: float) -> None:
        """Take the nearest lane that leads on: the present one ended without a way along the route."""
        best = None
        for index in self.route.network.allowed_lanes(self.route.edges[self.step], self.route.vehicle_class):
            path = self.route.path(self.step, index)
            along, across = path.curve.place_near(x, y, self.along)
            if along <= path.chain_end and (best is None or abs(across) < abs(best[2])):
                best = (index, along, across)
        if best is not None:
            # Lanes are counted from right to left, or the other way round where traffic keeps left.
            to_the_left = best[2] < self.across
            self.number += abs(best[0] - self.index) * (1 if to_the_left else -1)
            self.index, self.along, self.across = best
