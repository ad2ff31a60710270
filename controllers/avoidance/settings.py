"""The parameters that controllers of the avoidance problem share, checked by name."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from controllers.avoidance.driver import DriverSettings
from controllers.avoidance.lanes import LAST_STEPS
from controllers.avoidance.problem import InputLimits
from controllers.avoidance.scene import SceneSettings
from controllers.conflicts.velocity_obstacle import Cone


class Model(StrEnum):
    """Which formulation of the velocity-obstacle controller drives."""

    CLOSED_LOOP = "closed_loop"
    """Short steps, actuators with lag, two programs for speed and steering; what held in closed loop."""
    PAPER = "paper"
    """The paper's own: explicit Euler steps of one second, objective (6), a cone at every step."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperSettings:
    """As a user sets them; ``controllers.strategies.vo_ga.build`` says what they mean."""

    replan_s: float
    euler_step_s: float
    euler_steps: int
    disc_radius_m: float
    cone: Cone
    truncation_s: float
    steering_weight: float
    top_speed_mps: float | None
    standstill_gap_m: float
    headway_s: float
    lane_changes: bool
    change_steps: int


def driver_settings(given: PaperSettings) -> DriverSettings:
    """Return the settings of the driver.

    Raises
    ------
    ValueError
        If one is out of range.
    """
    above_zero = {
        "euler_step_s": given.euler_step_s,
        "disc_radius_m": given.disc_radius_m,
        "replan_s": given.replan_s,
        "top_speed_mps": given.top_speed_mps if given.top_speed_mps is not None else 1.0,
    }
    not_negative = {
        "steering_weight": given.steering_weight,
        "standstill_gap_m": given.standstill_gap_m,
        "headway_s": given.headway_s,
    }
    for name, value in above_zero.items():
        if not 0.0 < value < float("inf"):
            raise ValueError(f"{name} must be above 0 and finite, not {value}")
    for name, value in not_negative.items():
        if not 0.0 <= value < float("inf"):
            raise ValueError(f"{name} must be at least 0 and finite, not {value}")
    if not given.truncation_s > 0.0:
        raise ValueError(f"truncation_s must be above 0, not {given.truncation_s}")
    if given.cone is Cone.STEP:
        raise ValueError("cone = 'step' bounds positions, not velocities: choose vo, ivo or hybrid")
    if given.euler_steps < 2:
        raise ValueError(f"euler_steps must be at least 2, not {given.euler_steps}")
    horizon = given.euler_steps * given.euler_step_s
    if given.replan_s > horizon:
        raise ValueError(f"replan_s = {given.replan_s} is longer than the horizon of {horizon} s")
    if given.lane_changes and not LAST_STEPS <= given.change_steps <= given.euler_steps:
        raise ValueError(
            f"change_steps must be from {LAST_STEPS} to euler_steps = {given.euler_steps}, "
            f"not {given.change_steps}; or set lane_changes=false"
        )
    scene = SceneSettings(
        step=given.euler_step_s,
        steps=given.euler_steps,
        radius=given.disc_radius_m,
        cone=given.cone,
        limits=InputLimits(),
        steering_weight=given.steering_weight,
        top_speed=given.top_speed_mps,
        standstill_gap=given.standstill_gap_m,
        headway=given.headway_s,
        truncation=given.truncation_s,
    )
    return DriverSettings(scene, given.replan_s, given.change_steps if given.lane_changes else None)
