"""Looks for the best way past pedestrians within what the car can reach, by NSGA-II over path and speed.

Both axes while a pedestrian is in the way: a quintic path across the road to a final offset and a cubic speed
to a final speed, found once every ``replan_s`` and followed in between. Otherwise car-following that obeys
leaders, signals, right of way, speed limits and bends, lane keeping, and lane changes for the route. An
avoidance never exceeds the accelerations that these allow either, and emergency braking for vehicles is
added. If no candidate is possible, the car brakes fully and goes straight on.
"""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from controllers.arrays import FloatArray
from controllers.conflicts.expected_behaviour import PedestrianAssumptions, Watch
from controllers.conflicts.path_conflicts import Conflicts
from controllers.drivable_area.activation import in_reaction_space
from controllers.drivable_area.avoidance import AvoidanceSettings, Found, plan
from controllers.drivable_area.clearances import Shape
from controllers.drivable_area.conflict import Conflict, Outlook, first_conflict, outlook, relevant
from controllers.drivable_area.costs import CostWeights, SpeedRisk
from controllers.drivable_area.course import Course, steering
from controllers.drivable_area.drivable_entropy import EntropyAt, EntropyMode
from controllers.drivable_area.evaluation import STANDING, Rules
from controllers.drivable_area.pareto_search import Budget
from controllers.drivable_area.reaction_space import ReactionSpace
from controllers.driving import lane_keeping
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.standing import HOLDING
from controllers.driving.traffic_driver import TrafficDriver
from controllers.interface import Command, Controller, Decision, EgoState, Perception, Plan
from controllers.optimisation.packages import require_pymoo
from controllers.own_part import ANGLE, IDLE, OwnPart, differ
from controllers.perception import NOBODY
from controllers.safety.emergency_braking import GRAVITY, BrakingRule, EmergencyBraking
from controllers.settings import AtLeastOne, ControllerSettings, NotNegative

NO_CANDIDATE = "no_feasible_candidate"
OUTLOOK_STEP = 0.2
"""Time step of the motion that is checked for conflicts [s]."""
AGAIN_AFTER = 0.3
"""If a course has become impossible, or none was found, the search is repeated after this time [s]."""
DRAWN = 8
"""Number of candidates that a replay may draw."""
STANDOFF = 1.0
"""Distance kept to a pedestrian's path where there is no stop line [m]."""
RELEASE = 0.3
"""An avoidance ends with this much more room than where it begins [m]."""


LASTING = 1.3
"""Factor by which the reaction space reaches farther while the method acts."""


class Activation(StrEnum):
    """For whom the method acts."""

    REACTION_SPACE = "reaction_space"
    """Everybody who will be on the road in the reaction space, or is on a collision course."""
    COLLISION_COURSE = "collision_course"
    """Everybody who would come nearer than the margin if both went on as expected."""


