"""A driver whose acceleration is limited by a filter because of pedestrians."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from controllers.driving import lane_keeping
from controllers.driving.driving_style import DrivingStyle
from controllers.driving.standing import HOLDING, STANDING
from controllers.driving.traffic_driver import TrafficDriver
from controllers.interface import Command, Controller, Decision, Perception, Plan
from controllers.own_part import OwnPart, differ
from controllers.perception import NOBODY
from controllers.safety.emergency_braking import EmergencyBraking
from controllers.yielding.facing import Answer, PathWatch, SpeedFilter


class BlindDriver:
    """Drives as road and vehicles demand, with emergency braking for vehicles; it ignores pedestrians."""

    def __init__(self, style: DrivingStyle) -> None:
        self._traffic = TrafficDriver(style)
        self._brake = EmergencyBraking()

    def decide(self, perception: Perception) -> Decision:
        """Return which lane to be in."""
        threat = self._brake.watch(replace(perception, pedestrians=NOBODY))
        return self._traffic.decide(perception, threat)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Return the plan that follows other vehicles, and keeps or changes the lane."""
        times = lane_keeping.instants(perception.ego)
        allowed = self._traffic.accelerations(perception, decision)
        acceleration = np.minimum(allowed, self._brake.accelerations(perception.ego, times))
        return Plan(Command(times, acceleration, self._traffic.steering(perception, decision, acceleration)))


class FilteredDriver:
    """Passes everything on to a driver, and lets a filter limit its accelerations.

    Parameters
    ----------
    driver : any controller; its steering is not changed
    speed_filter : says what is allowed
    watch : says who is in the way
    """

    def __init__(self, driver: Controller, speed_filter: SpeedFilter, watch: PathWatch) -> None:
        self._driver, self._filter, self._watch = driver, speed_filter, watch
        self._answer = Answer()
        self._plan: Plan | None = None

    def decide(self, perception: Perception) -> Decision:
        """Decide as the driver does; if the filter acts, its reason replaces that of the driver."""
        decision = self._driver.decide(perception)
        self._plan = self._driver.plan(perception, decision)
        wanted = float(self._plan.command.acceleration.mean())
        self._answer = self._filter.allowed(self._watch.look(perception, decision, wanted))
        acts = self._answer.because and self._answer.most < wanted
        return replace(decision, because=self._answer.because) if acts else decision

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Carry out the driver's plan, no faster than the filter allows."""
        plan, answer, ego = self._plan, self._answer, perception.ego
        assert plan is not None, "decide comes first"
        command = plan.command
        most = max(answer.most, -ego.drive.max_deceleration)
        acceleration = np.minimum(command.acceleration, most)
        if ego.speed < STANDING and most <= 0.0:
            acceleration = np.minimum(acceleration, HOLDING)
        own = OwnPart(
            answer.applies,
            answer.applies and not answer.overridden,
            differ(acceleration, command.acceleration),
            answer.overridden,
        )
        plan = replace(
            plan,
            command=Command(command.times, acceleration, command.steering),
            solved=plan.solved and answer.solved,
            status=answer.status if answer.status != "ok" else plan.status,
            passing=answer.passing or plan.passing,
            slack=max(plan.slack, answer.slack),
            solves=answer.solves or plan.solves,
            own=own,
        )
        if answer.times is None or answer.along is None or answer.speed is None:
            return plan
        across = np.full(len(answer.times), ego.across)
        return replace(plan, times=answer.times, along=answer.along, across=across, speed=answer.speed)
