"""What candidates cost in a scene, and which of them are feasible."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from controllers.arrays import FloatArray
from controllers.drivable_area.braking_profile import (
    SmoothBraking,
    longest_duration,
    shortest_duration,
)
from controllers.drivable_area.clearances import Boxes, Shape, apart
from controllers.drivable_area.costs import (
    CostWeights,
    SpeedRisk,
    curvature_cost,
    distance_cost,
    speed_risk,
)
from controllers.drivable_area.drivable_entropy import EntropyAt, EntropyMode
from controllers.drivable_area.meetings import Meetings, meetings
from controllers.drivable_area.motions import Motions, motions
from controllers.drivable_area.quintic_path import PathStart, QuinticPaths, quintic_paths
from controllers.prediction.social_force_model import SocialForceModel, Walkers
from controllers.safety.emergency_braking import GRAVITY

STANDING = 0.1
"""Below this speed, the car counts as standing and runs into nobody [m/s]."""


@dataclass(frozen=True, slots=True)
class CarLimits:
    """What the car can do."""

    deceleration: float = 0.8 * GRAVITY
    """a_bmax [m/s^2]"""
    acceleration: float = 1.5
    """Acceleration of candidates that become faster than the car is now [m/s^2]."""
    curvature: float = 0.26
    """k_lim [1/m]"""
    friction: float = 0.8
    """f; braking and turning together may need at most f g."""
    steering_rate: float = 0.6
    """Largest steering rate of the front wheels [rad/s]."""


@dataclass(frozen=True, slots=True)
class Rules:
    """How candidates are made and judged."""

    weights: CostWeights = field(default_factory=CostWeights)
    entropy: EntropyMode = EntropyMode.SHANNON
    entropy_at: EntropyAt = EntropyAt.LARGEST
    risk: SpeedRisk = SpeedRisk.METRES_PER_SECOND
    largest_curvature: float = 0.1
    """k_max of the curvature cost [1/m]."""
    within_friction: bool = True
    """Whether candidates have to stay within the tyres' grip and the steering's rate."""
    full_braking: bool = False
    """Whether the car reaches v_s as fast as possible, as in the paper, or only where it is needed."""
    dead_time: float = 0.0
    """Time before the candidates begin to change their speed [s]."""
    margin: float = 0.3
    """Distance that has to be kept to pedestrians' discs; it grows from 0 to this in ``margin_time`` [m]."""
    margin_time: float = 1.0
    """Time in which ``margin`` grows to its full value [s]."""
    vehicle_margin: float = 0.3
    """Distance that has to be kept to vehicles [m]."""
    edge_margin: float = 0.1
    """Distance that has to be kept to the road's edges [m]."""
    horizon: float = 5.0
    """Time over which candidates are judged [s]."""
    step: float = 0.1
    """Time between two instants at which candidates are judged [s]."""
    walks: int = 16
    """Number of random walks of each pedestrian."""
    model: SocialForceModel = field(default_factory=SocialForceModel)

    @property
    def times(self) -> FloatArray:
        """Return the instants at which candidates are judged [s]."""
        return np.arange(round(self.horizon / self.step) + 1, dtype=np.float64) * self.step


@dataclass(frozen=True, slots=True)
class Scene:
    """The scene for the candidates; the x axis runs along the road from the car's reference point."""

    shape: Shape
    limits: CarLimits
    start: PathStart
    speed: float
    """v0 [m/s]"""
    fastest: float
    """Highest final speed, with which progress is compared [m/s]."""
    acceleration: float
    """a0 [m/s^2]"""
    length: float
    """x_f [m]"""
    braking_distance: float
    """Distance within which v_s should be reached [m]."""
    right: float
    """Across coordinate of the road's right edge; ``left`` likewise [m]."""
    left: float
    people: Walkers
    """Where the pedestrians are, and the velocities they are expected to keep; shape (p,)."""
    boxes: Boxes | None = None
    """Other vehicles at the rules' times."""
    bend: FloatArray = field(default_factory=lambda: np.zeros(1))
    """Curvature of the road at multiples of ``bend_step`` [1/m]."""
    bend_step: float = 1.0
    wheelbase: float = 2.6
    """[m]"""


@dataclass(frozen=True, slots=True)
class Verdict:
    """The results for n candidates."""

    motions: Motions
    paths: QuinticPaths
    speeds: SmoothBraking
    costs: FloatArray
    """Costs of curvature, distance, entropy and progress; shape (n, 4)."""
    violations: FloatArray
    """Violations for pedestrians, vehicles, edges and limits; positive where violated, shape (n, 4)."""
    lateral: FloatArray
    """Largest lateral acceleration, shape (n,) [m/s^2]."""
    total: FloatArray
    """Largest acceleration along and across together, shape (n,) [m/s^2]."""
    meetings: Meetings

    @property
    def feasible(self) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """Say which candidates violate nothing."""
        return np.asarray((self.violations <= 0.0).all(axis=1))


