"""Where in its lane an ego drives: away from people who stay beside its way, and vehicles that jut in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.driving.lanes import way_into_lane
from controllers.driving.lanes.vehicles_jutting_in import jutting_in, standing_beside
from controllers.geometry.footprints import footprints
from controllers.geometry.swing import farthest_out
from controllers.interface import EgoState, Lane, Perception

LOOK_AHEAD = 45.0
"""People up to here are kept away from [m]."""
WANTED = 0.8
"""Distance that is wanted beside the body [m]."""
ENOUGH, LEAST = 0.5, 0.3
"""Distance for which the body leaves its lane, and without which nobody is made room for [m]."""
ASIDE = 1.5
"""How much nearer somebody may be in a bend than the lane's centre line says: by so much in that of a car, by
more where the front of a longer vehicle swings out [m]."""
TO_THE_LINE = 0.2
"""The body keeps this far from the lane's lines [m]."""
BEYOND = 0.5
"""And goes so much further where somebody could not be passed otherwise, and on until they are passed with
enough distance [m]."""
SHORT = 0.05
"""The steering plan may miss that by so much [m]."""
OVER, OVER_S = 3.0, 2.0
"""And gets there within this distance or this time, whatever is longer [m, s]."""
TO_VEHICLES = 0.3
"""And this far from vehicles beside [m]."""
NEARER = 0.2
"""Vehicles that jut into the lane are made room for like people who are so much farther away [m]."""
BESIDE = 10.0
"""Vehicles from this far behind the rear axle on count as beside [m]."""


def look(perception: Perception, stays: NDArray[np.bool_]) -> Perception:
    """Return the perception with the reference lane's centre line moved away from those who stay beside it.

    Parameters
    ----------
    perception : what the ego is told
    stays : who of the pedestrians is not expected to enter the ego's way
    """
    lane = perception.road.lane(perception.road.reference)
    if lane is None:
        return perception
    moved = _shift(perception, lane, stays)
    if moved == 0.0:
        return perception
    lanes = tuple(
        replace(one, offset=one.offset + moved) if one.number == lane.number else one
        for one in perception.road.lanes
    )
    return replace(perception, road=replace(perception.road, lanes=lanes))


def kept(
    corridor: tuple[FloatArray, FloatArray], shift: float, ego: EgoState, along: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the corridor of a steering plan without the places nearer to those who are kept away from.

    Without that, a plan trades the last centimetres for less steering. On the other side it ends where the
    body would leave the lane, or with the place itself: there may be vehicles beside.

    Parameters
    ----------
    corridor : its right and left end for the rear axle about that place, shape (N,) each [m]
    shift : of the lane's centre line for their sake, left positive [m]
    ego : where it is
    along : planned positions from now, shape (N,) [m]
    """
    if shift == 0.0:
        return corridor
    right, left = corridor
    side = np.sign(shift)
    wanted = shift - side * SHORT
    missing = side * min(side * (ego.across - wanted), 0.0)
    bound = wanted + missing * np.clip(1.0 - along / max(OVER, OVER_S * ego.speed), 0.0, 1.0)
    if shift > 0.0:
        return np.maximum(right, bound), np.maximum(left - shift, shift + SHORT)
    return np.minimum(right - shift, shift - SHORT), np.minimum(left, bound)


def _shift(perception: Perception, lane: Lane, stays: NDArray[np.bool_]) -> float:
    """Return how far to move, left positive [m]."""
    half = 0.5 * perception.ego.body.width
    aside = half + WANTED + max(ASIDE, farthest_out(perception.ego.body, perception.road.curvature))
    people = stays.any() and not way_into_lane.nobody_near(perception, lane.offset, LOOK_AHEAD, aside)
    vehicles = standing_beside(perception, lane, LOOK_AHEAD, aside)
    if not people and not vehicles.any():
        return 0.0
    way = way_into_lane.along_lane(perception, lane.offset, LOOK_AHEAD)
    beside, gap = jutting_in(perception, lane, vehicles, way)
    gap = gap + NEARER
    if people:
        who = _passed(perception, way, stays, aside)
        beside, gap = np.concatenate((beside, who[0])), np.concatenate((gap, who[1]))
    room = max(0.5 * lane.width - half - TO_THE_LINE, 0.0)
    to_right, to_left = _to_vehicles(perception, lane, half)
    from_right = _wanted(gap[beside < 0.0], room, to_left)
    from_left = _wanted(gap[beside > 0.0], room, to_right)
    if from_right > 0.0 and from_left > 0.0:
        return 0.5 * (from_right - from_left)
    return from_right - from_left


def _passed(
    perception: Perception, way: FloatArray, stays: NDArray[np.bool_], aside: float
) -> tuple[FloatArray, FloatArray]:
    """Return on which side those are who stay near the way, when the body is beside them, and the gap to it.

    Looked at are those nearer to the way than ``aside`` [m].

    In a bend the front swings out and the rear cuts in, so that is told from the body's places along it. The
    gap is inf where the body never is beside somebody.
    """
    body = perception.ego.body
    who, at = way_into_lane.people_beside(perception, way, aside)
    who, at = who[stays[who]], at[stays[who]]
    beside, alongside = way_into_lane.beside_body(way, body, at)
    radius = perception.pedestrians.radius[who, None]
    gap = np.where(alongside, np.abs(beside) - 0.5 * body.width - radius, np.inf)
    nearest = np.argmin(gap, axis=1)
    each = np.arange(len(who))
    return beside[each, nearest], gap[each, nearest]


def _wanted(gap: FloatArray, room: float, free: float) -> float:
    """Return how far to keep away from people on one side [m].

    Parameters
    ----------
    gap : to each of them as things are [m]
    room, free : that there is on the other side within the lane, and up to vehicles [m]
    """
    passable = gap[(gap < WANTED) & (gap + min(room + BEYOND, free) > LEAST)]
    if not len(passable):
        return 0.0
    least = float(passable.min())
    return max(min(WANTED - least, room, free), min(ENOUGH - least, free))


def _to_vehicles(perception: Perception, lane: Lane, half: float) -> tuple[float, float]:
    """Return how far the body may move to the right and to the left for the sake of vehicles there [m]."""
    box = footprints(perception.vehicles)
    near = (box.front > -BESIDE) & (box.rear < LOOK_AHEAD)
    left = box.right[near & (box.right > lane.offset)].min(initial=np.inf)
    right = box.left[near & (box.left < lane.offset)].max(initial=-np.inf)
    to_left = left - lane.offset - half - TO_VEHICLES
    to_right = lane.offset - right - half - TO_VEHICLES
    return max(to_right, 0.0), max(to_left, 0.0)
