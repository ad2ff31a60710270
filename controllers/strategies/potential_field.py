"""Steers round pedestrians down an artificial potential field whose ellipses follow the shift that is needed.

Across: the field of the road, with pedestrians where the ego will be level with them and vehicles beside
it; away from pedestrians, in tight bends and where no way past is free, lane keeping, and lane changes that
the route asks for. Along: car-following that obeys leaders, signals, right of way, speed limits and bends.
It yields to no pedestrian that it can steer round. The method has no brake, and at its constant speed it
cannot let anybody pass: where no way past is free, braking is added, with emergency braking behind it.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final, Literal

import numpy as np

from controllers.driving import lane_keeping
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.emergency_braking import EmergencyBraking
from controllers.driving.traffic_driver import TrafficDriver
from controllers.field.field_course import Course, CourseFinder, CourseSettings, follow, with_only
from controllers.field.potential_field import Gains
from controllers.field.road_field import FieldSettings
from controllers.interface import (
    Command,
    Controller,
    Decision,
    EgoState,
    FloatArray,
    Perception,
    Plan,
)
from controllers.prediction import named

GRAVITY = 9.80665
NOBODY: Final = np.zeros(0, dtype=np.int64)
NO_FREE_PATH = "no free path"
WAITING_ENDS = 2.0
"""Deceleration at which an ego without a free way begins to brake [m/s^2]."""
HOLDING = -2.0
"""What keeps a standing car standing [m/s^2]."""
STANDING = 0.05
"""Slower is standing [m/s]."""
CREEPING = 2.0
"""So slow, an ego also stops for who would walk into its side [m/s]."""
FREE_FOR = 0.3
"""A way past must have been free for this time before it is trusted more than the brake [s]."""


class PotentialFieldDriver:
    """Keeps its lane and its place in traffic, and steers round pedestrians."""

    def __init__(self, finder: CourseFinder, style: DrivingStyle, brakes: Brakes | None) -> None:
        self._finder = finder
        self._traffic = TrafficDriver(style)
        self._brakes = brakes
        self._course: Course | None = None
        self._allowed: FloatArray = np.zeros(1)

    def decide(self, perception: Perception) -> Decision:
        """Say which lane to be in, and whom the ego brakes for or goes round."""
        decision = self._traffic.decide(perception)
        self._allowed = self._traffic.accelerations(perception, decision)
        course = self._finder.find(perception, decision, float(self._allowed.mean()))
        self._course = course
        threat = self._brakes.watch(perception, course) if self._brakes is not None else ""
        because = threat or (course.because if course is not None else "") or decision.because
        return replace(decision, because=because)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Steer down the field where it leads past somebody, else along the lane."""
        times, course = lane_keeping.instants(perception.ego), self._course
        acceleration = self._allowed
        if self._brakes is not None:
            acceleration = np.minimum(acceleration, self._brakes.accelerations(perception.ego, times))
        if course is not None and course.free:
            steering = follow(course, perception, acceleration, self._finder.settings.guidance)
        else:
            steering = self._traffic.steering(perception, decision, acceleration)
        command = Command(times, acceleration, steering)
        if course is None:
            return Plan(command)
        drives, row = course.drives, course.chosen
        return Plan(
            command,
            solved=course.free,
            status="ok" if course.free else NO_FREE_PATH,
            passing=course.passing if course.free else "",
            times=drives.times,
            along=drives.along[:, row],
            across=drives.across[:, row],
            speed=drives.speed,
            overlay={
                "conflict_points_m": np.column_stack((course.met.along, course.met.across)),
                "obstacle_ellipses_m": course.ellipses,
                "candidate_paths_m": np.vstack(
                    [np.column_stack((x, y)) for x, y in zip(drives.along.T, drives.across.T, strict=True)]
                ),
            },
        )


