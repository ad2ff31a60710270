"""The avoidance plan that is being followed: its speeds and angles, and the commands that track them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.conflicts.path_conflicts import Conflicts
from controllers.driving.lanes.lane_path import LanePath
from controllers.driving.standing import HOLDING_GENTLY, STANDING
from controllers.interface import EgoState, Lane, Perception
from controllers.velocity_obstacle.paper.euler_bicycle import HEADING, SPEED, STEERING
from controllers.velocity_obstacle.paper.problem import AvoidanceProblem
from controllers.velocity_obstacle.paper.sequential_programs import AvoidancePlan

SURPRISE = 0.5
"""The ego plans anew if pedestrians are this far, across the road, from where they were expected [m]."""
SPEED_TIME = 0.4
"""Time constant with which a deviation from the planned speed is corrected [s]."""


@dataclass(frozen=True, slots=True)
class Option:
    """A plan for one lane."""

    lane: Lane
    problem: AvoidanceProblem
    conflicts: Conflicts
    plan: AvoidancePlan
    threats: tuple[str, ...]
    """Names of the pedestrians that the plan does not avoid."""


@dataclass(frozen=True, slots=True)
class Kept:
    """An option that is being followed."""

    option: Option
    made: float
    """When the plan was made [s]."""
    travelled: float
    """Odometer reading when the plan was made [m]."""
    path: LanePath | None
    """Path of a lane change."""
    other: Option | None
    """Best of the options that were not taken."""

    @property
    def avoids(self) -> bool:
        """Whether the plan avoids everybody."""
        return not self.option.threats

    @property
    def step(self) -> float:
        """Length of the plan's steps [s]."""
        return self.option.problem.bicycle.step

    def speed_at(self, times: FloatArray) -> FloatArray:
        """Return the planned speeds at simulated times, linear between the steps [m/s]."""
        speeds = self.option.plan.states[SPEED]
        return np.asarray(np.interp(times - self.made, self.step * np.arange(len(speeds)), speeds))

    def turned_at(self, time: float) -> tuple[float, float]:
        """Return the planned heading and wheel angle at a simulated time [rad]."""
        states = self.option.plan.states
        at = (time - self.made) / self.step
        grid = np.arange(states.shape[1])
        return float(np.interp(at, grid, states[HEADING])), float(np.interp(at, grid, states[STEERING]))

    def surprised(self, perception: Perception) -> bool:
        """Return whether pedestrians are not where they were expected to be by now."""
        people, conflicts = perception.pedestrians, self.option.conflicts
        expected = self.option.problem.people
        age = perception.ego.time - self.made
        at = np.concatenate(([0.0], self.step * np.arange(1.0, expected.across.shape[1] + 1.0)))
        places = dict(zip(people.names, people.across, strict=True))
        lane = perception.road.lane(self.option.lane.number)
        shifted = lane.offset - self.option.lane.offset if lane is not None else 0.0
        for i, name in enumerate(conflicts.names):
            there = np.concatenate((conflicts.across[i : i + 1], expected.across[i]))
            if name in places and abs(places[name] - shifted - np.interp(age, at, there)) > SURPRISE:
                return True
        return False

    def moved_on(self, time: float) -> FloatArray:
        """Return the remaining inputs, with zeros after them, shape (2, n) [m/s, rad]."""
        inputs = self.option.plan.inputs
        gone = min(round((time - self.made) / self.step), inputs.shape[1])
        return np.concatenate((inputs[:, gone:], np.zeros((2, gone))), axis=1)


def tracked(ego: EgoState, kept: Kept, times: FloatArray) -> FloatArray:
    """Return the accelerations that follow the planned speeds, given the drive's lag [m/s^2]."""
    step = float(times[1] - times[0]) if len(times) > 1 else ego.plan_interval
    share = -math.expm1(-step / ego.drive.drive_lag) if ego.drive.drive_lag > 0.0 else 1.0
    at = ego.time + np.append(times, times[-1] + step)
    planned = kept.speed_at(at)
    result = np.zeros(len(times))
    speed, actual = max(ego.speed, 0.0), ego.acceleration
    for i in range(len(times)):
        slope = (planned[i + 1] - planned[i]) / step
        result[i] = slope + (planned[i] - speed) / SPEED_TIME
        if speed < STANDING and planned[i + 1] < STANDING:
            result[i] = HOLDING_GENTLY
        wanted = min(max(float(result[i]), -ego.drive.max_deceleration), ego.drive.max_acceleration)
        actual += share * (wanted - actual)
        speed = max(speed + step * actual, 0.0)
    return result
