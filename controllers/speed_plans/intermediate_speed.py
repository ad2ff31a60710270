"""Speed planning by an intermediate speed: reach an obstacle's speed exactly at the safe distance.

The speed V_m to which the ego would rise or fall in between decides which of six cases applies.
"""

from __future__ import annotations

import math
from dataclasses import replace

from controllers.speed_plans.speed_profile import Segment, SpeedProfile
from controllers.speed_plans.trapezoid_profile import (
    PlannedSpeed,
    PlanningLimits,
    Situation,
    free_profile,
    stands_clear,
)

EQUAL = 1e-9
"""Speeds that differ by less than this count as equal [m/s]."""


def safe_distance(obstacle_speed: float, limits: PlanningLimits) -> float:
    """Return the gap S_s = V_tar² / (2 a_d) + α V_tar + d_extra at which to follow an obstacle [m].

    Notes
    -----
    Eq. (4) of [Duan]_: it leaves room to stop if the obstacle stands still at once.

    >>> round(safe_distance(5.0, PlanningLimits(deceleration=0.5, actuator_delay=0.3, standoff=2.5)), 2)
    29.0
    """
    speed = max(obstacle_speed, 0.0)
    return speed**2 / (2.0 * limits.deceleration) + limits.actuator_delay * speed + limits.standoff


def intermediate_speed(situation: Situation, limits: PlanningLimits) -> float:
    """Return V_m, the turning point of the speed: up to it with a_a, then down with a_d, or vice versa [m/s].

    V_m = V_tar + √((2 D + u² / a_a) / c) with D = S − S_s, u = V_i − V_tar and c = 1 / a_a + 1 / a_d; where
    the radicand Q is negative, V_tar − √(−Q), which only selects the case.

    Notes
    -----
    Eqs. (5) and (6) of [Duan]_, solved again because (6) is lost in the copy at hand.
    """
    relative = situation.speed - situation.obstacle_speed
    surplus = situation.gap - safe_distance(situation.obstacle_speed, limits)
    both = 1.0 / limits.acceleration + 1.0 / limits.deceleration
    squared = (2.0 * surplus + relative**2 / limits.acceleration) / both
    return situation.obstacle_speed + math.copysign(math.sqrt(abs(squared)), squared)


def plan_intermediate(situation: Situation, limits: PlanningLimits) -> PlannedSpeed:
    """Return the speed plan that ends with the obstacle's speed at the safe distance from it.

    Parameters
    ----------
    situation : a negative obstacle speed counts as standing
    limits : limits of the plan

    Notes
    -----
    The cases are those of [Duan]_, by the number of its figure. The sixth is garbled in print and read as
    V_m < V_i ≤ V_tar. There are differences. The fifth case brakes as hard as it takes to keep half of
    d_extra; it stands and waits if the ego cannot otherwise fall behind a slow obstacle; and it replaces the
    first case where that would need more than the emergency deceleration. Above V_max (eqs. (7) and (8),
    where V_m cancels out), the ego brakes to V_max, keeps it, and brakes again. Before a standing obstacle
    nearer than d_extra, the ego stands; it does not back off.

    >>> plan = plan_intermediate(Situation(20.0, 2.0, 5.0), PlanningLimits())
    >>> plan.case, [round(one.duration, 3) for one in plan.profile.segments]
    ('3', [2.192, 1.12])
    """
    situation = Situation(situation.gap, max(situation.speed, 0.0), max(situation.obstacle_speed, 0.0))
    speed, other, top = situation.speed, situation.obstacle_speed, limits.top_speed
    if other >= top - EQUAL:
        if speed <= max(other, top):
            return PlannedSpeed(free_profile(speed, limits), "0")
        # The ego is faster than an obstacle above the top speed: take the top speed as the obstacle's speed,
        # which is the safer guess.
        situation, other = replace(situation, obstacle_speed=top), top
    surplus = situation.gap - safe_distance(other, limits)
    relative = speed - other
    stopping = relative**2 / (2.0 * limits.deceleration)
    if relative > 0.0 and surplus < stopping:
        return _brake(situation, surplus, limits)
    if speed > top:
        return _from_above(situation, surplus, limits)
    middle = intermediate_speed(situation, limits)
    if middle >= top:
        return _to_top(situation, surplus, limits)
    if relative <= 0.0 and middle < speed:
        return _fall_back(situation, surplus, limits.deceleration, limits, "6")
    if middle <= other and relative < 0.0:
        return _keep_then_rise(situation, surplus, limits)
    up, down = limits.acceleration, limits.deceleration
    middle = max(middle, speed, other)
    pieces = (Segment((middle - speed) / up, up), Segment((middle - other) / down, -down))
    return PlannedSpeed(SpeedProfile(speed, pieces), "3")


