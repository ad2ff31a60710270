"""A chosen candidate while it is driven: where it leads, and the commands that keep the car on it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from controllers.arrays import FloatArray
from controllers.drivable_area.braking_profile import SmoothBraking
from controllers.drivable_area.motions import arc_lengths
from controllers.drivable_area.quintic_path import QuinticPaths
from controllers.driving import lane_keeping
from controllers.interface import EgoState, Perception

SPEED_GAIN = 1.0
"""Acceleration commanded per unit of speed error [1/s]."""
PLACE_GAIN = 0.2
"""Acceleration commanded per unit of distance error; a car that is too far ahead brakes [1/s^2]."""
APPROACH_TIME = 0.8
"""Time constant with which the distance to the path decays [s]."""
HEADING_TIME = 0.3
"""Time constant with which the heading error decays [s]."""
APPROACH_LENGTH = 3.0
"""Length constant that takes the place of ``APPROACH_TIME`` at low speed [m]."""
HEADING_LENGTH = 1.2
"""Length constant that takes the place of ``HEADING_TIME`` at low speed [m]."""


@dataclass(frozen=True, slots=True)
class Course:
    """One candidate, and how far the car has driven along it."""

    path: QuinticPaths
    """A single path, in the route frame in which it was planned."""
    speeds: SmoothBraking
    lane: int
    """``Lane.number`` of the reference lane in which it was planned."""
    offset: float = 0.0
    """Present across coordinate of that lane's centre line [m]."""
    elapsed: float = 0.0
    """Time since it was planned [s]."""
    progress: float = 0.0
    """Distance along the road since then [m]."""
    driven: float = 0.0
    """Distance that the car has driven since then [m]."""

    @property
    def end(self) -> float:
        """Return y_f as a present across coordinate [m]."""
        return float(self.path.end[0]) + self.offset

    @property
    def final_speed(self) -> float:
        """Return v_s [m/s]."""
        return float(self.speeds.final_speed[0])

    def moved(self, before: EgoState, perception: Perception) -> Course | None:
        """Return the course as seen from where the car is now; ``None`` once its lane is out of view."""
        ego = perception.ego
        lane = perception.road.lane(self.lane)
        if lane is None:
            return None
        step = math.hypot(ego.x - before.x, ego.y - before.y)
        bend = lane_keeping.curvature_at(perception.road, 0.0)
        stretch = max(1.0 - bend * ego.across, 0.2)
        onward = step * math.cos(0.5 * (before.heading_error + ego.heading_error)) / stretch
        return replace(
            self,
            offset=lane.offset,
            elapsed=self.elapsed + ego.time - before.time,
            progress=self.progress + onward,
            driven=self.driven + step,
        )

    def points(self, along: FloatArray) -> FloatArray:
        """Return the path's points at places ahead, shape (n, 2) [m]."""
        across, _, _ = self.path.at((along + self.progress)[None, :])
        return np.column_stack((along, across[0] + self.offset))

    def states(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return planned places along and across, headings and speeds at times from now."""
        planned = times + self.elapsed
        position, speed, _ = self.speeds.at(planned[None, :])
        now, _, _ = self.speeds.at(np.array([[self.elapsed]]))
        grid = np.linspace(0.0, self.path.length, 61)
        lengths = arc_lengths(self.path, grid)[0]
        # The course starts where the car really is and goes on from there as planned.
        here = float(np.interp(self.progress, grid, lengths)) + max(self.progress - grid[-1], 0.0)
        ahead = here + position[0] - now[0, 0]
        along = np.interp(ahead, lengths, grid) + np.maximum(ahead - lengths[-1], 0.0)
        across, slope, _ = self.path.at(along[None, :])
        return along - self.progress, across[0] + self.offset, np.arctan(slope[0]), speed[0]

    def accelerations(self, ego: EgoState, times: FloatArray) -> FloatArray:
        """Return the commands that make the car keep the planned speed in spite of the drive's lag [m/s^2].

        Parameters
        ----------
        ego : present state of the ego
        times : times from now at which the commands begin [s]
        """
        drive = ego.drive
        step = float(times[1] - times[0]) if len(times) > 1 else ego.plan_interval
        middle = times + 0.5 * step + self.elapsed
        # A first-order lag delays a command, so the command is what is planned one lag later.
        _, _, ahead = self.speeds.at((middle + drive.drive_lag)[None, :])
        position, speed, _ = self.speeds.at(np.array([[self.elapsed]]))
        behind = min(max(position[0, 0] - self.driven, -2.0), 2.0)
        correction = SPEED_GAIN * (speed[0, 0] - ego.speed) + PLACE_GAIN * behind
        if self.final_speed == 0.0 and ego.speed < 0.3 and speed[0, 0] < 0.3:
            correction = min(correction, -0.5)
        wanted = ahead[0] + correction
        return np.asarray(np.clip(wanted, -drive.max_deceleration, drive.max_acceleration))


def steering(perception: Perception, course: Course, acceleration: FloatArray, lateral: float) -> FloatArray:
    """Return the front-wheel angles that keep the car on a course, one for each instant [rad].

    Parameters
    ----------
    perception : what the ego knows
    course : course to keep the car on
    acceleration : acceleration commanded at ``lane_keeping.instants(perception.ego)`` [m/s^2]
    lateral : largest lateral acceleration [m/s^2]

    Notes
    -----
    This is the control law of lane keeping for a curved path: ψ* = ψ_path − e / ℓ_e, and curvature = that of
    road and path a little ahead + (ψ* − ψ) / ℓ_ψ − sin(ψ − ψ_path) / ℓ_e.
    """
    ego, road = perception.ego, perception.road
    drive, car = ego.drive, lane_keeping.Bicycle(ego)
    angles = np.zeros(len(acceleration))
    preview = drive.steering_lag + lane_keeping.STEP
    for i, wanted in enumerate(acceleration):
        speed, heading = car.speed, car.heading
        ahead = car.along + speed * np.array([0.0, 0.5 * preview, preview])
        y, slope, bend = (one[0] for one in course.path.at((ahead + course.progress)[None, :]))
        ways = np.arctan(slope)
        curve = bend / (1.0 + slope**2) ** 1.5 + [lane_keeping.curvature_at(road, float(a)) for a in ahead]
        approach = max(APPROACH_LENGTH, speed * APPROACH_TIME)
        settling = max(HEADING_LENGTH, speed * HEADING_TIME)
        error = car.across - y[0] - course.offset
        aim = float(ways[0]) - min(max(error / approach, -0.4), 0.4)
        correction = (aim - heading) / settling - math.sin(heading - float(ways[0])) / approach
        total = float(curve[-1]) + correction
        bound = lateral / max(speed * speed, 1.0)
        total = min(max(total, -bound), bound)
        wheel = math.atan(ego.body.wheelbase * total)
        angles[i] = min(max(wheel, -drive.max_steering), drive.max_steering)
        car.move(float(wanted), float(angles[i]), road)
    return angles
