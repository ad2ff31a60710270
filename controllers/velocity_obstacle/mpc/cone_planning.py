"""Plans for a passing class with collision cones instead of bounds on the position."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.conflicts.path_conflicts import STRAIGHT_ON, Conflicts
from controllers.interface import Lane, Perception
from controllers.optimisation.solve import Memory
from controllers.velocity_obstacle.mpc.cone_program import ConeProgram, JointPlan
from controllers.velocity_obstacle.mpc.cone_rows import Motion, Walkers
from controllers.velocity_obstacle.mpc.lateral import LateralProgram, SteeringPlan, SteeringTask
from controllers.velocity_obstacle.mpc.longitudinal import SpeedPlan, SpeedTask
from controllers.velocity_obstacle.mpc.speed_planning import SpeedPlanner

SLOTS = 6
"""Number of nearest pedestrians that get a cone; those farther away bound the position instead."""

SteeringOf = Callable[[Perception, SpeedPlan, Lane | None], SteeringTask]
"""Function that makes the steering task for a speed plan on the way into a lane."""


@dataclass(slots=True, kw_only=True)
class ConePlanner(SpeedPlanner):
    """Speed planner that represents pedestrians as collision cones, and so plans the steering as well."""

    steering: LateralProgram
    steering_of: SteeringOf
    joint: ConeProgram
    steering_memory: Memory
    joint_memory: Memory

    def _solve_class(
        self,
        perception: Perception,
        lane: Lane | None,
        task: SpeedTask,
        conflicts: Conflicts,
        behind: int,
    ) -> tuple[SpeedPlan, SteeringPlan | None]:
        """Solve sequential QPs, starting from the plan that keeps the positions apart."""
        # ``slots=True`` creates the class anew, so zero-argument super() does not work here.
        speed, nothing = SpeedPlanner._solve_class(self, perception, lane, task, conflicts, behind)
        if len(conflicts) == 0 or not speed.found:
            return speed, nothing
        near = _nearest(perception, conflicts)
        far = np.setdiff1d(np.arange(len(conflicts)), near)
        bounded = self._bounded(perception, task, conflicts.only(far), int(np.count_nonzero(far < behind)))
        walkers = self._walkers(conflicts, near, behind)
        steering_task = self.steering_of(perception, speed, lane)
        best = JointPlan(speed, self.steering.solve(steering_task, memory=self.steering_memory))
        if not best.steering.found:
            return speed, nothing
        joined = False
        for _ in range(self.settings.passes):
            plan = self.joint.solve(
                bounded._replace(expected=best.speed.speed),
                steering_task,
                walkers,
                _motion(best, steering_task, perception.ego.speed),
                start=self.joint.start(best),
                memory=self.joint_memory,
            )
            if not plan.speed.found:
                # The previous pass's plan holds about its own nominal motion; the first pass has none.
                return (best.speed, best.steering) if joined else (plan.speed, nothing)
            best, joined = plan, True
            steering_task = self.steering_of(perception, best.speed, lane)
        return best.speed, best.steering

    def _walkers(self, conflicts: Conflicts, chosen: NDArray[np.intp], behind: int) -> Walkers:
        """Return predictions of the chosen pedestrians, and the side on which each is passed.

        An ego that passes ahead of a pedestrian walking to the left keeps its relative velocity left of them.
        """
        times = self.memory.times
        c = conflicts
        side = np.sign(c.across_speed[chosen]) * np.where(chosen < behind, -1.0, 1.0)
        if c.forecast is not None:
            forecast = c.forecast.only(chosen)
            there, velocity = forecast.at(times), forecast.velocities()
            vx, vy = (
                np.array([np.interp(times, forecast.times, one) for one in speeds]) for speeds in velocity
            )
            return Walkers(there.along, there.across, vx, vy, c.radius[chosen], side, there.reach)
        x = c.along_at(times)[chosen]
        y = c.across[chosen, None] + c.across_speed[chosen, None] * times
        vx = np.where(times < STRAIGHT_ON, c.along_speed[chosen, None], 0.0)
        vy = np.broadcast_to(c.across_speed[chosen, None], x.shape)
        return Walkers(x, y, vx, vy, c.radius[chosen], side)


def _nearest(perception: Perception, conflicts: Conflicts) -> NDArray[np.intp]:
    """Return the indices of the nearest pedestrians, in ascending order."""
    distance = np.hypot(conflicts.along - perception.ego.body.front, conflicts.across - perception.ego.across)
    return np.sort(np.argsort(distance, kind="stable")[:SLOTS])


def _motion(plan: JointPlan, task: SteeringTask, speed: float) -> Motion:
    return Motion(
        plan.speed.position,
        plan.steering.across,
        plan.steering.heading_error,
        plan.speed.speed,
        task.heading_error,
        speed,
    )
