"""Steers round pedestrians down an artificial potential field whose ellipses follow the shift that is needed.

Across: the field of the road, with pedestrians where the ego will be level with them and vehicles beside it;
away from pedestrians, in tight bends and where no way past is free, lane keeping, and lane changes that the
route requires. Along: car-following that obeys leaders, signals, right of way, speed limits and bends. The
ego yields to no pedestrian that it can steer round. The paper's method has no brake, and at its constant
speed it cannot let anybody go first. Here, where no way past is free at the speed that traffic allows, steady
braking is combined with the steering, and the way down the field is searched for at each deceleration. If no
way is free then either, the ego stops, with emergency braking as a fallback.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving import lane_keeping
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.standing import HOLDING, STANDING
from controllers.driving.traffic_driver import TrafficDriver
from controllers.interface import Command, Controller, Decision, EgoState, Perception, Plan
from controllers.own_part import ANGLE, OwnPart, differ
from controllers.perception import NOBODY
from controllers.potential_field.field import Gains
from controllers.potential_field.field_course import Course, CourseFinder, CourseSettings, follow
from controllers.potential_field.road_field import SLOWEST, FieldSettings
from controllers.prediction import by_name
from controllers.prediction.by_name import PredictorName
from controllers.safety.emergency_braking import EmergencyBraking
from controllers.settings import ControllerSettings, NotNegative, Positive, Unit

NO_FREE_PATH = "no free path"
WAITING_ENDS = 2.0
"""An ego without a free way begins to brake once this deceleration is needed [m/s^2]."""
CREEPING = 2.0
"""An ego slower than this also stops for pedestrians who would walk into its side [m/s]."""
SHARES = (0.25, 0.5, 0.75, 1.0)
"""Shares of the largest steady deceleration that are tried, one after another."""
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
        """Return which lane to be in, and whom the ego brakes for or goes round."""
        decision = self._traffic.decide(perception)
        self._allowed = self._traffic.accelerations(perception, decision)
        course = self._finder.find(perception, decision, float(self._allowed.mean()))
        self._course = course
        threat = self._brakes.watch(perception, course) if self._brakes is not None else ""
        because = threat or (course.because if course is not None else "") or decision.because
        return replace(decision, because=because)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Steer down the field where it leads past pedestrians, otherwise along the lane."""
        times, course = lane_keeping.instants(perception.ego), self._course
        acceleration = self._allowed
        if course is not None and course.free and course.braking > 0.0:
            slowing = np.where(perception.ego.speed - course.braking * times > SLOWEST, -course.braking, 0.0)
            acceleration = np.minimum(acceleration, slowing)
        steady = acceleration
        if self._brakes is not None:
            acceleration = np.minimum(acceleration, self._brakes.accelerations(perception.ego, times))
        if course is not None and course.free:
            steering = follow(course, perception, acceleration, self._finder.settings.guidance)
        else:
            steering = self._traffic.steering(perception, decision, acceleration)
        command = Command(times, acceleration, steering)
        own = self._own(course, steady, acceleration, steering, perception, decision)
        if course is None:
            return Plan(command, own=own)
        drives, row = course.drives, course.chosen
        return Plan(
            command,
            solved=course.free,
            own=own,
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

    def _own(
        self,
        course: Course | None,
        steady: FloatArray,
        acceleration: FloatArray,
        steering: FloatArray,
        perception: Perception,
        decision: Decision,
    ) -> OwnPart:
        """Return what the field itself does about pedestrians, without the brakes.

        ``steady`` is the acceleration that traffic and the way past allow, without those brakes.
        """
        braked = differ(acceleration, steady)
        if course is None:
            return OwnPart(False, False, braked, braked)
        free = self._traffic.steering(perception, decision, acceleration)
        deviates = differ(acceleration, self._allowed) or differ(steering, free, ANGLE)
        return OwnPart(course.pushed, course.pushed and course.free and not braked, deviates, braked)


class Brakes:
    """Brakes for pedestrians, unless the steering has a free way past them.

    Without a free way, an ego that would meet pedestrians brakes so as to stop before them, once that takes
    ``WAITING_ENDS``, with emergency braking as a fallback. The moment at which emergency braking would act is
    the last one for it. So a way must have been free for some time before it is trusted, and braking for
    pedestrians goes on until they are out of danger.
    """

    def __init__(self) -> None:
        self._for_all = EmergencyBraking()
        self._for_vehicles = EmergencyBraking()
        self._free_since: float | None = None
        self._steers = False
        self._yields = False
        self._most = math.inf

    def watch(self, perception: Perception, course: Course | None) -> str:
        """Trigger or release the brakes; return for whom they act, empty for nobody."""
        ego = perception.ego
        threat = self._for_all.watch(perception)
        other = self._for_vehicles.watch(replace(perception, pedestrians=NOBODY))
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
        """Return the largest accelerations that the brakes allow in steps from ``times`` on [m/s^2]."""
        if self._steers:
            return self._for_vehicles.accelerations(ego, times)
        return np.minimum(self._for_all.accelerations(ego, times), self._most)

    def _allowed(self, ego: EgoState, course: Course | None) -> float:
        """Return the acceleration that stops the ego before people it would meet, inf while that can wait."""
        if course is None or course.free or course.stop_within is None:
            return math.inf
        if ego.speed < STANDING:
            return HOLDING
        if math.isinf(course.stop_within):
            return HOLDING if ego.speed < CREEPING else 0.0
        needed = ego.speed**2 / (2.0 * max(course.stop_within, 0.1))
        waits = needed < WAITING_ENDS and self._most >= 0.0
        return math.inf if waits else -min(needed, ego.drive.max_deceleration)


FIELD = FieldSettings()
GAINS = Gains()


class Settings(ControllerSettings):
    """The parameters of the controller; gains are relative to the pull onwards."""

    axis: Literal["variable", "fixed"] = "variable"
    """Whether the long half-axis of a pedestrian's ellipse follows from the shift needed to pass them, or is
    the same for everybody (the paper's comparison)."""
    fixed_axis_m: Positive = 15.0
    """Long half-axis of all ellipses with ``axis = fixed``."""
    side_margin_m: NotNegative = FIELD.margin
    """S_m, desired distance beside a pedestrian."""
    shift_acceleration_mps2: Positive = FIELD.lateral_acceleration
    """Lateral acceleration of the shift, a_y."""
    obstacle_gain: NotNegative = float(GAINS.obstacle)
    """Weight of obstacles."""
    centre_gain: Annotated[NotNegative, Unit("1/m²")] = float(GAINS.centre)
    """Weight of the centre line."""
    edge_gain: Annotated[NotNegative, Unit("m²")] = float(GAINS.edge)
    """Weight of the road's edges."""
    line_gain: NotNegative = float(GAINS.line)
    """Weight of the lines between lanes."""
    line_width_m: Positive = float(GAINS.line_width)
    """Reach of the field of a line between lanes."""
    clearance_m: NotNegative = 0.3
    """Distance that must be left beside a pedestrian for a way past to count as free."""
    braking: Literal["aeb", "none"] = "aeb"
    """Braking where no way past is free; or none for pedestrians, as in the paper: the field is then followed
    as long as it stays on the road and clear of other vehicles, even if it meets pedestrians."""
    steady_braking_mps2: NotNegative = 3.0
    """Largest steady deceleration that is combined with steering where the field has no free way at the speed
    that traffic allows; a quarter, half and three quarters of it are tried before. 0: none, as in the paper.
    Only with ``braking = aeb``."""
    predictor: PredictorName = "direction_model"
    """Model that predicts how pedestrians walk."""
    headway_s: NotNegative = 1.0
    """Time gap to a leader."""


def build(settings: Settings) -> Controller:
    """Build the controller."""
    gains = Gains(
        centre=settings.centre_gain,
        obstacle=settings.obstacle_gain,
        edge=settings.edge_gain,
        line=settings.line_gain,
        line_width=settings.line_width_m,
    )
    field = FieldSettings(
        settings.side_margin_m,
        settings.shift_acceleration_mps2,
        settings.fixed_axis_m if settings.axis == "fixed" else None,
        gains,
    )
    brakes = Brakes() if settings.braking == "aeb" else None
    steady = settings.steady_braking_mps2 if brakes is not None else 0.0
    course = CourseSettings(
        settings.clearance_m if brakes is not None else None,
        field,
        brakings=tuple(share * steady for share in SHARES) if steady else (),
    )
    finder = CourseFinder(by_name.build(settings.predictor, seed=settings.seed), course)
    return PotentialFieldDriver(finder, DrivingStyle(headway=settings.headway_s), brakes)
