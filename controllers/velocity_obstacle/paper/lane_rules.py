"""Lanes that ``vo_paper`` and ``vo_ga`` may use to avoid pedestrians, and the change under way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.driving.lanes.gap_acceptance import blocker
from controllers.interface import Decision, Lane, Perception
from controllers.velocity_obstacle import decision_rules
from controllers.velocity_obstacle.decision_rules import Reading, Rule
from controllers.velocity_obstacle.paper.scene import SceneSettings
from controllers.velocity_obstacle.paper.sequential_programs import AvoidancePlan

LEAST_SPEED = 2.0
"""An ego slower than this does not change lanes to avoid pedestrians [m/s]."""
BEYOND = 50.0
"""How much farther than the change itself the other lane must lead along the route [m]."""
BENT = 0.02
"""Lanes are not changed in bends sharper than this [1/m]."""
LAST_STEPS = 5
"""A change is planned for at least this many steps ahead: an Euler bicycle needs three to move sideways and
as many again to be straight."""
KEPT = 0.05
"""A plan works if it violates no margin by more than this, in units of the margins."""
SAVING = 0.01
"""Share by which a change has to be cheaper, because solvers are no more exact than this."""
ARRIVED, STRAIGHT = 0.3, 0.03
"""A change has arrived when offset and heading are below these [m, rad]."""


@dataclass(frozen=True, slots=True)
class Change:
    """A lane change that the ego has begun in order to avoid pedestrians."""

    lane: int
    begun: float
    """When it began [s]."""
    steps: int

    def arrival(self, time: float, scene: SceneSettings) -> int:
        """Return the number of steps from now after which the change is to arrive."""
        gone = round((time - self.begun) / scene.step)
        return min(max(self.steps - gone, LAST_STEPS), scene.steps)

    def over(self, perception: Perception, decision: Decision) -> bool:
        """Return whether the change has arrived or was given up."""
        lane, ego = perception.road.lane(self.lane), perception.ego
        if lane is None or decision.target_lane != self.lane:
            return True
        there = abs(ego.across - lane.offset) < ARRIVED and abs(ego.heading_error) < STRAIGHT
        return there and perception.road.reference == self.lane


@dataclass(frozen=True, slots=True)
class LaneRules:
    """Decision rules (26) to (31) for the lanes beside the ego.

    Parameters
    ----------
    scene
        For ``G_min = standstill_gap + headway v`` and the length of a step.
    change_steps
        Steps that a change takes; ``None`` for no changes.
    reading
        How the conditions of the rules are read.
    """

    scene: SceneSettings
    change_steps: int | None
    reading: Reading = Reading.ADAPTED

    def open_lanes(self, perception: Perception) -> tuple[Rule, list[Lane]]:
        """Return the rule that holds and the lanes that it allows a change to, the left one first."""
        if self.change_steps is None:
            return Rule.STRAIGHT, []
        road, ego = perception.road, perception.ego
        g_min = decision_rules.least_gap(max(ego.speed, 0.0), self.scene.standstill_gap, self.scene.headway)
        printed = self.reading is Reading.PRINTED
        rule_of = decision_rules.printed_rule if printed else decision_rules.rule
        found = {
            side: rule_of(decision_rules.towards(perception.gaps, side), g_min)
            for side in (1, -1)
            if self._usable(perception, road.lane(road.reference + side))
        }
        for rule in (Rule.LANE_CHANGE, Rule.AUTONOMOUS):
            lanes = [road.lane(road.reference + side) for side, one in found.items() if one is rule]
            if lanes:
                return rule, [lane for lane in lanes if lane is not None]
        return Rule.STRAIGHT, []

    def better(self, straight: AvoidancePlan, change: AvoidancePlan, rule: Rule) -> bool:
        """Return whether to change lanes: the change works, and it is cheaper or the only option allowed.

        Notes
        -----
        LANE CHANGE says that the ego's lane has no room, so the change need not be cheaper.
        """
        if change.violation > KEPT:
            return False
        return rule is Rule.LANE_CHANGE or change.merit < (1.0 - SAVING) * straight.merit

    def _usable(self, perception: Perception, lane: Lane | None) -> bool:
        """Return whether there is such a lane, straight and long enough to change to now."""
        road, ego = perception.road, perception.ego
        if lane is None or self.change_steps is None or ego.speed < LEAST_SPEED:
            return False
        length = ego.speed * self.change_steps * self.scene.step
        count = int(length / road.curvature_step) + 1 if road.curvature_step > 0.0 else 0
        bends = bool((np.abs(road.curvature[:count]) > BENT).any())
        leads = lane.follows_route_for >= min(length + BEYOND, road.route_end)
        return leads and not bends and blocker(perception, lane.number) is None
