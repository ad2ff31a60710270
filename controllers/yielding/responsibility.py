"""Responsibility-sensitive safety (RSS) for pedestrians: safe distances, and the proper response."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.yielding.facing import Answer, Facing


@dataclass(frozen=True, slots=True)
class ResponsibilityRule:
    """What both sides are assumed to do in the worst case.

    Parameters
    ----------
    response_time : ρ of the ego [s]
    acceleration : a_max of the ego within its response time [m/s^2]
    braking : b_min, least deceleration of the ego from then on [m/s^2]
    pedestrian_response : ρ of pedestrians [s]
    pedestrian_acceleration, pedestrian_braking : acceleration of pedestrians across the road within their
        response time, and deceleration afterwards [m/s^2]
    margin : μ, allowance for small movements to the side [m]
    """

    response_time: float
    acceleration: float
    braking: float
    pedestrian_response: float
    pedestrian_acceleration: float
    pedestrian_braking: float
    margin: float

    def along(self, speed: float) -> float:
        """Return the safe distance to a pedestrian who stands or crosses [m].

        v ρ + a_max ρ² / 2 + (v + ρ a_max)² / (2 b_min)

        Notes
        -----
        Lemma 2 of [ShalevShwartz2017]_ for a road user ahead who has no speed along the road.
        """
        reached = speed + self.response_time * self.acceleration
        gained = 0.5 * self.acceleration * self.response_time**2
        return speed * self.response_time + gained + reached**2 / (2.0 * self.braking)

    def speed_at(self, distance: float) -> float:
        """Return the highest speed at which a distance is safe, 0 if none is [m/s]; inverse of ``along``."""
        rho, a, b = self.response_time, self.acceleration, self.braking
        # v² + 2 (ρ a + ρ b) v + ρ² a² + b a ρ² − 2 b d = 0
        half = rho * (a + b)
        under = half**2 - (rho**2 * a * (a + b) - 2.0 * b * distance)
        return max(math.sqrt(max(under, 0.0)) - half, 0.0)

    def across(self, towards: FloatArray) -> FloatArray:
        """Return the safe distances to the side for pedestrians who come nearer at given speeds [m].

        μ + v ρ + a ρ² / 2 + (v + ρ a)² / (2 b), but at least μ for those who move away

        Notes
        -----
        Lemma 4 of [ShalevShwartz2017]_ with an ego that keeps its place in the lane.
        """
        rho, a, b = self.pedestrian_response, self.pedestrian_acceleration, self.pedestrian_braking
        reached = np.maximum(towards + rho * a, 0.0)
        way = towards * rho + 0.5 * a * rho**2 + reached**2 / (2.0 * b)
        return np.asarray(self.margin + np.maximum(way, 0.0))


class ResponsibilityFilter:
    """Brakes for pedestrians if neither distance to them is safe; otherwise keeps the state safe.

    Parameters
    ----------
    rule : gives the safe distances
    """

    def __init__(self, rule: ResponsibilityRule) -> None:
        self._rule = rule

    def allowed(self, facing: Facing) -> Answer:
        """Return the proper response: b_min or more in danger, otherwise nothing that leads into danger."""
        ego, people = facing.perception.ego, facing.people
        beside = np.abs(people.across - ego.across) - 0.5 * ego.body.width - people.radius
        towards = -np.sign(people.across - ego.across) * people.across_speed
        concerned = np.flatnonzero((beside <= self._rule.across(towards)) & (people.leave > 0.0))
        if not len(concerned):
            return Answer()
        nearest = int(concerned[np.argmin(facing.gaps[concerned])])
        gap, name = max(float(facing.gaps[nearest]), 0.0), people.names[nearest]
        danger = gap < self._rule.along(ego.speed)
        if danger:
            # The rules require at least b_min; a pedestrian who steps out late needs more.
            needed = ego.speed**2 / (2.0 * max(gap, 0.1))
            return Answer(-max(self._rule.braking, needed), True, name)
        interval = max(ego.plan_interval, 0.1)
        onward = gap - interval * ego.speed
        most = (self._rule.speed_at(max(onward, 0.0)) - ego.speed) / interval
        return Answer(max(most, -self._rule.braking), True, name)
