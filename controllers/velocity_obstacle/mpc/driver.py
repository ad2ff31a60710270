"""One ego under model predictive control: decide on a lane, plan the speed, then the steering.

Speed and steering are two quadratic programs, solved one after the other. The pedestrians bound the
position along the lane only, so the steering program can use the speed profile already found, which is
more accurate than linearising both at once. With a collision cone, both are planned in one program.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from functools import lru_cache
from typing import Any

import numpy as np

from controllers.arrays import FloatArray
from controllers.conflicts.path_conflicts import Conflicts
from controllers.driving import wheels
from controllers.driving.lanes import place_in_lane
from controllers.driving.lanes.blocked_lanes import BlockedLanes
from controllers.driving.right_of_way import RightOfWay
from controllers.driving.standing import HOLDING_GENTLY, STANDING
from controllers.interface import (
    Body,
    Command,
    Decision,
    Lane,
    Manoeuvre,
    Perception,
    Plan,
    Solves,
)
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solve import Memory, Tally
from controllers.own_part import OwnPart
from controllers.prediction.forecast import Predictor
from controllers.safety.last_check import LastCheck
from controllers.safety.rollout import STEERED_FROM
from controllers.velocity_obstacle.cones import Cone
from controllers.velocity_obstacle.mpc.arithmetic import last_plan
from controllers.velocity_obstacle.mpc.cone_planning import SLOTS, ConePlanner
from controllers.velocity_obstacle.mpc.cone_program import ConeProgram
from controllers.velocity_obstacle.mpc.cone_rows import ConeSettings, Outline
from controllers.velocity_obstacle.mpc.lane_by_cost import ChangeSettings, LaneByCost
from controllers.velocity_obstacle.mpc.lane_manoeuvre import LaneManoeuvre
from controllers.velocity_obstacle.mpc.lateral import (
    LateralProgram,
    SteeringPlan,
    SteeringTask,
    SteeringWeights,
)
from controllers.velocity_obstacle.mpc.longitudinal import (
    LongitudinalProgram,
    SpeedLimits,
    SpeedPlan,
    SpeedWeights,
)
from controllers.velocity_obstacle.mpc.passing_classes import class_name
from controllers.velocity_obstacle.mpc.passing_settings import PassingSettings
from controllers.velocity_obstacle.mpc.plan_memory import PlanMemory, sampled_command
from controllers.velocity_obstacle.mpc.speed_planning import Chosen, SpeedPlanner, with_margins
from controllers.velocity_obstacle.mpc.speed_tasks import front_across
from controllers.velocity_obstacle.mpc.unsolved_programs import FRESH, fallback

SLACK, SLACK_FROM = "slack", 0.05
"""Status of a plan that goes farther than pedestrians allow, and the excess from which it is given [m]."""
NOWHERE = 0.3
"""A standing ego stays where it is if its plan leads less far than this [m]."""
NOT_YET, SOON = 0.05, 1.2
"""It also does so while it lets people pass, if its plan leads less far than the first within the second; a
plan that starts with the brake on leads four times as far [m, s]."""
BODY_OUT_OF_LANE = 0.75
"""Share of a lane's width after which the front is clear of vehicles in the middle of the old lane."""


class Shape(StrEnum):
    """Shape that a collision cone encloses."""

    RECTANGLE = "rectangle"
    DISC = "disc"


@dataclass(frozen=True, slots=True)
class ConeParameters:
    """Parameters of the collision cone that keeps the ego away from pedestrians."""

    kind: Cone
    shape: Shape
    disc_radius: float
    truncation: float


@dataclass(frozen=True, slots=True)
class Settings:
    """Parameters of the controller, as ``controllers.strategies.vo_mpc.build`` documents them."""

    dt: FloatArray
    passing: PassingSettings
    cone: ConeParameters
    change: ChangeSettings
    change_duration: float
    weights: SpeedWeights
    limits: SpeedLimits
    steering: SteeringWeights
    solver: SolverSettings


