"""What the ego does when a program has no certified solution: the declared fallback."""

from __future__ import annotations

from controllers.conflicts.path_conflicts import Conflicts
from controllers.interface import EgoState, Plan, constant_command
from controllers.velocity_obstacle.mpc.longitudinal import SpeedLimits
from controllers.velocity_obstacle.mpc.plan_memory import PlanMemory

FRESH = 0.5
"""The ego goes on with a plan up to this age when no new one is found [s]."""


def fallback(memory: PlanMemory, ego: EgoState, conflicts: Conflicts, limits: SpeedLimits) -> Plan:
    """Return the rest of the last plan while it is fresh, then a comfortable or a hard stop."""
    rest = memory.rest(ego.time)
    if rest is not None and memory.age(ego.time) < FRESH:
        return Plan(rest, solved=False, status="fallback_last_plan")
    stopping = ego.speed**2 / (2.0 * limits.comfortable_braking) + 2.0
    near = conflicts.along - ego.body.front < stopping
    braking = limits.emergency_braking if near.any() else limits.comfortable_braking
    status = "fallback_emergency_stop" if near.any() else "fallback_comfortable_stop"
    return Plan(constant_command(-braking, memory.commanded(ego)[1]), False, status)
