"""One ego whose speed follows plans for what is ahead; another driver handles road rules and steering.

Every obstacle has a plan of its own, and the ego drives the most restrictive one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from controllers.arrays import FloatArray, IntArray
from controllers.driving import lane_keeping
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.following import BEND, SPEED_LIMIT, limit_now
from controllers.driving.standing import HOLDING_GENTLY, STANDING
from controllers.driving.traffic_driver import TrafficDriver
from controllers.interface import Command, Decision, EgoState, Neighbour, NeighbourGaps, Perception, Plan
from controllers.own_part import OwnPart
from controllers.prediction.forecast import Predictor
from controllers.safety.emergency_braking import EmergencyBraking
from controllers.speed_plans.actuator_prediction import CommandHistory, PredictedState, predicted_state
from controllers.speed_plans.plan_keeping import KeptPlan, Moment, PlanKeeper, PlanSettings
from controllers.speed_plans.speed_profile import Segment, SpeedProfile
from controllers.speed_plans.speed_targets import (
    FREE,
    CrossingRule,
    PedestrianTargets,
    SpeedTarget,
    Yielding,
    leaders,
    without,
)
from controllers.speed_plans.trapezoid_profile import PlanningLimits, Situation

SPEED_GAIN, GAP_GAIN = 1.0, 0.25
"""Gains with which deviations of the speed and of the gap are corrected [1/s, 1/s^2]."""
STAYS_FOR = 0.5
"""An ego stays where it is if its plan has not begun to move within this time [s]."""
ALIKE = 0.05
"""Another plan counts as more restrictive only if its acceleration is lower by more than this [m/s^2]."""
LOOK_AHEAD = 3.0
"""Time ahead at which plans are compared [s]."""
STOPPING = -1.0
"""If the road allows less than this, and not for a bend or limit, it counts as requiring a stop [m/s^2]."""
SLOWING_FOR = 1.0
"""How long any other deceleration that the road requires is taken to last [s]."""
SHORTEST_PIECE = 1e-4
"""Times nearer to each other than this count as one [s]."""
SLOWEST_TOP_SPEED, FASTEST = 0.1, 70.0
"""Lowest and highest top speed that plans use [m/s]."""
PREVIEW = np.arange(0.25, 6.01, 0.25)
"""Times at which the plan is reported [s]."""


class PlanFrom(StrEnum):
    """State in which a plan begins."""

    PREDICTED = "predicted"
    """The state when all commands under way have taken effect; deviations from the plan are corrected."""
    COMMANDED = "commanded"
    """The commanded speed at the present gap; the plan's accelerations are commanded unchanged. A plan that
    begins while the ego closes in ends too near, by the actuators' delay times the closing speed."""
    MEASURED = "measured"
    """The present speed and gap; otherwise as ``COMMANDED``."""


@dataclass(frozen=True, slots=True)
class Made:
    """What was planned for one perception."""

    perception: Perception
    kept: KeptPlan
    """The most restrictive plan."""
    moment: Moment
    times: FloatArray
    acceleration: FloatArray
    """Acceleration commanded from each of the times on [m/s^2]."""
    yielding: Yielding
    obstacles: tuple[SpeedTarget, ...]
    threat: str
    """Name of the road user that the emergency brake acts for; empty for nobody."""


@dataclass(frozen=True, slots=True)
class Asked:
    """Accelerations that plans ask for until the next planning."""

    times: FloatArray
    """Beginnings of pieces of constant acceleration [s]."""
    accelerations: Mapping[str, FloatArray]
    """Accelerations of each piece, by the keys of the targets [m/s^2]."""
    means: Mapping[str, float]
    """Mean accelerations over all pieces, by the keys of the targets [m/s^2]."""