class VelocityObstacleMpc:
    """Drives one ego; see the module's docstring.

    Parameters
    ----------
    settings : parameters of the controller
    predictor : predicts where pedestrians will be; ``None``: they are expected to keep their velocities
    """

    def __init__(self, settings: Settings, predictor: Predictor | None = None) -> None:
        self.settings = settings
        self._predictor = predictor
        self._times = np.cumsum(settings.dt)
        self._memory = PlanMemory(self._times)
        self._lanes = LaneManoeuvre(settings.change_duration)
        self._decision = LaneByCost(settings.change, self._lanes)
        self._blocked = BlockedLanes()
        self._last_check = LastCheck()
        self._view: tuple[Perception, Perception] | None = None
        self._kept: Chosen | None = None
        self._speed: SpeedPlanner | None = None
        self._steering: LateralProgram | None = None
        self._tally = Tally()
        self._steering_memory, self._joint_memory = Memory(self._tally), Memory(self._tally)

    def decide(self, perception: Perception) -> Decision:
        """Apply the decision rules to the neighbour gaps; see ``lane_by_cost``."""
        perception = self._seen(perception)
        planner = self._planner(perception)
        self._kept = None
        if self.settings.change.for_pedestrians:
            planner.settled_from = self._lanes.settled_from(perception)

        def cost(lane: Lane) -> float:
            chosen = planner.cheapest(perception, lane, leaving_for=0.0)
            if lane.number == perception.road.reference:
                self._kept = chosen
            return chosen.plan.cost

        decision = self._decision.decide(perception, cost)
        return decision if decision.because else replace(decision, because=planner.nearest_stop())

    def begin_change(self, perception: Perception, side: int) -> bool:
        """Begin a lane change requested from outside: 1 left, -1 right; return whether it begins.

        It begins if there is such a lane and no change is under way. ``decide``, called next, continues the
        change and gives it up if a vehicle is in the way, as with a change of its own.
        """
        self._lanes.settle(perception)
        lane = perception.road.lane(perception.road.reference + side)
        if lane is None or self._lanes.running:
            return False
        self._lanes.begin(perception, lane.number)
        return True

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Solve the speed program for each passing class, take the cheapest, then solve the steering.

        A last check tests the result with the true body before it is carried out.
        """
        plan, chosen = self._plan(perception, decision)
        seen = self._seen(perception)
        planner = self._planner(seen)
        checked = self._last_check.checked(
            seen, plan, planner.may_enter, planner.forecast, chosen.reach, planner.comes
        )
        return replace(checked, own=_own(plan, checked, chosen))

    def _plan(self, perception: Perception, decision: Decision) -> tuple[Plan, Chosen]:
        """Return the plan before the last check, and the speed plan that it is based on."""
        perception = self._seen(perception)
        planner = self._planner(perception)
        lane = self._lanes.lane(perception)
        if self.settings.change.for_pedestrians:
            planner.settled_from = self._lanes.settled_from(perception)
        if self._kept is not None and decision.manoeuvre is Manoeuvre.KEEP:
            chosen = self._kept  # the decision has already planned for keeping the lane
        else:
            chosen = planner.cheapest(perception, lane, self._leaving(perception, lane))
        steering = chosen.steering
        if steering is None and chosen.plan.found:
            steering = self._steering_program(perception).solve(
                self._steering_task(perception, chosen.plan, lane), memory=self._steering_memory
            )
        if steering is None or not steering.found:
            limits = planner.program.limits
            answer = fallback(self._memory, perception.ego, chosen.conflicts, limits)
            return replace(answer, solves=self._solves()), chosen
        planner.commit(perception, chosen)
        command = self._command(perception, chosen, steering)
        ego, plan = perception.ego, chosen.plan
        self._memory.keep(ego.time, command, plan.position, plan.speed, steering.across - ego.across)
        answer = Plan(
            command,
            status=SLACK if chosen.too_far > SLACK_FROM else "ok",
            passing=class_name(chosen.conflicts, chosen.behind),
            slack=chosen.plan.slack,
            times=self._times,
            along=chosen.plan.position,
            across=steering.across,
            speed=chosen.plan.speed,
            overlay=_overlay(chosen.conflicts, float(self._times[-1])),
            solves=self._solves(),
        )
        return answer, chosen

    def _solves(self) -> Solves:
        """Return the solves since the last call."""
        return Solves(self.settings.solver.name, *self._tally.take())

    def _seen(self, perception: Perception) -> Perception:
        """Return the perception that plans are based on; worked out once per plan.

        Blocked lanes are represented as ending, and the centre line of the ego's lane keeps away from people
        beside it.
        """
        if self._view is None or self._view[0] is not perception:
            seen = self._blocked.look(with_margins(perception, self.settings.passing.uncertainty_gain))
            planner = self._planner(seen)
            planner.look(seen, self._waiting_place(seen))
            if not self._lanes.running:
                seen = place_in_lane.look(seen, ~planner.may_enter)
            self._view = (perception, seen)
        return self._view[1]

    def _waiting_place(self, perception: Perception) -> float:
        """Return where to wait for a change that the route requires; a blocked lane ends early already."""
        here = perception.road.lane(perception.road.reference)
        if here is None or self._blocked.ends(here):
            return np.inf
        return self._decision.waiting_place(perception)

    def _leaving(self, perception: Perception, lane: Lane | None) -> float:
        """Return how long vehicles ahead in the present lane still matter on the way into another [s]."""
        if lane is None or not self._lanes.running:
            return 0.0
        towards = float(np.sign(lane.offset - perception.ego.across)) or 1.0
        moved = lane.width - towards * (lane.offset - front_across(perception))
        still = BODY_OUT_OF_LANE * lane.width - moved
        return max(self._memory.shifted_by(towards * still), 0.5) if still > 0.0 else 0.5

    def _steering_task(self, perception: Perception, speed: SpeedPlan, lane: Lane | None) -> SteeringTask:
        """Return the task of steering into a lane; one that is not the target counts as reached already."""
        ego, road, target = perception.ego, perception.road, self._lanes.lane(perception)
        there = lane is not None and (target is None or lane.number != target.number)
        mean, curvature = last_plan.in_intervals(
            speed.position, ego.speed, speed.speed, road.curvature, road.curvature_step
        )
        half = 0.5 * ego.body.width
        lanes = [one for one in (road.lane(road.reference), target, lane) if one is not None]
        right = min((lane.offset - 0.5 * lane.width for lane in lanes), default=-2.0) + half
        left = max((lane.offset + 0.5 * lane.width for lane in lanes), default=2.0) - half
        if right > left:  # a body wider than its lane
            right = left = 0.5 * (right + left)
        n = len(self._times)
        corridor = np.full(n, right), np.full(n, left)
        here = road.lane(road.reference)
        if here is not None and not self._lanes.running:
            corridor = place_in_lane.kept(corridor, here.offset, ego, speed.position)
        task = SteeringTask(
            across=ego.across,
            heading_error=ego.heading_error,
            steering=ego.steering,
            command=self._memory.commanded(ego)[1],
            speed=np.maximum(mean, STEERED_FROM),
            curvature=curvature,
            target=self._lanes.offsets(perception, self._times),
            right=corridor[0],
            left=corridor[1],
        )
        if lane is None or not there:
            return task
        return task._replace(across=lane.offset, heading_error=0.0, target=np.full(n, lane.offset))

    def _command(self, perception: Perception, chosen: Chosen, steering: SteeringPlan) -> Command:
        ego, speed = perception.ego, chosen.plan
        command = sampled_command(
            self._times,
            self._memory.commanded(ego),
            speed.command,
            steering.command,
            ego.plan_interval + FRESH,
        )
        if ego.speed < STANDING and self._stays(chosen):
            # Rounding would let it creep, and pedestrians wait for a vehicle that moves at all.
            return replace(command, acceleration=np.full(len(command.times), HOLDING_GENTLY))
        slower = wheels.held_back(ego, self._times, steering.command, command.acceleration)
        command = replace(command, acceleration=slower)
        planner = self._planner(perception)
        firm_line = planner.right_of_way.firm_line
        if firm_line < np.inf and float(speed.position.max()) + ego.body.front > firm_line:
            # The smooth plan ends beyond a red light's line, or in the way of a vehicle. An ego that stands
            # beyond the line counts as in the junction for everybody else: it brakes as hard as it can for
            # as long as that is so.
            hardest = -planner.program.limits.emergency_braking
            return replace(command, acceleration=np.full(len(command.times), hardest))
        return command

    def _stays(self, chosen: Chosen) -> bool:
        """Return whether a standing ego is to hold its brake for now."""
        position = chosen.plan.position
        waits = chosen.behind > 0 and float(np.interp(SOON, self._times, position)) < NOT_YET
        return waits or float(position.max()) < NOWHERE

    def _planner(self, perception: Perception) -> SpeedPlanner:
        """Return the speed planner, built once the vehicle is known."""
        if self._speed is None:
            s, drive = self.settings, perception.ego.drive
            limits = replace(
                s.limits,
                acceleration=min(s.limits.acceleration, drive.max_acceleration),
                emergency_braking=min(s.limits.emergency_braking, drive.max_deceleration),
                comfortable_braking=min(s.limits.comfortable_braking, 0.9 * drive.max_deceleration),
            )
            program = _speed_program(tuple(s.dt), drive.drive_lag, s.weights, limits, s.solver)
            right_of_way = RightOfWay(limits.acceleration)
            if s.cone.kind is Cone.STEP:
                self._speed = SpeedPlanner(
                    s.passing, program, self._memory, right_of_way, self._predictor, Memory(self._tally)
                )
            else:
                steering, cone = self._steering_program(perception), self._cone(perception.ego.body)
                self._speed = ConePlanner(
                    s.passing,
                    program,
                    self._memory,
                    right_of_way,
                    self._predictor,
                    Memory(self._tally),
                    steering=steering,
                    steering_of=self._steering_task,
                    steering_memory=self._steering_memory,
                    joint_memory=self._joint_memory,
                    joint=ConeProgram(program, steering, cone, SLOTS),
                )
        return self._speed

    def _cone(self, body: Body) -> ConeSettings:
        cone, margins = self.settings.cone, self.settings.passing
        length, width, radius = 0.0, 0.0, None
        if cone.shape is Shape.RECTANGLE:
            length = 0.5 * body.length + margins.margin_along
            width = 0.5 * body.width + margins.margin_across
        else:
            radius = cone.disc_radius
        outline = Outline(length, width, body.front - 0.5 * body.length, radius)
        return ConeSettings(cone.kind, outline, cone.truncation)

    def _steering_program(self, perception: Perception) -> LateralProgram:
        if self._steering is None:
            s, drive, body = self.settings, perception.ego.drive, perception.ego.body
            self._steering = _steering_program(
                tuple(s.dt),
                drive.steering_lag,
                body.wheelbase,
                body.front,
                drive.max_steering,
                drive.max_steering_rate,
                s.steering,
                s.solver,
            )
        return self._steering


# Egos of the same kind share their programs, across runs too: all that varies in them is rewritten per solve.
@lru_cache(maxsize=32)
def _speed_program(dt: tuple[float, ...], *arguments: Any) -> LongitudinalProgram:
    return LongitudinalProgram(np.array(dt), *arguments)


@lru_cache(maxsize=32)
def _steering_program(dt: tuple[float, ...], *arguments: Any) -> LateralProgram:
    return LateralProgram(np.array(dt), *arguments)


def _own(plan: Plan, checked: Plan, chosen: Chosen) -> OwnPart:
    """Return what the programs themselves do about pedestrians, without a fallback or the last check."""
    applies, own = len(chosen.conflicts) > 0, plan.solved and checked.status == plan.status
    return OwnPart(applies, applies and own, not own or chosen.bound, not own)


def _overlay(conflicts: Conflicts, horizon: float) -> dict[str, FloatArray]:
    """Return what a replay may draw: where the people in conflict are, and when they are in the way."""
    return {
        "conflict_along": conflicts.along,
        "conflict_across": conflicts.across,
        "conflict_enter_s": conflicts.enter,
        "conflict_leave_s": np.minimum(conflicts.leave, horizon),
    }
