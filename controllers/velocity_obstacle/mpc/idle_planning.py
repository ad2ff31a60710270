"""A driver that plans less often while nothing can change its plan.

A plan reaches seconds ahead. What it responds to may be fixed in the world: a red light's line, a bend, a
speed limit, the lane's end. The rest of the plan is then as good as a new one. Every step checks whether
that still holds: as soon as a road user may matter, a light changes, or the ego is not where its plan has it,
a new plan is made in that very step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from controllers.arrays import FloatArray
from controllers.conflicts.bystanders import FREE, swing_out
from controllers.conflicts.expected_behaviour import AT_THE_ROADSIDE, KERB
from controllers.driving.vehicles_ahead import DRIFTING
from controllers.geometry.footprints import footprints
from controllers.interface import Controller, Decision, Manoeuvre, Perception, Plan, RoadAhead, SignalState
from controllers.own_part import IDLE
from controllers.velocity_obstacle.mpc.plan_memory import rest_of

LONGEST = 0.5
"""Commands continue for this long after the next plan is due [s]."""
ROOM = 10.0
"""Distance that is checked beyond the end of the plan and a time gap, and behind the rear axle [m]."""
ASIDE = FREE + 0.2
"""The ego passes pedestrians who stay farther than this beside its body as if they were not there [m]."""
BESIDE = 0.5
"""Vehicles at least this far beside the area that the body sweeps are not in the way [m]."""
CROSSING_S, CROSSING_NEAR = 3.0, 15.0
"""Vehicles that move across the road are followed this far ahead; those that do not go the ego's way only if
the ego could come this near to them in that time [s, m]."""
BRAKING_S = 2.0
"""A braking vehicle is expected to keep braking for this long [s]."""
STANDSTILL_GAP, HEADWAY, BRAKING = 3.5, 1.2, 6.0
"""A leader does not matter while the plan keeps this gap plus the larger of this time gap and the stopping
distance at this braking; a plan that a leader bounds keeps less [m, s, m/s^2]."""
ELSEWHERE, OFF_SPEED = 0.05, 0.2
"""Largest deviations of the ego from its plan, across the road and in speed [m, m/s]."""


class Ahead(NamedTuple):
    """The rest of a plan, from now on, shape (N,) each."""

    times: FloatArray
    along: FloatArray
    speed: FloatArray

    @property
    def reach(self) -> float:
        """Distance beyond which nobody matters to the plan [m]."""
        return float(self.along[-1] + HEADWAY * self.speed[-1]) + ROOM


class _Made(NamedTuple):
    """The last plan that was made, and what it was made for."""

    time: float
    decision: Decision
    plan: Plan
    lights: tuple[tuple[str, SignalState], ...]


class ChangesOnRequest(Controller, Protocol):
    """Controller that changes lanes on request."""

    def begin_change(self, perception: Perception, side: int) -> bool:
        """Begin a change: 1 left, -1 right; return whether it begins."""
        ...


@dataclass(slots=True)
class Unhurried:
    """Controller that lets a driver plan, but not at every step while nothing can change the plan.

    Parameters
    ----------
    driver : makes the plans
    interval : time between plans while nothing can change them, at most ``LONGEST`` [s]
    by_velocity : whether pedestrians are expected to keep their velocities; otherwise all of them matter
    """

    driver: ChangesOnRequest
    interval: float
    by_velocity: bool = True
    _last: _Made | None = None

    def begin_change(self, perception: Perception, side: int) -> bool:
        """Begin a lane change requested from outside, as the driver does; its plan is made at once."""
        self._last = None
        return self.driver.begin_change(perception, side)

    def decide(self, perception: Perception) -> Decision:
        """Return the last decision while it is still valid, a new one otherwise."""
        if self._last is not None and self._may_rest(self._last, perception):
            return self._last.decision
        self._last = None
        return self.driver.decide(perception)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Return the rest of the last plan's command while it is still valid, a new plan otherwise."""
        if self._last is not None:
            command = rest_of(self._last.plan.command, perception.ego.time - self._last.time)
            return Plan(command, own=IDLE)
        plan = self.driver.plan(perception, decision)
        as_wanted = plan.solved and plan.status == "ok" and not plan.passing
        if as_wanted and decision.manoeuvre is Manoeuvre.KEEP:
            self._last = _Made(perception.ego.time, decision, plan, _lights(perception.road))
        return plan

    def _may_rest(self, last: _Made, perception: Perception) -> bool:
        # Half a step of tolerance: the times of steps are sums and not exact.
        ego, age = perception.ego, perception.ego.time - last.time
        if age >= self.interval - 0.5 * ego.plan_interval:
            return False
        plan = last.plan
        return (
            abs(float(np.interp(age, plan.times, plan.speed)) - ego.speed) < OFF_SPEED
            # In a bend, a plan matches the road for a shorter time than on a straight road.
            and abs(float(np.interp(age, plan.times, plan.across)) - ego.across) < ELSEWHERE
            and _lights(perception.road) == last.lights
            and is_settled(perception, _rest_of_plan(plan, age), self.by_velocity)
        )