def judge(scene: Scene, rules: Rules, end: FloatArray, final_speed: FloatArray, noise: FloatArray) -> Verdict:
    """Return the verdict on n candidates.

    Parameters
    ----------
    scene, rules : the scene, and how to make and judge candidates
    end : y_f, shape (n,) [m]
    final_speed : v_s, shape (n,) [m/s]
    noise : standard normal numbers for the random walks of the first p people, shape (K, p, w)
    """
    paths = quintic_paths(scene.start, scene.length, end)
    speeds = smooth_speeds(scene, rules, final_speed)
    moving = motions(paths, speeds, rules.times, rules.dead_time)
    number = noise.shape[1]
    people = scene.people
    walking = Walkers(people.x[:number], people.y[:number], people.x_speed[:number], people.y_speed[:number])
    met_at = None
    if rules.entropy_at is EntropyAt.MEETING:
        met_at = rules.dead_time + speeds.arrival(max(scene.length - rules.dead_time * scene.speed, 0.0))
    friction = scene.limits.friction
    met = meetings(scene.shape, walking, moving, rules.model, friction, noise, rules.entropy, met_at)
    lost = 1.0 - final_speed / max(scene.fastest, 1e-9)
    costs = np.column_stack(
        (
            curvature_cost(paths, rules.largest_curvature),
            distance_cost(speed_risk(final_speed, rules.risk), met.clearance),
            met.entropy,
            lost,
        )
    )
    lateral, total, beyond_limits = _effort(scene, rules, moving)
    violations = np.column_stack(
        (
            _people_violation(scene, rules, moving),
            _vehicle_violation(scene, rules, moving),
            _edge_violation(scene, rules, moving),
            beyond_limits,
        )
    )
    return Verdict(moving, paths, speeds, costs, violations, lateral, total, met)


def smooth_speeds(scene: Scene, rules: Rules, final_speed: FloatArray) -> SmoothBraking:
    """Return the cubic speeds.

    With ``full_braking`` the candidates brake as hard as allowed. Otherwise they reach v_s at
    ``braking_distance`` or, if that takes more braking than the limit, as soon as the limit allows.
    """
    limits, start = scene.limits, scene.speed
    begin = min(max(scene.acceleration, -limits.deceleration), limits.acceleration)
    slower = final_speed < start
    shortest = shortest_duration(start, final_speed, begin, limits.deceleration)
    duration = shortest
    if not rules.full_braking:
        mean = 0.5 * (start + final_speed)
        left = max(scene.braking_distance - rules.dead_time * start, 0.0)
        # (v0 + v_s) t / 2 + a0 t² / 12 = distance; without a root, the car never reaches the place.
        under = mean**2 + begin * left / 3.0
        needed = 2.0 * left / np.maximum(mean + np.sqrt(np.maximum(under, 0.0)), 1e-9)
        needed = np.where(under < 0.0, np.inf, needed)
        longest = longest_duration(start, final_speed, begin)
        duration = np.maximum(np.minimum(np.minimum(needed, longest), 1e3), shortest)
    faster = 1.5 * (final_speed - start) / limits.acceleration
    count = len(final_speed)
    return SmoothBraking(
        np.full(count, start), final_speed, np.where(slower, begin, 0.0), np.where(slower, duration, faster)
    )


def _people_violation(scene: Scene, rules: Rules, moving: Motions) -> FloatArray:
    """Return by how much the car falls short of the margin to people who keep their velocities [m]."""
    people = scene.people
    if len(people.x) == 0:
        return np.full(len(moving.along), -1.0)
    x = people.x[:, None] + people.x_speed[:, None] * moving.times
    y = people.y[:, None] + people.y_speed[:, None] * moving.times
    clearance = scene.shape.clearance(
        moving.along[:, None, :], moving.across[:, None, :], moving.heading[:, None, :], x, y
    )
    wanted = rules.margin * np.clip(moving.times / max(rules.margin_time, 1e-9), 0.0, 1.0)
    missing = np.where(moving.speed[:, None, :] > STANDING, wanted - clearance, -1.0)
    return np.asarray(missing.max(axis=(1, 2)))


def _vehicle_violation(scene: Scene, rules: Rules, moving: Motions) -> FloatArray:
    """Return by how much the car falls short of the margin to vehicles [m].

    The car must not come nearer to a vehicle that is already nearer than the margin. A vehicle that already
    overlaps the car does not count.
    """
    boxes = scene.boxes
    if boxes is None or len(boxes) == 0:
        return np.full(len(moving.along), -1.0)
    gap = apart(moving.along, moving.across, moving.heading, scene.shape.body, boxes)
    now = gap[:, :, :1]
    wanted = np.minimum(rules.vehicle_margin, now - 0.05)
    counted = (now > 0.0) & (moving.speed[:, None, :] > STANDING)
    return np.asarray(np.where(counted, wanted - gap, -1.0).max(axis=(1, 2)))


def _edge_violation(scene: Scene, rules: Rules, moving: Motions) -> FloatArray:
    """Return by how much the car falls short of the margin to the road's edges [m].

    A car that is already nearer to an edge than the margin must only not come nearer.
    """
    beyond = scene.shape.beyond_edges(moving.across, moving.heading, scene.right, scene.left)
    allowed = np.maximum(-rules.edge_margin, beyond[:, :1])
    return np.asarray((beyond - allowed - 1e-6).max(axis=1))


def _effort(scene: Scene, rules: Rules, moving: Motions) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return lateral and total accelerations [m/s^2], and the share by which they exceed the limits."""
    limits = scene.limits
    road = np.interp(moving.along, np.arange(len(scene.bend)) * scene.bend_step, scene.bend)
    turning = moving.curvature + road
    across = moving.speed**2 * np.abs(turning)
    lateral = across.max(axis=1)
    total = np.hypot(across, moving.acceleration).max(axis=1)
    driven = moving.speed > STANDING
    bent = np.where(driven, np.abs(moving.curvature), 0.0).max(axis=1)
    worst = bent / limits.curvature - 1.0
    if rules.within_friction:
        angle = np.arctan(scene.wheelbase * turning)
        rate = np.where(driven[:, 1:], np.abs(np.diff(angle, axis=1)), 0.0).max(axis=1) / rules.step
        # The 2 % allow for rounding and the step size if the car already brakes as hard as it can.
        worst = np.maximum(worst, total / (1.02 * limits.friction * GRAVITY) - 1.0)
        worst = np.maximum(worst, rate / limits.steering_rate - 1.0)
    return lateral, total, np.asarray(worst)