def _brake(situation: Situation, surplus: float, limits: PlanningLimits) -> PlannedSpeed:
    """Brake for an obstacle that is too near for braking with a_d: cases 1 and 5."""
    speed, other = situation.speed, situation.obstacle_speed
    relative = speed - other
    if surplus > 0.0 and relative**2 <= 2.0 * surplus * limits.emergency_deceleration:
        braking = relative**2 / (2.0 * surplus)
        return PlannedSpeed(SpeedProfile(speed, (Segment(relative / braking, -braking),)), "1")
    room = situation.gap - 0.5 * limits.standoff
    needed = relative**2 / (2.0 * room) if room > 0.0 else math.inf
    braking = min(max(needed, limits.deceleration), max(limits.emergency_deceleration, limits.deceleration))
    plan = _fall_back(situation, surplus, braking, limits, "5")
    return replace(plan, safe=stands_clear(situation, speed, limits))


def _fall_back(
    situation: Situation, surplus: float, braking: float, limits: PlanningLimits, case: str
) -> PlannedSpeed:
    """Brake below the obstacle's speed, then rise to it: cases 5 and 6."""
    speed, other, up = situation.speed, situation.obstacle_speed, limits.acceleration
    relative = speed - other
    lowest = other - math.sqrt(max(relative**2 / braking - 2.0 * surplus, 0.0) / (1.0 / up + 1.0 / braking))
    if lowest >= 0.0:
        lowest = min(lowest, speed)
        pieces = (Segment((speed - lowest) / braking, -braking), Segment((other - lowest) / up, up))
        return PlannedSpeed(SpeedProfile(speed, pieces), case)
    stop = Segment(speed / braking, -braking)
    if other <= EQUAL:
        return PlannedSpeed(SpeedProfile(speed, (stop,) if speed > 0.0 else ()), case)
    gained = (0.5 * speed - other) * speed / braking
    wait = max((gained - surplus - other**2 / (2.0 * up)) / other, 0.0)
    return PlannedSpeed(SpeedProfile(speed, (stop, Segment(wait, 0.0), Segment(other / up, up))), case)


def _from_above(situation: Situation, surplus: float, limits: PlanningLimits) -> PlannedSpeed:
    """Brake to the top speed, keep it, brake to the obstacle's speed: eqs. (7) and (8)."""
    speed, other, top, down = (
        situation.speed, situation.obstacle_speed, limits.top_speed, limits.deceleration,
    )  # fmt: skip
    slow = Segment((speed - top) / down, -down)
    if other >= top - EQUAL:
        return PlannedSpeed(SpeedProfile(speed, (slow,)), "7")
    cruise = (surplus - (speed - other) ** 2 / (2.0 * down)) / (top - other)
    pieces = (slow, Segment(cruise, 0.0), Segment((top - other) / down, -down))
    return PlannedSpeed(SpeedProfile(speed, pieces), "7")


def _to_top(situation: Situation, surplus: float, limits: PlanningLimits) -> PlannedSpeed:
    """Rise to the top speed, keep it, brake to the obstacle's speed: case 2."""
    speed, top, up, down = situation.speed, limits.top_speed, limits.acceleration, limits.deceleration
    highest, relative = top - situation.obstacle_speed, speed - situation.obstacle_speed
    used = (highest**2 - relative**2) / (2.0 * up) + highest**2 / (2.0 * down)
    pieces = (
        Segment((top - speed) / up, up),
        Segment(max(surplus - used, 0.0) / highest, 0.0),
        Segment(highest / down, -down),
    )
    return PlannedSpeed(SpeedProfile(speed, pieces), "2")


def _keep_then_rise(situation: Situation, surplus: float, limits: PlanningLimits) -> PlannedSpeed:
    """Keep the speed until rising to the obstacle's speed ends at the safe distance: case 4."""
    speed, up = situation.speed, limits.acceleration
    slower = situation.obstacle_speed - speed
    keep = max((-surplus - slower**2 / (2.0 * up)) / slower, 0.0)
    return PlannedSpeed(SpeedProfile(speed, (Segment(keep, 0.0), Segment(slower / up, up))), "4")