class SpeedPlanDriver:
    """Drives one ego by speed plans.

    Parameters
    ----------
    plans : how plans are made
    limits : limits of the plans; the top speed is the driver's own, driven where the road allows it
    plan_from : state in which plans begin
    style : driving style of the traffic driver, which steers and handles signals, right of way and bends
    rule : when to go ahead of pedestrians
    predictor : predicts where pedestrians will be; ``None``: they keep their velocities
    brake : emergency brake for road users without a plan; ``None`` for no such brake
    """

    def __init__(
        self,
        plans: PlanSettings,
        limits: PlanningLimits,
        plan_from: PlanFrom,
        style: DrivingStyle,
        rule: CrossingRule,
        predictor: Predictor | None = None,
        brake: EmergencyBraking | None = None,
    ) -> None:
        self._plans = PlanKeeper(plans)
        self._limits = limits
        self._plan_from = plan_from
        self._style = style
        self._traffic = TrafficDriver(style)
        self._pedestrians = PedestrianTargets(rule, predictor)
        self._brake = brake
        self._history = CommandHistory()
        self._governing = ""
        self._made: Made | None = None

    def decide(self, perception: Perception) -> Decision:
        """Return which lane to be in, and which obstacle governs the speed."""
        decision = self._traffic.decide(perception)
        self._made = self._make(perception, decision)
        made = self._made
        return replace(decision, because=made.threat or made.kept.target.name or decision.because)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Drive the most restrictive plan, or what the road requires where that is less."""
        made = self._made
        if made is None or made.perception is not perception:
            made = self._make(perception, decision)
        steps = lane_keeping.instants(perception.ego)
        angles = self._traffic.steering(perception, decision, made.acceleration[_entry(made.times, steps)])
        command = Command(made.times, made.acceleration, angles[_entry(steps, made.times)])
        return _told(made, command, _lane_offset(perception, decision))

    def _make(self, perception: Perception, decision: Decision) -> Made:
        """Plan for everything ahead and combine the plans."""
        ego, steps = perception.ego, lane_keeping.instants(perception.ego)
        ahead, passed = leaders(perception, decision.target_lane, self._style, self._traffic.waiting)
        alone = replace(perception, gaps=_only(perception.gaps, passed))
        road = self._traffic.accelerations(alone, decision, free_speed=float("inf"))
        moment, due = self._moment(perception), self._plans.due(ego.time)
        targets = {one.key: one for one in (*ahead, FREE)}
        found = {key: self._plans.plan_for(one, moment, renew=due) for key, one in targets.items()}
        state = moment.state
        to_stop = float(road.mean()) < STOPPING and decision.because not in (BEND, SPEED_LIMIT)
        present = _present([kept for kept, _ in found.values()], moment.now, float(road.mean()), to_stop)
        yielding = self._pedestrians.find(
            perception,
            _lane_offset(perception, decision),
            lambda way: state.delay + present.time_at(way - state.ahead),
        )
        for one in yielding.targets:
            targets[one.key] = one
            found[one.key] = self._plans.plan_for(one, moment, renew=due)
        self._plans.forget_others(set(found))
        asked = self._asked(found, moment, ego)
        first = self._first(asked)
        if first != self._governing and not found[first][0].has_speed(moment.now, state.speed):
            found[first] = self._plans.plan_for(targets[first], moment, renew=True)
            asked = self._asked(found, moment, ego)
        self._governing = first
        kept = found[first][0]
        acceleration = np.minimum(
            np.min(list(asked.accelerations.values()), axis=0), road[_entry(steps, asked.times)]
        )
        if ego.speed < STANDING and (_stays(kept, moment.now) or float(road.max()) <= 0.0):
            acceleration = np.minimum(acceleration, HOLDING_GENTLY)
        threat = ""
        if self._brake is not None:
            planned_for = frozenset(one.name for one in ahead) | yielding.names
            threat = self._brake.watch(without(perception, planned_for))
            braked = self._brake.accelerations(ego, steps)
            acceleration = np.minimum(acceleration, braked[_entry(steps, asked.times)])
        acceleration = np.clip(acceleration, -ego.drive.max_deceleration, ego.drive.max_acceleration)
        self._history.add(ego.time, asked.times, acceleration)
        obstacles = tuple(one for one in targets.values() if one is not FREE)
        return Made(perception, kept, moment, asked.times, acceleration, yielding, obstacles, threat)

    def _moment(self, perception: Perception) -> Moment:
        """Return the state and the time at which plans begin."""
        ego, limits = perception.ego, self._limits_here(perception)
        predicted = predicted_state(ego, limits.actuator_delay, self._history)
        before = self._history.last(ego.time) if predicted.speed > STANDING else 0.0
        match self._plan_from:
            case PlanFrom.PREDICTED:
                dead_time = predicted.delay - ego.drive.drive_lag
                return Moment(ego.time + dead_time, predicted, limits, before, 0.0)
            case PlanFrom.COMMANDED:
                state = PredictedState(predicted.speed, 0.0, 0.0)
            case PlanFrom.MEASURED:
                state, before = PredictedState(max(ego.speed, 0.0), 0.0, 0.0), ego.acceleration
        return Moment(ego.time, state, limits, before, limits.actuator_delay)

    def _limits_here(self, perception: Perception) -> PlanningLimits:
        """Return the limits with the top speed that holds here, within what the drive can do."""
        limits, drive = self._limits, perception.ego.drive
        top = min(
            FASTEST,
            limits.top_speed,
            limit_now(perception.road, perception.ego.body.front),
            self._pedestrians.careful_speed(perception, limits.deceleration),
        )
        return replace(
            limits,
            top_speed=max(top, SLOWEST_TOP_SPEED),
            acceleration=min(limits.acceleration, drive.max_acceleration),
            deceleration=min(limits.deceleration, drive.max_deceleration),
            emergency_deceleration=min(limits.emergency_deceleration, drive.max_deceleration),
        )

    def _asked(self, found: Mapping[str, tuple[KeptPlan, Situation]], moment: Moment, ego: EgoState) -> Asked:
        """Return what each plan asks for until the next planning, with deviations from it corrected."""
        limits, steps = moment.limits, lane_keeping.instants(ego)
        end = max(ego.plan_interval, float(steps[-1]) + SHORTEST_PIECE)
        breaks = [
            at for kept, _ in found.values() for at in kept.plan.profile.breaks(moment.now - kept.since)
        ]
        times = _merged(steps, [at for at in breaks if at < end - SHORTEST_PIECE])
        accelerations = {}
        for key, (kept, situation) in found.items():
            planned = kept.plan.profile.mean_accelerations(moment.now - kept.since, times, end)
            if self._plan_from is PlanFrom.PREDICTED:
                gap, speed = kept.expected(moment.now)
                off = situation.gap - gap if np.isfinite(gap) else 0.0
                planned = planned + SPEED_GAIN * (speed - situation.speed) + GAP_GAIN * off
            accelerations[key] = np.clip(planned, -limits.emergency_deceleration, limits.acceleration)
        lengths = np.diff(np.append(times, end))
        means = {key: float(one @ lengths) / end for key, one in accelerations.items()}
        return Asked(times, accelerations, means)

    def _first(self, asked: Asked) -> str:
        """Return whose plan is the most restrictive: the present one unless another clearly is."""
        first = min(asked.means, key=lambda key: asked.means[key])
        before = asked.means.get(self._governing, np.inf)
        return first if asked.means[first] < before - ALIKE else self._governing


def _lane_offset(perception: Perception, decision: Decision) -> float:
    lane = perception.road.lane(decision.target_lane)
    return lane.offset if lane is not None else 0.0


def _only(gaps: NeighbourGaps, names: frozenset[str]) -> NeighbourGaps:
    """Return only the neighbours ahead with those names; all others have plans of their own."""

    def kept(one: Neighbour | None) -> Neighbour | None:
        return one if one is not None and one.name in names else None

    return NeighbourGaps(
        ahead=kept(gaps.ahead), left_ahead=kept(gaps.left_ahead), right_ahead=kept(gaps.right_ahead)
    )


def _present(plans: Sequence[KeptPlan], now: float, road: float, to_stop: bool) -> SpeedProfile:
    """Return how the ego would go on without pedestrians, more slowly where the road requires it."""
    rests = [kept.plan.profile.rest(now - kept.since) for kept in plans]
    slowest = min(rests, key=lambda rest: rest.at(LOOK_AHEAD)[0])
    if road >= slowest.at(0.0)[2] - ALIKE:
        return slowest
    stopping = slowest.speed / -road if road < 0.0 else np.inf
    lasts = stopping if to_stop else min(stopping, SLOWING_FOR)
    return SpeedProfile(slowest.speed, (Segment(lasts, road),))


def _stays(kept: KeptPlan, now: float) -> bool:
    return kept.plan.profile.at(now - kept.since + STAYS_FOR)[1] < STANDING


def _entry(begins: FloatArray, times: FloatArray) -> IntArray:
    """Return, for each time, the index of the piece that it falls into; ``begins`` are the pieces' starts."""
    return np.maximum(np.searchsorted(begins, times + 1e-9, side="right") - 1, 0)