class DrivableAreaDriver:
    """Drives as traffic requires, and along a chosen candidate while a pedestrian is in the way."""

    def __init__(
        self,
        settings: AvoidanceSettings,
        activation: Activation,
        replan: float,
        style: DrivingStyle,
        seed: int,
    ) -> None:
        self._settings = settings
        self._activation = activation
        self._replan = replan
        self._traffic = TrafficDriver(style)
        self._brake = EmergencyBraking(BrakingRule(settings.friction))
        self._watch = Watch()
        self._assume = PedestrianAssumptions()
        self._seeds = np.random.default_rng(seed)
        self._before: EgoState | None = None
        self._course: Course | None = None
        self._found: Found | None = None
        self._planned_at = -np.inf
        self._failed = False
        self._conflict: Conflict | None = None
        self._people: Conflicts | None = None
        self._threat = ""

    def decide(self, perception: Perception) -> Decision:
        """Return which lane to be in, and who is in the way."""
        decision = self._traffic.decide(perception)
        self._follow_up(perception)
        times = np.arange(0.0, self._settings.rules.horizon + 1e-9, OUTLOOK_STEP)
        allowed = self._traffic.outlook(perception, decision, times)
        lane = perception.road.lane(decision.target_lane)
        expected = outlook(perception, times, allowed, lane.offset if lane else 0.0)
        self._people = relevant(perception, self._watch, self._settings.rules.horizon, self._assume)
        self._conflict = self._in_conflict(perception, expected, self._people)
        self._threat = self._brake.watch(replace(perception, pedestrians=NOBODY))
        threat = self._threat or (self._conflict.name if self._conflict is not None else "")
        return replace(decision, because=threat) if threat else decision

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Drive along the road, or past pedestrians who are in the way."""
        ego = perception.ego
        times = lane_keeping.instants(ego)
        allowed = self._traffic.accelerations(perception, decision)
        allowed = np.minimum(allowed, self._brake.accelerations(ego, times))
        if self._conflict is None or self._people is None:
            self._course, self._found, self._failed = None, None, False
            angles = self._traffic.steering(perception, decision, allowed)
            return Plan(Command(times, allowed, angles), own=IDLE)
        if self._due(ego.time):
            self._search(perception, self._people, self._conflict)
        if self._course is None:
            return self._stop(perception, times)
        acceleration = np.minimum(allowed, self._course.accelerations(ego, times))
        lateral = self._settings.friction * GRAVITY
        angles = steering(perception, self._course, acceleration, lateral)
        free = self._traffic.steering(perception, decision, allowed)
        deviates = differ(acceleration, allowed) or differ(angles, free, ANGLE)
        braked = self._threat != ""
        ahead = self._settings.rules.times[::2]
        along, across, _, speed = self._course.states(ahead)
        return Plan(
            Command(times, acceleration, angles),
            times=ahead,
            along=along,
            across=across,
            speed=speed,
            overlay=self._overlay(ego),
            own=OwnPart(True, not braked, deviates, braked),
        )

    def _in_conflict(self, perception: Perception, expected: Outlook, people: Conflicts) -> Conflict | None:
        """Return whom the method acts for: whom the car would meet, else anybody in the reaction space."""
        shape = Shape(perception.ego.body)
        met = first_conflict(expected, people, shape, self._margins(people), STANDOFF)
        if met is not None or self._activation is Activation.COLLISION_COURSE:
            return met
        stretch = LASTING if self._course is not None else 1.0
        friction = self._settings.friction
        return in_reaction_space(expected, people, shape, perception.road, friction, STANDOFF, stretch)

    def _follow_up(self, perception: Perception) -> None:
        """Move the course to where the car is now."""
        ego, before = perception.ego, self._before
        self._before = ego
        if self._course is not None and before is not None:
            self._course = self._course.moved(before, perception)

    def _margins(self, people: Conflicts) -> FloatArray:
        """Return the distances below which people are in conflict [m].

        An avoidance that has begun ends only with more room, except beside a pedestrian who has stood for
        long while the car stood too: nothing would ever end it.
        """
        avoiding = self._course is not None or self._failed
        extra = [
            RELEASE if avoiding and not self._watch.lets_go_first(name, self._assume) else 0.0
            for name in people.names
        ]
        return np.array(extra) + self._settings.rules.margin

    def _due(self, time: float) -> bool:
        """Return whether to search for candidates now."""
        age = time - self._planned_at
        if age > self._replan - 1e-6:
            return True
        if self._course is not None and self._possible(self._course):
            return False
        return age > AGAIN_AFTER - 1e-6 or (self._course is None and not self._failed)

    def _possible(self, course: Course) -> bool:
        """Return whether a course still leads past everybody, with at least half the margin."""
        people, before = self._people, self._before
        if people is None or before is None or len(people) == 0:
            return True
        rules = self._settings.rules
        along, across, heading, speed = course.states(rules.times)
        x = people.along[:, None] + people.along_speed[:, None] * rules.times
        y = people.across[:, None] + people.across_speed[:, None] * rules.times
        clearance = Shape(before.body).clearance(along, across, heading, x, y)
        needed = 0.5 * rules.margin * np.clip(rules.times, 0.0, 1.0)
        return not bool(((clearance < needed) & (speed > STANDING)).any())

    def _search(self, perception: Perception, people: Conflicts, conflict: Conflict) -> None:
        """Search for candidates and take the chosen one."""
        self._planned_at = perception.ego.time
        seed = int(self._seeds.integers(2**31))
        self._found = plan(perception, people, conflict, self._settings, self._course, seed)
        self._course = self._found.course if self._found else None
        self._failed = self._found is None

    def _stop(self, perception: Perception, times: FloatArray) -> Plan:
        """Return the declared fallback: full braking, straight on."""
        ego = perception.ego
        full = min(self._settings.friction * GRAVITY, ego.drive.max_deceleration)
        braking = np.full(len(times), -full if ego.speed > STANDING else HOLDING)
        angles = lane_keeping.steering(perception, ego.across, braking)
        own = OwnPart(applies=True, acts=False, deviates=True, overridden=True)
        return Plan(Command(times, braking, angles), solved=False, status=NO_CANDIDATE, own=own)

    def _overlay(self, ego: EgoState) -> dict[str, FloatArray]:
        """Return what a replay may draw: reaction space, conflict, chosen path and others of the front."""
        space = ReactionSpace(ego.speed, ego.body.width, self._settings.friction).outline(8)
        drawn = {"reaction_space": space + np.array([ego.body.front, ego.across])}
        if self._conflict is not None:
            drawn["conflict"] = np.array([[self._conflict.along, self._conflict.across]])
        if self._course is not None:
            drawn["path"] = self._course.points(np.linspace(0.0, 40.0, 21))
        if self._found is not None:
            others = self._found.verdict.motions
            for i in range(min(len(others.along), DRAWN)):
                points = np.column_stack((others.along[i, ::5], others.across[i, ::5]))
                drawn[f"candidate_{i}"] = points
        return drawn


RULES = Rules()
WEIGHTS = RULES.weights
BUDGET = Budget()


class Settings(ControllerSettings):
    """The parameters of the controller."""

    entropy: EntropyMode = EntropyMode.SHANNON
    """Cost of the probability of meetings: Shannon's entropy, the paper's sum of logarithms, or the risk
    −ln(1 − P) of a collision."""
    entropy_at: EntropyAt = RULES.entropy_at
    """Instant of a candidate at which the entropy counts: the paper's, when the car is level with the first
    pedestrian in conflict, or the one with the largest entropy."""
    speed_risk: SpeedRisk = SpeedRisk.METRES_PER_SECOND
    """How the paper's safety coefficient of the final speed is read."""
    curvature_weight: NotNegative = WEIGHTS.curvature
    """Weight of the path's curvature, J_c."""
    distance_weight: NotNegative = WEIGHTS.distance
    """Weight of the distance, J_d."""
    entropy_weight: NotNegative = WEIGHTS.entropy
    """Weight of the entropy, J_s."""
    progress_weight: NotNegative = 0.1
    """Weight of the share of the speed that is lost. The paper has no such weight: standing still then costs
    nothing, and a car that can stop always does."""
    within_friction: bool = RULES.within_friction
    """Whether candidates stay within friction · g, braking and turning combined, and within the steering
    rate."""
    friction: Annotated[float, Field(gt=0.0, le=2.0)] = 0.8
    """Full braking is friction · g, or what the drive can do if that is less."""
    margin_m: NotNegative = 0.7
    """Distance kept to pedestrians' discs."""
    horizon_s: Annotated[float, Field(ge=1.0, allow_inf_nan=False)] = RULES.horizon
    """How far ahead conflicts and candidates are considered."""
    activation: Activation = Activation.REACTION_SPACE
    """Pedestrians for whom the method acts: everybody who will be on the road in the reaction space, where
    the paper's entropy is above 0, or only those on a collision course."""
    replan_s: NotNegative = 1.0
    """Interval at which a new candidate is chosen while a pedestrian is in the way."""
    population: Annotated[int, Field(ge=4)] = BUDGET.population
    """Population of the search; times the generations, it is the number of candidates considered."""
    generations: AtLeastOne = BUDGET.generations
    """Generations of the search."""
    walks: AtLeastOne = RULES.walks
    """Number of random walks of each pedestrian."""
    headway_s: NotNegative = 1.0
    """Time gap to a leader."""

    @model_validator(mode="after")
    def _something_costs(self) -> Settings:
        if not (self.curvature_weight + self.distance_weight + self.entropy_weight + self.progress_weight):
            raise ValueError("one of the weights must be more than 0")
        return self


def build(settings: Settings) -> Controller:
    """Build the controller.

    Raises
    ------
    ValueError
        If pymoo is not installed.
    """
    require_pymoo()
    rules = Rules(
        weights=CostWeights(
            settings.curvature_weight,
            settings.distance_weight,
            settings.entropy_weight,
            settings.progress_weight,
        ),
        entropy=settings.entropy,
        entropy_at=settings.entropy_at,
        risk=settings.speed_risk,
        within_friction=settings.within_friction,
        margin=settings.margin_m,
        horizon=settings.horizon_s,
        walks=settings.walks,
    )
    avoidance = AvoidanceSettings(rules, Budget(settings.population, settings.generations), settings.friction)
    style = DrivingStyle(headway=settings.headway_s)
    return DrivableAreaDriver(avoidance, settings.activation, settings.replan_s, style, settings.seed)