class Brakes:
    """Braking for pedestrians, left to the steering while that has a free way past them.

    Where it has none, an ego that would meet somebody brakes so as to stop before him, once that takes
    ``WAITING_ENDS``; emergency braking stands behind that. When that would act, it is the last moment for
    it. So a way must have been free for some time before it is trusted, and who is braked for stays so
    until he is out of danger.
    """

    def __init__(self) -> None:
        self._for_all = EmergencyBraking()
        self._for_vehicles = EmergencyBraking()
        self._free_since: float | None = None
        self._steers = False
        self._yields = False
        self._most = math.inf

    def watch(self, perception: Perception, course: Course | None) -> str:
        """Trigger or release; return because of whom it brakes, empty if it does not."""
        ego = perception.ego
        threat = self._for_all.watch(perception)
        other = self._for_vehicles.watch(with_only(perception, NOBODY))
        if course is None or not course.free:
            self._free_since = None
        elif self._free_since is None:
            self._free_since = ego.time
        free = self._free_since is not None and ego.time - self._free_since >= FREE_FOR - 1e-9
        self._yields = bool(threat) and (self._yields or not free)
        self._steers = free and not self._yields
        self._most = self._allowed(ego, course)
        if self._steers:
            return other
        return threat or (course.because if course is not None and math.isfinite(self._most) else "")

    def accelerations(self, ego: EgoState, times: FloatArray) -> FloatArray:
        """Return what the brakes allow at most over the steps that begin at those times [m/s^2]."""
        if self._steers:
            return self._for_vehicles.accelerations(ego, times)
        return np.minimum(self._for_all.accelerations(ego, times), self._most)

    def _allowed(self, ego: EgoState, course: Course | None) -> float:
        """Return the acceleration that stops the ego before whom it would meet, inf while that can wait."""
        if course is None or course.free or course.stop_within is None:
            return math.inf
        if ego.speed < STANDING:
            return HOLDING
        if math.isinf(course.stop_within):
            return HOLDING if ego.speed < CREEPING else 0.0
        needed = ego.speed**2 / (2.0 * max(course.stop_within, 0.1))
        waits = needed < WAITING_ENDS and self._most >= 0.0
        return math.inf if waits else -min(needed, ego.drive.max_deceleration)


def build(
    *,
    axis: Literal["variable", "fixed"] = "variable",
    fixed_axis_m: float = 15.0,
    side_margin_m: float = 0.6,
    shift_acceleration_mps2: float = 0.3 * GRAVITY,
    obstacle_gain: float = 0.30,
    centre_gain: float = 0.05,
    edge_gain: float = 0.02,
    line_gain: float = 0.02,
    line_width_m: float = 0.5,
    clearance_m: float = 0.3,
    braking: Literal["aeb", "none"] = "aeb",
    predictor: str = "direction_model",
    headway_s: float = 1.0,
    seed: int = 1,
) -> Controller:
    """Build the controller.

    Parameters
    ----------
    axis : {"variable", "fixed"}
        Whether the long half-axis of a pedestrian's ellipse follows from the shift that is needed to get
        past him, or is the same for everybody, the comparison of the paper.
    fixed_axis_m : float
        That one [m].
    side_margin_m : float
        Distance wanted beside a pedestrian, S_m [m].
    shift_acceleration_mps2 : float
        Lateral acceleration of the shift, a_y [m/s²].
    obstacle_gain, centre_gain, edge_gain, line_gain : float
        Weights of obstacles, centre line, road edges and lines between lanes, relative to the pull onwards.
    line_width_m : float
        How far the field of a line between lanes reaches [m].
    clearance_m : float
        What has to be left beside a pedestrian for a way past to count as free [m].
    braking : {"aeb", "none"}
        Braking where no way past is free; or none for pedestrians, as in the paper: the field is followed
        then as long as it leaves neither the road nor other vehicles alone, whoever is met.
    predictor : str
        How pedestrians are expected to walk; one of ``controllers.prediction.named.names()``.
    headway_s : float
        Time gap to a leader [s].
    seed : int
        Of a predictor that draws random numbers.

    Raises
    ------
    ValueError
        If a value is out of its range, or there is no such predictor.
    """
    for name, value in {
        "fixed_axis_m": fixed_axis_m,
        "shift_acceleration_mps2": shift_acceleration_mps2,
        "line_width_m": line_width_m,
    }.items():
        if not 0.0 < value < math.inf:
            raise ValueError(f"{name} = {value} must be greater than 0 and finite")
    for name, value in {
        "side_margin_m": side_margin_m,
        "obstacle_gain": obstacle_gain,
        "centre_gain": centre_gain,
        "edge_gain": edge_gain,
        "line_gain": line_gain,
        "clearance_m": clearance_m,
        "headway_s": headway_s,
    }.items():
        if not 0.0 <= value < math.inf:
            raise ValueError(f"{name} = {value} must be at least 0 and finite")
    gains = Gains(1.0, centre_gain, obstacle_gain, edge_gain, line_gain, line_width_m)
    field = FieldSettings(
        side_margin_m, shift_acceleration_mps2, fixed_axis_m if axis == "fixed" else None, gains
    )
    brakes = Brakes() if braking == "aeb" else None
    settings = CourseSettings(field, clearance=clearance_m if brakes is not None else None)
    finder = CourseFinder(named.build(predictor, seed=seed), settings)
    return PotentialFieldDriver(finder, DrivingStyle(headway=headway_s), brakes)
