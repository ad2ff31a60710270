"""Speed up, keep the highest speed, slow down and stand before an obstacle: classic trapezoidal planning.

The obstacle is taken as standing, whatever it does; that is what the intermediate speed mends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from controllers.speed_plans.speed_profile import Segment, SpeedProfile


@dataclass(frozen=True, slots=True)
class PlanningLimits:
    """What a speed plan may use; all greater than zero but the last two, which may be zero."""

    acceleration: float = 1.723
    """a_a [m/s^2]."""
    deceleration: float = 0.6944
    """a_d of a normal slowing down [m/s^2]."""
    emergency_deceleration: float = 8.0
    """The most that an emergency may use [m/s^2]."""
    top_speed: float = 11.111
    """V_max [m/s]."""
    actuator_delay: float = 0.3
    """α, from the command to its effect [s]."""
    standoff: float = 2.5
    """d_extra, the distance left to the obstacle after a stop: half a car's length in the paper [m]."""


@dataclass(frozen=True, slots=True)
class Situation:
    """The ego and one obstacle ahead of it."""

    gap: float
    """S, from the ego's front bumper to the obstacle [m]."""
    speed: float
    """V_i of the ego [m/s]."""
    obstacle_speed: float = 0.0
    """V_tar [m/s]."""


@dataclass(frozen=True, slots=True)
class PlannedSpeed:
    """A speed plan for one obstacle."""

    profile: SpeedProfile
    case: str
    """Which of the method's cases it is."""
    safe: bool = True
    """False where no braking within the limits keeps half the standoff."""


def free_profile(speed: float, limits: PlanningLimits) -> SpeedProfile:
    """Return the way to the top speed with nothing ahead."""
    change = limits.top_speed - speed
    if change == 0.0:
        return SpeedProfile(speed)
    rate = limits.acceleration if change > 0.0 else -limits.deceleration
    return SpeedProfile(speed, (Segment(change / rate, rate),))


def plan_trapezoid(situation: Situation, limits: PlanningLimits) -> PlannedSpeed:
    """Return the speed plan that stands before where the obstacle is now.

    S_a = (V_max² − V_i²) / (2 a_a), zero above V_max; S_d = V_max² / (2 a_d) + α V_i + d_extra;
    S_m = S − S_a − S_d is driven at V_max. Where S_m < 0 the highest speed is V_p with
    V_p² = (2 a_a a_d D' + a_d V_i²) / (a_a + a_d), D' = S − α V_i − d_extra, and where D' is shorter than
    V_i² / (2 a_d) the ego brakes at once with V_i² / (2 D').

    Parameters
    ----------
    situation : the obstacle's speed is not used
    limits : as planned with

    Notes
    -----
    Eqs. (1)-(3) of [Duan]_; the first two are lost in the copy at hand and reconstructed from the text.
    The distance α V_i is driven before braking begins, so with ideal actuators the plan of one instant ends
    that much short; replanned while driving it shrinks with the speed, and the ego stands at d_extra.

    >>> plan = plan_trapezoid(Situation(200.0, 0.0), PlanningLimits())
    >>> plan.case, [round(one.duration, 2) for one in plan.profile.segments]
    ('cruise', [6.45, 6.55, 16.0])
    """
    speed, top = max(situation.speed, 0.0), limits.top_speed
    up, down = limits.acceleration, limits.deceleration
    room = situation.gap - limits.actuator_delay * speed - limits.standoff
    if room < speed**2 / (2.0 * down):
        return _emergency(situation, speed, room, limits)
    if speed > top:
        slowing = (speed**2 - top**2) / (2.0 * down)
        cruise = (room - slowing - top**2 / (2.0 * down)) / top
        pieces = (Segment((speed - top) / down, -down), Segment(cruise, 0.0), Segment(top / down, -down))
        return PlannedSpeed(SpeedProfile(speed, pieces), "cruise")
    cruise = (room - (top**2 - speed**2) / (2.0 * up) - top**2 / (2.0 * down)) / top
    if cruise >= 0.0:
        pieces = (Segment((top - speed) / up, up), Segment(cruise, 0.0), Segment(top / down, -down))
        return PlannedSpeed(SpeedProfile(speed, pieces), "cruise")
    peak = math.sqrt((2.0 * up * down * room + down * speed**2) / (up + down))
    peak = max(peak, speed)
    pieces = (Segment((peak - speed) / up, up), Segment(0.0, 0.0), Segment(peak / down, -down))
    return PlannedSpeed(SpeedProfile(speed, pieces), "peak")


def stopping_gap(obstacle_speed: float, limits: PlanningLimits) -> float:
    """Return the gap at which a plan ends, whatever the obstacle does [m]."""
    return limits.standoff


def _emergency(situation: Situation, speed: float, room: float, limits: PlanningLimits) -> PlannedSpeed:
    """Return the stop within the room, or within all there is."""
    hardest = limits.emergency_deceleration
    needed = speed**2 / (2.0 * room) if room > 0.0 else math.inf
    braking = min(needed, hardest)
    stop = SpeedProfile(speed, (Segment(speed / braking, -braking),) if speed > 0.0 else ())
    return PlannedSpeed(stop, "emergency", safe=stands_clear(situation, speed, limits))


def stands_clear(situation: Situation, speed: float, limits: PlanningLimits) -> bool:
    """Say whether braking as hard as possible keeps half the standoff to what keeps its speed.

    Where nothing closes in, there is nothing to brake for.
    """
    closing = speed - max(situation.obstacle_speed, 0.0)
    if closing <= 0.0:
        return True
    needed = closing**2 / (2.0 * limits.emergency_deceleration)
    return situation.gap - needed >= 0.5 * limits.standoff - 1e-9
