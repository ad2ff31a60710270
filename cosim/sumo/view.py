"""One ego's route frame, and the objects on its path that the ego can see."""

from __future__ import annotations

import math

import numpy as np

from cosim.arrays import FloatArray
from cosim.step.frames import wrapped
from cosim.step.plant import Plant
from cosim.sumo.lane_path import LanePath, PathCrossing, PathJunction, PathSignal, PathStopSign
from cosim.sumo.route import VIEW
from cosim.sumo.track import Track

PASSED_LINE = 2.0
"""A stop line further behind the front bumper than this is forgotten [m]."""
LANE_END = 12.0
"""This near to the end of a lane that leads off the route, the way beside it counts [m]."""


class Frame:
    """One ego's route frame at one instant.

    Parameters
    ----------
    plant, track : the ego
    """

    __slots__ = ("across", "back", "front", "heading_error", "origin", "path")

    def __init__(self, plant: Plant, track: Track) -> None:
        self.path: LanePath = track.path
        curve, body, x, y = self.path.curve, plant.body, plant.x, plant.y
        east, north = math.cos(plant.heading), math.sin(plant.heading)
        # Searched near the front bumper's place, because a path that crosses itself has two nearest points.
        self.origin, self.across = curve.place_near(x, y, track.along - body.front)
        """Along coordinate of the rear axle on the path, and its offset to the left [m]."""
        self.heading_error = wrapped(plant.heading - curve.heading_at(self.origin))
        self.front = track.along - self.origin
        """Along coordinate of the front bumper [m]."""
        tail_x, tail_y = x - body.rear_overhang * east, y - body.rear_overhang * north
        self.back = curve.place_near(tail_x, tail_y, self.origin - body.rear_overhang)[0] - self.origin

    def to_world(self, along: FloatArray, across: FloatArray) -> FloatArray:
        """Return world coordinates (n, 2) [m]."""
        return self.path.curve.at(np.asarray(along) + self.origin, np.asarray(across))

    def crossings(self) -> list[PathCrossing]:
        """Return the crossings ahead, and those that the ego's body is on."""
        behind, ahead = self.origin + self.back, self.origin + VIEW
        return [c for c in self.path.crossings if c.exit > behind and c.entry < ahead]

    def signals(self) -> list[PathSignal]:
        """Return the path's signals that the ego has not passed."""
        found = self.path.signals + (self.path.signals_beside if self._at_lane_end() else ())
        return [signal for signal in found if self._is_ahead(signal.stop_line)]

    def stop_signs(self) -> list[PathStopSign]:
        """Return the path's stop signs that the ego has not passed."""
        return [sign for sign in self.path.stop_signs if self._is_ahead(sign.stop_line)]

    def junctions(self, reach: float) -> list[PathJunction]:
        """Return the junctions that the ego is in, or comes to within that distance [m]."""
        low, high = self.origin + self.back, self.origin + self.front + reach
        found = self.path.junctions + (self.path.junctions_beside if self._at_lane_end() else ())
        return [junction for junction in found if junction.end > low and junction.start < high]

    def _is_ahead(self, line: float) -> bool:
        """Return whether the front bumper has not passed a line in view."""
        return self.origin + self.front - PASSED_LINE <= line < self.origin + VIEW

    def _at_lane_end(self) -> bool:
        """Return whether the lanes end, or lead off the route, right ahead of the front bumper."""
        return self.path.chain_end - self.origin - self.front < LANE_END
