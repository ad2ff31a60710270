"""One ego that drives as traffic requires, and by an avoidance plan while in conflict with pedestrians.

Plans consist of a few long steps. In between, the ego follows the planned speed profile and, in a lane
change, the planned path. A new plan is made when the time of the last one is up, or earlier when another
pedestrian comes into conflict or the ego has strayed from the plan. The traffic driver handles signals, right
of way, bends, leaders, lane keeping and lane changes for traffic or route; the ego never exceeds what it
allows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from controllers.arrays import FloatArray
from controllers.conflicts.path_conflicts import Conflicts
from controllers.driving import lane_keeping
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.following import Following
from controllers.driving.lanes.lane_path import LanePath, Odometer, through
from controllers.driving.traffic_driver import TrafficDriver
from controllers.interface import Command, Decision, Lane, Manoeuvre, Perception, Plan, Solves
from controllers.own_part import OwnPart, differ
from controllers.prediction.forecast import Predictor
from controllers.safety.emergency_braking import EmergencyBraking
from controllers.velocity_obstacle.decision_rules import Reading, Rule
from controllers.velocity_obstacle.paper.euler_bicycle import ACROSS, ALONG, SPEED
from controllers.velocity_obstacle.paper.kept_option import Kept, Option, tracked
from controllers.velocity_obstacle.paper.lane_rules import Change, LaneRules
from controllers.velocity_obstacle.paper.passing_classes import Optimiser, not_avoided, passed_behind
from controllers.velocity_obstacle.paper.problem import AvoidanceProblem
from controllers.velocity_obstacle.paper.scene import SceneReader, SceneSettings
from controllers.velocity_obstacle.paper.unsolved_problem import fallback

STRAYED = 1.0
"""An ego whose speed differs from the plan by more than this needs a new plan [m/s]."""


@dataclass(frozen=True, slots=True)
class DriverSettings:
    """How the driver drives.

    Parameters
    ----------
    scene
        Settings of its problems.
    replan
        A plan is followed for this long [s].
    change_steps
        Steps that a lane change takes; ``None``: lanes are changed for traffic and route only.
    """

    scene: SceneSettings
    replan: float
    change_steps: int | None
    reading: Reading = Reading.ADAPTED
    """How the conditions of the decision rules are read."""


class AvoidanceDriver:
    """Drives one ego.

    Parameters
    ----------
    settings
        Settings of the driver.
    optimiser
        Solves the problems.
    predictor
        Predicts where pedestrians will be; ``None``: they keep their velocities.
    brake
        Emergency brake that has the last word on the acceleration; ``None`` for none.
    """

    def __init__(
        self,
        settings: DriverSettings,
        optimiser: Optimiser,
        predictor: Predictor | None = None,
        brake: EmergencyBraking | None = None,
    ) -> None:
        scene = settings.scene
        style = DrivingStyle(headway=scene.headway, standstill_gap=scene.standstill_gap)
        self.settings = settings
        self._optimiser = optimiser
        self._traffic = TrafficDriver(style)
        self._reader = SceneReader(scene, Following(style), predictor)
        self._rules = LaneRules(scene, settings.change_steps, settings.reading)
        self._brake = brake
        self._odometer = Odometer()
        self._kept: Kept | None = None
        self._change: Change | None = None
        self._rule = Rule.STRAIGHT

    def decide(self, perception: Perception) -> Decision:
        """Choose the lane by the decision rules while a pedestrian is in conflict, otherwise for traffic."""
        self._odometer.look(perception.ego)
        threat = self._brake.watch(perception) if self._brake is not None else ""
        decision = self._traffic.decide(perception, threat)
        if self._change is not None and self._change.over(perception, decision):
            self._change = self._kept = None
        lane = perception.road.lane(decision.target_lane)
        conflicts = self._reader.conflicts(perception, lane) if lane is not None else None
        if lane is None or conflicts is None or not len(conflicts):
            self._kept, self._rule = None, Rule.STRAIGHT
            return decision
        if self._due(perception, lane, conflicts):
            decision = self._plan_anew(perception, decision, lane, conflicts)
        return replace(decision, rule=self._rule, because=decision.because or conflicts.names[0])

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Follow the plan, more slowly where traffic requires it."""
        ego, kept, drive = perception.ego, self._kept, perception.ego.drive
        times = lane_keeping.instants(ego)
        if kept is None:
            acceleration = self._traffic.accelerations(perception, decision)
        else:
            acceleration = self._traffic.accelerations(perception, decision, free_speed=math.inf)
            asked = tracked(ego, kept, times) if kept.avoids else fallback(perception, kept, times)
            acceleration = np.minimum(acceleration, asked)
        wanted = acceleration
        if self._brake is not None:
            acceleration = np.minimum(acceleration, self._brake.accelerations(ego, times))
        own = self._own(perception, decision, wanted, acceleration)
        acceleration = np.clip(acceleration, -drive.max_deceleration, drive.max_acceleration)
        command = Command(times, acceleration, self._steering(perception, decision, acceleration))
        plan = Plan(command) if kept is None else self._told(perception, kept, command)
        plan = replace(plan, own=own)
        programs, unsolved = self._optimiser.tally.take()
        solver = self._optimiser.solver
        return plan if solver is None else replace(plan, solves=Solves(solver.name, programs, unsolved))

    def _own(
        self, perception: Perception, decision: Decision, wanted: FloatArray, commanded: FloatArray
    ) -> OwnPart:
        """Return what the plan itself does about pedestrians, without its fallback or the brake."""
        kept, braked = self._kept, differ(wanted, commanded)
        if kept is None:
            return OwnPart(False, False, braked, braked)
        steers = kept.path is not None and decision.target_lane == kept.path.lane
        deviates = steers or differ(commanded, self._traffic.accelerations(perception, decision))
        return OwnPart(True, kept.avoids and not braked, deviates, braked or not kept.avoids)

    def _due(self, perception: Perception, lane: Lane, conflicts: Conflicts) -> bool:
        """Return whether a new plan is needed."""
        kept, ego = self._kept, perception.ego
        if kept is None or kept.option.lane.number != lane.number:
            return True
        known = kept.option.conflicts.names
        if ego.time - kept.made >= self.settings.replan - 1e-9 or not set(conflicts.names) <= set(known):
            return True
        planned = float(kept.speed_at(np.array([ego.time]))[0])
        return kept.avoids and (abs(ego.speed - planned) > STRAYED or kept.surprised(perception))

    def _plan_anew(
        self, perception: Perception, decision: Decision, lane: Lane, conflicts: Conflicts
    ) -> Decision:
        """Plan for the lane and for adjacent lanes that the rules allow a change to; keep the best plan."""
        ego, reader = perception.ego, self._reader
        if self._change is not None:
            return self._go_on(perception, decision, self._change, lane, conflicts)
        best = self._option(lane, reader.straight(perception, lane, conflicts), conflicts, ego.time)
        other: Option | None = None
        self._rule, steps = Rule.STRAIGHT, self.settings.change_steps
        if decision.manoeuvre is Manoeuvre.KEEP and steps is not None:
            self._rule, beside = self._rules.open_lanes(perception)
            for one in beside:
                involved = reader.conflicts(perception, one)
                problem = reader.change(perception, one, involved, steps)
                option = self._option(one, problem, involved, ego.time)
                rule = self._rule if best.lane is lane else Rule.AUTONOMOUS
                if option.plan.solved and self._rules.better(best.plan, option.plan, rule):
                    best, other = option, best
                elif other is None:
                    other = option
        self._keep(perception, best, other)
        if best.lane is lane or steps is None:
            return decision
        self._change = Change(best.lane.number, ego.time, steps)
        self._traffic.change_to(perception, best.lane.number, conflicts.names[0])
        left = best.lane.number > perception.road.reference
        manoeuvre = Manoeuvre.CHANGE_LEFT if left else Manoeuvre.CHANGE_RIGHT
        return Decision(manoeuvre, best.lane.number, because=conflicts.names[0])

    def _go_on(
        self,
        perception: Perception,
        decision: Decision,
        change: Change,
        lane: Lane,
        conflicts: Conflicts,
    ) -> Decision:
        """Plan the rest of a change, or go back if the old lane is still there and its plan is better."""
        ego, road, kept = perception.ego, perception.road, self._kept
        turned = kept.turned_at(ego.time) if kept is not None and kept.path is not None else None
        arrival = change.arrival(ego.time, self.settings.scene)
        problem = self._reader.change(perception, lane, conflicts, arrival, turned)
        onward = self._option(lane, problem, conflicts, ego.time)
        here = road.lane(road.reference)
        if here is None or here.number == lane.number or not onward.threats:
            self._keep(perception, onward)
            return decision
        involved = self._reader.conflicts(perception, here)
        back = self._option(here, self._reader.straight(perception, here, involved), involved, ego.time)
        if back.plan.merit >= onward.plan.merit:
            self._keep(perception, onward, back)
            return decision
        self._keep(perception, back, onward)
        self._change, self._rule = None, Rule.STRAIGHT
        self._traffic.change_to(perception, here.number, conflicts.names[0])
        return Decision(Manoeuvre.ABORT_CHANGE, here.number, because=conflicts.names[0])

    def _option(self, lane: Lane, problem: AvoidanceProblem, conflicts: Conflicts, time: float) -> Option:
        """Solve a problem, starting from the last plan if that was for a problem of the same kind."""
        kept = self._kept
        start = None
        if kept is not None and kept.option.problem.steers == problem.steers and kept.avoids:
            start = kept.moved_on(time)
        plan = self._optimiser.solve(problem, start)
        # It is unknown whom a plan avoids that no solver vouches for: it counts as avoiding nobody.
        met = not_avoided(problem, plan.states) if plan.solved else np.ones(len(conflicts), dtype=bool)
        return Option(lane, problem, conflicts, plan, tuple(conflicts.names[i] for i in np.flatnonzero(met)))

    def _keep(self, perception: Perception, option: Option, other: Option | None = None) -> None:
        """Follow an option from now on."""
        path, travelled = None, self._odometer.travelled
        if option.problem.steers and option.plan.solved:
            along, across, heading, *_ = option.plan.states
            slopes = np.tan(np.clip(heading, -1.0, 1.0))
            shape = through(along, across - option.lane.offset, float(slopes[0]), float(slopes[-1]))
            path = LanePath(option.lane.number, travelled, shape) if shape is not None else None
        self._kept = Kept(option, perception.ego.time, travelled, path, other)

    def _steering(self, perception: Perception, decision: Decision, acceleration: FloatArray) -> FloatArray:
        """Return the front-wheel angles along the planned path or, without one, along the lane [rad]."""
        kept = self._kept
        if kept is not None and kept.path is not None and decision.target_lane == kept.path.lane:
            course = kept.path.seen(perception, self._odometer.travelled)
            if course is not None:
                return lane_keeping.steering(perception, course, acceleration)
        return self._traffic.steering(perception, decision, acceleration)

    def _told(self, perception: Perception, kept: Kept, command: Command) -> Plan:
        """Return the plan relative to where the ego is now."""
        option, ego = kept.option, perception.ego
        states, conflicts = option.plan.states, option.conflicts
        times = kept.made - ego.time + kept.step * np.arange(float(states.shape[1]))
        ahead = times > 1e-9
        moved = kept.travelled - self._odometer.travelled
        lane = perception.road.lane(option.lane.number)
        shifted = (lane.offset if lane is not None else option.lane.offset) - option.lane.offset
        behind = passed_behind(option.problem, states)
        names = np.array(conflicts.names, dtype=object)
        overlay = {
            "conflict_along": conflicts.along + moved,
            "conflict_across": conflicts.across + shifted,
            "conflict_enter_s": conflicts.enter,
            "conflict_leave_s": np.minimum(conflicts.leave, self.settings.scene.horizon),
        }
        if kept.other is not None:
            path = kept.other.plan.states[[ALONG, ACROSS]]
            overlay["other_option"] = (path + np.array([[moved], [shifted]])).T
        return Plan(
            command,
            solved=kept.avoids,
            status="ok" if kept.avoids else "fallback_stop",
            passing=f"behind={'|'.join(names[behind])} ahead={'|'.join(names[~behind])}",
            slack=option.plan.into_cones,
            times=times[ahead],
            along=states[ALONG, ahead] + moved,
            across=states[ACROSS, ahead] + shifted,
            speed=states[SPEED, ahead],
            overlay=overlay,
        )