def _rest_of_plan(plan: Plan, age: float) -> Ahead:
    """Return the rest of a plan, relative to the present."""
    first = float(plan.times[0])
    driven = plan.along[0] * age / first if age < first else float(np.interp(age, plan.times, plan.along))
    return Ahead(np.maximum(plan.times - age, 0.0), np.maximum(plan.along - driven, 0.0), plan.speed)


def is_settled(perception: Perception, plan: Ahead, by_velocity: bool = True) -> bool:
    """Return whether nobody can matter to a plan now and nothing on the road ahead asks for a new one.

    Parameters
    ----------
    perception : what the ego perceives
    plan : the rest of the plan
    by_velocity : whether pedestrians are expected to keep their velocities; otherwise all in view matter
    """
    ego, road, reach = perception.ego, perception.road, plan.reach
    here = road.lane(road.reference)
    if here is None or here.follows_route_for < reach or road.route_end < reach:
        return False
    if any(foe.must_yield or foe.foe_entry <= ROOM for foe in road.foes):
        return False
    if any(light.state is SignalState.AMBER and light.stop_line < reach for light in road.signals):
        return False
    if any(sign.stop_line < reach for sign in road.stop_signs):
        return False  # whether the ego has stopped there is noticed while planning
    if perception.eyesight is not None and len(perception.vehicles):
        return False  # vehicles may hide pedestrians
    half = 0.5 * ego.body.width
    way = min(ego.across, here.offset) - half, max(ego.across, here.offset) + half
    return _people_stay_aside(perception, way, plan, by_velocity) and not _in_the_way(perception, way, plan)


def _people_stay_aside(
    perception: Perception, way: tuple[float, float], plan: Ahead, by_velocity: bool
) -> bool:
    """Return whether no pedestrian comes near the ego's way, or is passed near it, during a plan.

    Parameters
    ----------
    perception
    way : right and left edge of the area that the body sweeps [m]
    plan : the rest of the plan
    by_velocity : as for :func:`is_settled`
    """
    people, road = perception.pedestrians, perception.road
    if not len(people):
        return True
    there = (people.along > -ROOM) & (people.along < plan.reach)
    if not there.any():
        return True
    if not by_velocity or (people.crossing[there] >= 0).any():
        return False
    along, across, speed = people.along[there], people.across[there], people.across_speed[there]
    walked = speed * plan.times[-1]
    outside = (across < road.right_edge - KERB) | (across > road.left_edge + KERB)
    walked[outside & (np.abs(speed) < AT_THE_ROADSIDE)] = 0.0
    to_right, to_left = swing_out(road, perception.ego.body, along)
    kept = people.radius[there] + ASIDE
    right = across + np.maximum(walked, 0.0) < way[0] - to_right - kept
    left = across + np.minimum(walked, 0.0) > way[1] + to_left + kept
    return bool((outside & (right | left)).all())


def _in_the_way(perception: Perception, way: tuple[float, float], plan: Ahead) -> bool:
    """Return whether a vehicle is, or may soon be, where it limits a plan.

    Parameters
    ----------
    perception
    way : right and left edge of the area that the body sweeps [m]
    plan : the rest of the plan
    """
    them = perception.vehicles
    if not len(them):
        return False
    ego, box, body = perception.ego, footprints(them), perception.ego.body
    to_right, to_left = swing_out(perception.road, body, 0.5 * (box.front + box.rear))
    drift = np.where(np.abs(them.across_speed) > DRIFTING, them.across_speed * CROSSING_S, 0.0)
    far = ~box.same_way & (box.rear > body.front + ego.speed * CROSSING_S + CROSSING_NEAR)
    drift[far] = 0.0  # vehicles crossing there are gone when the ego arrives, or are foes in that junction
    meets = (box.front > -body.rear_overhang) & (box.rear < plan.reach)
    meets &= box.right + np.minimum(drift, 0.0) < way[1] + to_left + BESIDE
    meets &= box.left + np.maximum(drift, 0.0) > way[0] - to_right - BESIDE
    who = np.flatnonzero(meets)
    if not len(who):
        return False
    if not box.same_way[who].all():
        return True
    speed = np.maximum(them.along_speed[who] + BRAKING_S * np.minimum(them.acceleration[who], 0.0), 0.0)
    rear = box.rear[who, None] + speed[:, None] * plan.times
    kept = STANDSTILL_GAP + np.maximum(HEADWAY * plan.speed, plan.speed**2 / (2.0 * BRAKING))
    return bool((rear - body.front < plan.along + kept).any())


def _lights(road: RoadAhead) -> tuple[tuple[str, SignalState], ...]:
    return tuple((light.name, light.state) for light in road.signals)
