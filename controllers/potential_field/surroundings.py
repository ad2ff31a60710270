"""The surroundings that matter for an ego's way down a field: people, distances, lanes and speeds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.driving.following import limit_now
from controllers.driving.lanes.gap_acceptance import blocker
from controllers.interface import Decision, Perception
from controllers.potential_field.road_field import LONG_BEHIND, SLOWEST, braked_speeds
from controllers.prediction.forecast import Forecast

STEP = 0.1
"""Time step of the simulated drives [s]."""
SHORTEST = 1.5
"""The simulated drives last at least this long [s] …"""
LONGEST = 4.5
"""… and at most this long [s]."""
STRAIGHT = 0.02
"""In a tighter bend the field does not steer, because it is made for straight roads [1/m]."""
GAINS_FOR = 1.0
"""An ego that speeds up is expected to do so for this time [s]."""
BESIDE = 8.0
"""Pedestrians who stay further than this to the side of the ego during the forecast do not matter [m]."""


def near_the_way(perception: Perception, forecast: Forecast) -> NDArray[np.int64]:
    """Return the indices of the pedestrians who may come near the ego's path during the forecast."""
    people, ego = perception.pedestrians, perception.ego
    speed = max(ego.speed, SLOWEST)
    furthest = ego.body.front + speed * LONGEST + BESIDE
    along = (people.along > -ego.body.length - speed * LONG_BEHIND) & (people.along < furthest)
    across = np.abs(forecast.across - ego.across).min(axis=1) < BESIDE
    return np.flatnonzero(along & across)


def instants(perception: Perception, braking: float) -> FloatArray:
    """Return the instants to simulate until the ego is past everybody; all of them if it brakes [s]."""
    ego = perception.ego
    furthest = float(perception.pedestrians.along.max()) + ego.body.length
    if braking:
        return STEP * np.arange(round(LONGEST / STEP) + 1, dtype=np.float64)
    needed = min(max(furthest / max(ego.speed, SLOWEST), SHORTEST), LONGEST)
    return STEP * np.arange(round(needed / STEP) + 1, dtype=np.float64)


def bends(perception: Perception) -> bool:
    """Say whether the road ahead bends too much for the field."""
    road, ego = perception.road, perception.ego
    places = np.arange(len(road.curvature)) * road.curvature_step
    near = places < max(2.0 * ego.speed, 10.0)
    return bool((np.abs(road.curvature[near]) > STRAIGHT).any())


def centre_lines(perception: Perception, decision: Decision) -> FloatArray:
    """Return the centre line of the target lane and, if it is another lane, that of the ego's lane."""
    road = perception.road
    lanes = [road.lane(decision.target_lane), road.lane(road.reference)]
    offsets = [lane.offset for lane in lanes if lane is not None] or [0.0]
    return np.array(offsets if offsets[0] != offsets[-1] else offsets[:1])


def centre_lines_beside(perception: Perception, centres: FloatArray) -> list[float]:
    """Return the centre lines of other lanes beside the ego's to which it could change."""
    road = perception.road
    return [
        lane.offset
        for lane in road.lanes
        if abs(lane.number - road.reference) == 1
        and lane.offset not in centres
        and blocker(perception, lane.number) is None
    ]


def expected_speeds(
    perception: Perception, acceleration: float, instants: FloatArray, braking: float = 0.0
) -> FloatArray:
    """Return the expected speeds of the ego [m/s].

    If it brakes for a way past, it brakes until it is past; if it speeds up, it does so for a while.
    """
    ego = perception.ego
    if acceleration == -braking < 0.0:
        return braked_speeds(ego, braking, instants)
    speed = max(ego.speed, 0.0)
    lasting = np.minimum(instants, GAINS_FOR) if acceleration > 0.0 else instants
    highest = max(speed, limit_now(perception.road, ego.body.front))
    return np.clip(speed + acceleration * lasting, 0.0, highest)
