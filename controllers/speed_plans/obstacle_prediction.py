"""Expected behaviour of obstacles during a speed plan: braking leaders and leaving pedestrians."""

from __future__ import annotations

import math
from dataclasses import replace

from controllers.speed_plans.jerk_limit import Planner
from controllers.speed_plans.speed_profile import Segment, SpeedProfile
from controllers.speed_plans.trapezoid_profile import PlannedSpeed, PlanningLimits, Situation, free_profile

SPEEDING_UP_FOR = 1.0
"""How long an obstacle that speeds up is expected to go on speeding up [s]."""
BRAKING_FOR = 2.0
"""How long an obstacle that brakes is expected to go on braking [s]."""
SHORTER_BY = 1.0
"""Step by which the place to arrive at is moved back until the ego could still stop [m]."""
SHORTEST = 12
"""Largest number of such steps."""
CREEPING = 1.0
"""The ego stops rather than arrive more slowly than this [m/s]."""
BODY_MARGIN = 0.25
"""Least distance that a stop before a pedestrian who stays would leave [m]."""


def expected_obstacle(situation: Situation, acceleration: float) -> Situation:
    """Return the situation with an obstacle of constant speed that stands for the real one.

    Its speed is V_tar + a τ, and its gap is S − a τ² / 2: this is the line that the obstacle drives on after
    a time τ of constant acceleration a.

    Parameters
    ----------
    situation : present situation
    acceleration : acceleration a of the obstacle [m/s^2]

    >>> expected_obstacle(Situation(30.0, 10.0, 10.0), -2.0)
    Situation(gap=34.0, speed=10.0, obstacle_speed=6.0)
    """
    if acceleration >= 0.0:
        time = SPEEDING_UP_FOR
    else:
        time = min(BRAKING_FOR, situation.obstacle_speed / -acceleration)
    return replace(
        situation,
        gap=situation.gap - 0.5 * acceleration * time**2,
        obstacle_speed=situation.obstacle_speed + acceleration * time,
    )


def plan_for_braking(
    planner: Planner, situation: Situation, limits: PlanningLimits, acceleration: float
) -> PlannedSpeed:
    """Return the plan for an obstacle whose acceleration is expected to go on for a while.

    Parameters
    ----------
    planner : makes plans for a constant obstacle speed
    situation, limits : what to plan for
    acceleration : acceleration of the obstacle [m/s^2]
    """
    expected = expected_obstacle(situation, acceleration)
    plan = planner(expected, limits)
    if acceleration >= 0.0:
        return plan
    # While it brakes, the obstacle is nearer than the line that it will drive on.
    time = min(BRAKING_FOR, situation.obstacle_speed / -acceleration)
    for step in range(1, 11):
        moment = 0.1 * step * time
        moved = plan.profile.at(moment)[0]
        gap = situation.gap + (situation.obstacle_speed + 0.5 * acceleration * moment) * moment - moved
        if gap < 0.5 * limits.standoff:
            return planner(situation, limits)
    return plan


def plan_until_gone(
    planner: Planner, situation: Situation, limits: PlanningLimits, gone: float, body_gap: float
) -> PlannedSpeed:
    """Return the plan that arrives where the obstacle stands when it has gone, and not earlier.

    With the distance D to the place, the ego brakes with a_d for the time t_b and then keeps its speed:
    t_b = t_g − √(t_g² − 2 (V_i t_g − D) / a_d).

    Parameters
    ----------
    planner : plans the stop if arriving later is not possible
    situation, limits : what to plan for; the standoff is kept until the obstacle has gone
    gone : t_g, time until the obstacle has gone [s]
    body_gap : gap to the pedestrian; should they stay, the emergency deceleration is enough to stop [m]
    """
    speed, braking = situation.speed, limits.deceleration
    free = free_profile(speed, limits)
    room = situation.gap - limits.standoff
    if free.at(gone)[0] <= room and _can_still_stop(free, gone, body_gap, limits):
        return PlannedSpeed(free, "gone")
    for step in range(SHORTEST + 1):
        place = room - step * SHORTER_BY
        root = gone**2 - 2.0 * (speed * gone - place) / braking
        if root < 0.0 or place < 0.0:
            break
        brake = max(gone - math.sqrt(root), 0.0)
        slow = speed - braking * brake
        if slow < CREEPING:
            break
        pieces = [Segment(brake, -braking), Segment(gone - brake, 0.0)]
        rise = max(limits.top_speed - slow, 0.0) / limits.acceleration
        profile = SpeedProfile(speed, (*pieces, Segment(rise, limits.acceleration)))
        if _can_still_stop(profile, gone, body_gap, limits):
            return PlannedSpeed(profile, "gone")
    return planner(situation, limits)


def _can_still_stop(profile: SpeedProfile, gone: float, body_gap: float, limits: PlanningLimits) -> bool:
    """Return whether, at any time up to ``gone``, an emergency stop is possible if the pedestrian stays."""
    for step in range(11):
        moved, speed, _ = profile.at(0.1 * step * gone)
        needed = speed * limits.actuator_delay + speed**2 / (2.0 * limits.emergency_deceleration)
        if moved + needed > body_gap - BODY_MARGIN:
            return False
    return True