def _merged(steps: FloatArray, breaks: Sequence[float]) -> FloatArray:
    """Return steps and breaks in order, without breaks that leave pieces too short to be driven."""
    times = steps.tolist()
    for at in breaks:
        if min(abs(at - time) for time in times) > SHORTEST_PIECE:
            times.append(at)
    return np.array(sorted(times))


def _told(made: Made, command: Command, offset: float) -> Plan:
    """Return the plan with what a replay may draw."""
    ego, kept, moment = made.perception.ego, made.kept, made.moment
    ahead = kept.plan.profile.sampled(moment.now - kept.since + np.append(0.0, PREVIEW))
    speed = ahead[1, 1:]
    # The ego is behind the plan by the delay, so by the delay times its speed.
    along = ahead[0, 1:] - ahead[0, 0] + moment.state.delay * (moment.state.speed - speed)
    emergency = ego.speed > STANDING and (not kept.plan.safe or made.threat != "")
    places = [(ego.body.front + one.gap, ego.across) for one in made.obstacles]
    applies = bool(made.yielding.names)
    governs = kept.target.name in made.yielding.names
    return Plan(
        command,
        own=OwnPart(applies, applies and not emergency, governs or made.threat != "", emergency),
        solved=not emergency,
        status="emergency_braking" if emergency else "ok",
        passing=made.yielding.passing,
        times=PREVIEW,
        along=np.maximum.accumulate(np.maximum(along, 0.0)),
        across=offset + (ego.across - offset) * np.exp(-PREVIEW),
        speed=speed,
        overlay={
            "obstacles": np.array(places, dtype=np.float64).reshape(-1, 2),
            "conflict_along": made.yielding.along,
            "conflict_across": made.yielding.across,
        },
    )
