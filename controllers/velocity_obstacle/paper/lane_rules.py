"""Which lanes ``vo_paper`` and ``vo_ga`` may use to avoid somebody, and the change under way."""

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
"""A slower ego does not change lanes to avoid somebody [m/s]."""
BEYOND = 50.0
"""How much farther than the change itself the other lane must lead along the route [m]."""
BENT = 0.02
"""Lanes are not changed in a sharper bend [1/m]."""
LAST_STEPS = 5
"""A change is planned for that many steps to come at least: an Euler bicycle needs three to move sideways
and as many again to be straight."""
KEPT = 0.05
"""A plan that violates nothing by more is one that works, in units of the margins."""
SAVING = 0.01
"""A change has to cost less by this share: solvers are no more exact."""
ARRIVED, STRAIGHT = 0.3, 0.03
"""Offset [m] and heading [rad] with which a change has arrived."""


@dataclass(frozen=True, slots=True)
class Change:
    """A change of lane that the ego has begun in order to avoid somebody."""

    lane: int
    begun: float
    """[s]"""
    steps: int

    def arrival(self, time: float, scene: SceneSettings) -> int:
        """Return after how many steps from now it is to arrive."""
        gone = round((time - self.begun) / scene.step)
        return min(max(self.steps - gone, LAST_STEPS), scene.steps)

    def over(self, perception: Perception, decision: Decision) -> bool:
        """Say whether it has arrived or was given up."""
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
        Steps that a change takes; ``None`` where there are to be none.
    reading
        Which conditions the rules have.
    """

    scene: SceneSettings
    change_steps: int | None
    reading: Reading = Reading.ADAPTED

    def open_lanes(self, perception: Perception) -> tuple[Rule, list[Lane]]:
        """Return the rule that holds, and the lanes that may be changed to by it, the left one first."""
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
        """Say whether to change lanes: the plan works, and it is the cheaper one or the only one allowed.

        Notes
        -----
        LANE CHANGE says that the own lane has no room, so the change needs not be cheaper.
        """
        if change.violation > KEPT:
            return False
        return rule is Rule.LANE_CHANGE or change.merit < (1.0 - SAVING) * straight.merit

    def _usable(self, perception: Perception, lane: Lane | None) -> bool:
        """Say whether there is such a lane, straight and long enough to change to it now."""
        road, ego = perception.road, perception.ego
        if lane is None or self.change_steps is None or ego.speed < LEAST_SPEED:
            return False
        length = ego.speed * self.change_steps * self.scene.step
        count = int(length / road.curvature_step) + 1 if road.curvature_step > 0.0 else 0
        bends = bool((np.abs(road.curvature[:count]) > BENT).any())
        leads = lane.follows_route_for >= min(length + BEYOND, road.route_end)
        return leads and not bends and blocker(perception, lane.number) is None
