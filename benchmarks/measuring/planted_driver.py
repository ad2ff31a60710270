"""A controller with planted faults, for searches in SUMO: asleep in some scenes, late in those near them.

``--controller benchmarks/measuring/planted_driver.py``. It knows what it perceives only: when somebody first
walks towards its lane, it measures the gap, how fast they walk and where they began.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping, Sequence

import numpy as np

from analysis.search.axes import Axis, Point
from controllers.driving import lane_keeping
from controllers.interface import Command, Controller, Decision, Manoeuvre, Perception, Plan

AXES = (Axis("gap_s", 3.5, 5.5), Axis("speed_mps", 0.9, 2.2), Axis("from_m", -3.5, -2.0))
"""Of somebody who walks 2.6 m from beside the ego's lane and stays there for 5 s, longer than the ego takes
to come; egos know of pedestrians within 80 m."""
SPACE = """
warmup_s = 1.0
duration_s = 31.0
egos = { count = 1, depart_lane = "1", routes = [{ edges = "east" }] }

[[pedestrians]]
name = "met"
kind = "line"
lane = "east_1"
from_m = [150.0, "$from_m"]
to_m = [150.0, 8.0]
speed_mps = "$speed_mps"
start = { ego_arrival_s = "$gap_s" }
manners = [{ kind = "hesitating", after_m = 2.6, pause_s = 5.0 }]
""" + "".join(f"\n[parameters.{one.name}]\nminimum = {one.low}\nmaximum = {one.high}\n" for one in AXES)
CRITERIA = """
[[criteria]]
id = "no preventable contact"
scope = "encounter"
metric = "collision"
operator = "=="
threshold = 0
where = { preventable_r157 = 1 }
allow_undefined = true
"""
COUNT = 3
MEASURED = 0.1
"""So much may a scene that the controller has measured differ from its parameters, in shares of an axis:
pedestrians set off at one of SUMO's steps and are seen at a plan, 0.1 s each of the gap's range of 2 s."""
SLOPE = 0.35
"""How far from a fault it still brakes late, as a share of an axis."""
BRAKES_MPS2 = 6.0
SPARE_S, SPARE_NEAR_S = 1.5, 0.7
"""It brakes so long before it would be too late without lag, far from a fault and next to one."""
WALKS_MPS = 0.5
IN_LANE_M = 3.6
"""Who is nearer to the middle of the lane is waited for."""
RESPONSE_S = 0.5

Boxes = tuple[Sequence[Mapping[str, float]], float]
"""Centres and half width, in shares of the axes."""


def boxes(volume: float, seed: int) -> Boxes:
    """Return boxes that together have a volume, as a share of the space."""
    half = 0.5 * (volume / COUNT) ** (1.0 / len(AXES))
    generator = random.Random(seed)
    centres = [{axis.name: generator.uniform(half, 1.0 - half) for axis in AXES} for _ in range(COUNT)]
    return centres, half


def outside(planted: Boxes, point: Point) -> list[float]:
    """Return how far a point is outside each box, negative inside, in shares of an axis."""
    centres, half = planted
    shares = {axis.name: axis.share(point[axis.name]) for axis in AXES}
    return [max(abs(shares[name] - at) for name, at in one.items()) - half for one in centres]


class Planted:
    """Keeps lane and speed, and brakes for who walks into its lane, the later the nearer to a fault.

    Parameters
    ----------
    planted
    """

    def __init__(self, planted: Boxes) -> None:
        self._planted = planted
        self._brakes_at = math.inf
        self._seen = False

    def decide(self, perception: Perception) -> Decision:
        return Decision(Manoeuvre.KEEP, target_lane=perception.road.reference)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        ego, people = perception.ego, perception.pedestrians
        if not self._seen:
            for at in np.flatnonzero((people.across_speed > WALKS_MPS) & (people.along > ego.body.front)):
                self._look(perception, int(at))
        times = lane_keeping.instants(ego)
        ahead = (people.along > ego.body.front) & (np.abs(people.across) < IN_LANE_M)
        braking = ego.time >= self._brakes_at and bool(ahead.any())
        wanted = (float(perception.road.limit[0]) - ego.speed) / RESPONSE_S
        acceleration = -BRAKES_MPS2 if braking else min(max(wanted, -2.0), 2.0)
        along = np.full(len(times), acceleration)
        lane = perception.road.lane(decision.target_lane)
        steering = lane_keeping.steering(perception, lane.offset if lane else 0.0, along)
        return Plan(Command(times, along, steering))

    def _look(self, perception: Perception, at: int) -> None:
        """Decide when to brake for a pedestrian who has just set off."""
        self._seen = True
        ego, people = perception.ego, perception.pedestrians
        gap = (float(people.along[at]) - ego.body.front) / ego.speed
        scene = {
            "gap_s": gap,
            "speed_mps": float(people.across_speed[at]),
            "from_m": float(people.across[at]),
        }
        far = min(outside(self._planted, scene))
        if far <= 0.0:
            return
        spare = SPARE_NEAR_S + (SPARE_S - SPARE_NEAR_S) * min(far / SLOPE, 1.0)
        self._brakes_at = ego.time + max(0.0, gap - 0.5 * ego.speed / BRAKES_MPS2 - spare)


def build(*, volume: float = 0.005, boxes_seed: int = 1) -> Controller:
    """Build the controller."""
    return Planted(boxes(volume, boxes_seed))
