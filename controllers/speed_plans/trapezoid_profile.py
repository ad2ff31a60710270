"""Classic trapezoidal planning: speed up, keep the highest speed, slow down and stand before an obstacle.

The obstacle is taken as standing, whatever it does; planning with an intermediate speed removes this flaw.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from controllers.speed_plans.speed_profile import Segment, SpeedProfile


@dataclass(frozen=True, slots=True)
class PlanningLimits:
    """Limits of a speed plan; all are greater than zero except the last two, which may be zero."""

    acceleration: float = 1.723
    """a_a [m/s^2]."""
    deceleration: float = 0.6944
    """a_d, normal deceleration [m/s^2]."""
    emergency_deceleration: float = 8.0
    """Largest deceleration in an emergency [m/s^2]."""
    top_speed: float = 11.111
    """V_max [m/s]."""
    actuator_delay: float = 0.3
    """α, time from the command to its effect [s]."""
    standoff: float = 2.5
    """d_extra, the distance left to the obstacle after a stop: half a car's length in the paper [m]."""


@dataclass(frozen=True, slots=True)
class Situation:
    """The ego and one obstacle ahead of it."""

    gap: float
    """S, gap from the ego's front bumper to the obstacle [m]."""
    speed: float
    """V_i, speed of the ego [m/s]."""
    obstacle_speed: float = 0.0
    """V_tar, speed of the obstacle [m/s]."""


@dataclass(frozen=True, slots=True)
class PlannedSpeed:
    """A speed plan for one obstacle."""

    profile: SpeedProfile
    case: str
    """Case of the method that applies."""
    safe: bool = True
    """False if no braking within the limits keeps half the standoff."""


def free_profile(speed: float, limits: PlanningLimits) -> SpeedProfile:
    """Return the profile that leads to the top speed with nothing ahead."""
    change = limits.top_speed - speed
    if change == 0.0:
        return SpeedProfile(speed)
    rate = limits.acceleration if change > 0.0 else -limits.deceleration
    return SpeedProfile(speed, (Segment(change / rate, rate),))


def plan_trapezoid(situation: Situation, limits: PlanningLimits) -> PlannedSpeed:
    """Return the speed plan that ends standing before where the obstacle is now.

    S_a = (V_max² − V_i²) / (2 a_a), zero above V_max; S_d = V_max² / (2 a_d) + α V_i + d_extra. The ego
    drives S_m = S − S_a − S_d at V_max. If S_m < 0, the highest speed is V_p with
    V_p² = (2 a_a a_d D' + a_d V_i²) / (a_a + a_d), D' = S − α V_i − d_extra. If D' is shorter than
    V_i² / (2 a_d), the ego brakes at once with V_i² / (2 D').

    Parameters
    ----------
    situation : the obstacle's speed is not used
    limits : limits of the plan

    Notes
    -----
    Eqs. (1)-(3) of [Duan]_; the first two are lost in the copy at hand and reconstructed from the text.
    The distance α V_i is driven before braking begins, so with ideal actuators a single plan ends that much
    short. With replanning while driving, this distance shrinks with the speed, and the ego stands at d_extra.

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
    """Return the gap at which a plan ends, whatever the obstacle's speed [m]."""
    return limits.standoff


def _emergency(situation: Situation, speed: float, room: float, limits: PlanningLimits) -> PlannedSpeed:
    """Return the stop within the room, or with the hardest braking if the room is too short."""
    hardest = limits.emergency_deceleration
    needed = speed**2 / (2.0 * room) if room > 0.0 else math.inf
    braking = min(needed, hardest)
    stop = SpeedProfile(speed, (Segment(speed / braking, -braking),) if speed > 0.0 else ())
    return PlannedSpeed(stop, "emergency", safe=stands_clear(situation, speed, limits))


def stands_clear(situation: Situation, speed: float, limits: PlanningLimits) -> bool:
    """Return whether the hardest braking keeps half the standoff to an obstacle that keeps its speed.

    If the gap is not closing, there is nothing to brake for.
    """
    closing = speed - max(situation.obstacle_speed, 0.0)
    if closing <= 0.0:
        return True
    needed = closing**2 / (2.0 * limits.emergency_deceleration)
    return situation.gap - needed >= 0.5 * limits.standoff - 1e-9
