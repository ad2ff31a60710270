"""A driver that plans less often where there is nothing to plan for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.interface import Controller, Decision, Perception, Plan
from controllers.own_part import IDLE
from controllers.velocity_obstacle.mpc.plan_memory import rest_of

LEAST_VIEW = 40.0
"""Whoever is nearer along the road is a reason to plan, however slow the ego is [m]."""
VIEW_TIME = 8.0
"""So is whoever is nearer than what the ego drives in this time [s]."""
BEHIND = 15.0
"""And whoever is less far behind [m]."""
BESIDE = 12.0
"""Vehicles further to the side are not in the way [m]."""
LONGEST = 0.5
"""Commands go on for this long after the next plan was due [s]."""


@dataclass(slots=True)
class Unhurried:
    """Hands on to a driver, but not at every step while nobody and nothing is near.

    Parameters
    ----------
    driver : who plans
    interval : time between plans while the road is empty, at most ``LONGEST`` [s]
    """

    driver: Controller
    interval: float
    _last: tuple[float, Decision, Plan] | None = None

    def decide(self, perception: Perception) -> Decision:
        """Return the last decision while it may stand, a new one otherwise."""
        if self._last is not None and self._may_rest(perception):
            return self._last[1]
        self._last = None
        return self.driver.decide(perception)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Return what is left of the last plan's command while it may stand, a new plan otherwise."""
        if self._last is not None:
            made, _, plan = self._last
            return Plan(rest_of(plan.command, perception.ego.time - made), own=IDLE)
        plan = self.driver.plan(perception, decision)
        if plan.solved and not plan.passing:
            self._last = (perception.ego.time, decision, plan)
        return plan

    def _may_rest(self, perception: Perception) -> bool:
        assert self._last is not None, "asked before the first plan"
        # Half a step of tolerance: times of steps are sums.
        due = self._last[0] + self.interval - 0.5 * perception.ego.plan_interval
        return perception.ego.time < due and is_empty(perception)


def is_empty(perception: Perception) -> bool:
    """Return whether nobody is near and nothing ahead has to be minded: the road goes straight on."""
    ego, road, people, them = perception.ego, perception.road, perception.pedestrians, perception.vehicles
    view = max(LEAST_VIEW, VIEW_TIME * ego.speed)
    if len(road.foes) or road.route_end < view:
        return False
    if any(crossing.exit > -BEHIND and crossing.entry < view for crossing in road.crossings):
        return False
    if any(signal.stop_line < view for signal in road.signals):
        return False
    here = road.lane(road.reference)
    if here is None or here.follows_route_for < view:
        return False
    if ((people.along > -BEHIND) & (people.along < view)).any():
        return False
    return not ((them.along > -BEHIND) & (them.along < view) & (np.abs(them.across) < BESIDE)).any()
