"""A speed plan with limited jerk: it ends at the same gap and speed and comes no nearer in between.

A plan without a jerk limit is made for a state from which its acceleration can be averaged over a window.
The mean begins at the present speed and acceleration and ends at the same gap and speed as any plan. Its gap
to the obstacle is a mean of the first plan's gaps, so it also keeps clear of what the first plan keeps clear
of.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

from controllers.speed_plans.speed_profile import SpeedProfile, anticipated, smoothed
from controllers.speed_plans.trapezoid_profile import PlannedSpeed, PlanningLimits, Situation

Planner = Callable[[Situation, PlanningLimits], PlannedSpeed]
"""Function that makes a speed plan for one obstacle."""

TRIES = 30
"""How many times the window is adapted to the plan that it leads to."""
SHARES = (1.0, 0.5, 0.25)
"""Shares of the window that are tried if it leads too near; the last resort is the plan without a limit."""
SHORTEST_WINDOW = 0.01
"""A window shorter than this smooths nothing [s]."""
ROUNDING = 1e-6
"""Tolerance for rounding, as a share of the limit and as a distance [m]."""


def plan_with_jerk_limit(
    planner: Planner, situation: Situation, limits: PlanningLimits, jerk: float, before: float
) -> PlannedSpeed:
    """Return the plan with limited jerk, as far as safety and a positive speed allow.

    With a window T, the plan is made for the speed V_i + a₀ T / 2 and the gap
    S − (V_i T / 2 + a₀ T² / 12) + V_tar T / 2. T is the largest step of the plan's acceleration divided by
    the jerk limit, and longer where two steps fall into one window.

    Parameters
    ----------
    planner : makes plans without a jerk limit
    situation, limits : what to plan for
    jerk : jerk limit [m/s^3]; inf leaves the plan as it is
    before : a₀, the present acceleration, from which the plan continues [m/s^2]

    Notes
    -----
    [Duan]_ leaves this for future work. The limit gives way where the plan would be unsafe, and in the last
    metres of a stop: from a₀ < 0 at V_i, no jerk below a₀² / (2 V_i) avoids driving backwards. Where the
    limit holds, the letter ``j`` follows the plan's case.
    """
    plain = planner(situation, limits)
    if jerk == float("inf"):
        return plain
    longest = 2.0 * situation.speed / -before if before < 0.0 else float("inf")
    least = min(0.5 * limits.standoff, _least_gap(plain, situation))
    window = _largest_jump(plain.profile, before) / jerk
    for _ in range(TRIES):
        if window > longest:
            break
        plan = _planned(planner, situation, limits, window, before)
        excess = max((abs(one.jerk) for one in plan.profile.segments), default=0.0) / jerk
        if excess <= 1.0 + ROUNDING and _least_gap(plan, situation) >= least - ROUNDING:
            return replace(plan, case=plan.case + "j")
        if excess <= 1.0 + ROUNDING:
            break
        window *= excess
    for share in SHARES:
        shorter = share * min(window, longest)
        if shorter < SHORTEST_WINDOW:
            break
        plan = _planned(planner, situation, limits, shorter, before)
        if _least_gap(plan, situation) >= least - ROUNDING:
            return plan
    return plain


def _least_gap(plan: PlannedSpeed, situation: Situation) -> float:
    return plan.profile.least_gap(situation.gap, situation.obstacle_speed)


def _planned(
    planner: Planner, situation: Situation, limits: PlanningLimits, window: float, before: float
) -> PlannedSpeed:
    """Return the plan that is smoothed over a window."""
    speed, ahead = anticipated(situation.speed, window, before)
    gap = situation.gap - ahead + 0.5 * situation.obstacle_speed * window
    plan = planner(replace(situation, gap=gap, speed=max(speed, 0.0)), limits)
    return replace(plan, profile=smoothed(plan.profile, window, before))


def _largest_jump(profile: SpeedProfile, before: float) -> float:
    """Return the largest step of the acceleration, including those at both ends [m/s^2]."""
    values = [before, *(one.acceleration for one in profile.segments if one.duration > 0.0), 0.0]
    return max(abs(after - earlier) for earlier, after in itertools.pairwise(values))
