"""Where in its lane the ego drives: away from people who stay beside its way and vehicles that jut in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.driving.lanes import way_into_lane
from controllers.driving.lanes.vehicles_jutting_in import jutting_in, standing_beside
from controllers.driving.standing import standing
from controllers.geometry.footprints import footprints
from controllers.geometry.swing import farthest_out
from controllers.interface import EgoState, Lane, Perception

LOOK_AHEAD = 45.0
"""The ego keeps away from people up to this far ahead [m]."""
WANTED = 0.8
"""Wanted distance between people and the body [m]."""
ENOUGH, LEAST = 0.5, 0.3
"""Distance to people for which the body may leave its lane, and distance below which they cannot be passed,
so that the ego makes no room for them [m]."""
ASIDE = 1.5
"""In a bend, people may be this much nearer to the body of a car than the lane's centre line suggests; a
longer vehicle, whose front swings out farther, looks for people farther aside [m]."""
TO_THE_LINE = 0.2
"""Distance that the body keeps from the lane's lines [m]."""
BEYOND = 0.5
"""The ego also makes room for people who can be passed only if the body goes this much further than
``TO_THE_LINE`` allows; the body then moves until the distance is ``ENOUGH`` [m]."""
SHORT = 0.05
"""The steering plan may fall short of the wanted shift by this much [m]."""
OVER, OVER_S = 3.0, 2.0
"""The steering plan reaches that shift within this distance or this time, whichever is longer [m, s]."""
TO_VEHICLES = 0.3
"""Distance that the body keeps from vehicles beside it [m]."""
NEARER = 0.2
"""The ego may come nearer by this to vehicles that jut into the lane than to people [m]."""
BESIDE = 10.0
"""Vehicles up to this far behind the rear axle count as beside the ego [m]."""


def look(perception: Perception, stays: NDArray[np.bool_]) -> Perception:
    """Return the perception with the reference lane's centre line moved away from those who stay beside it.

    Parameters
    ----------
    perception : what the ego is told
    stays : which pedestrians are not expected to enter the ego's way
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
    """Return the corridor of a steering plan without places nearer to the people than the shift allows.

    Without this bound, a plan would trade the last centimetres of distance for less steering. On the other
    side, the corridor ends where the body would leave the lane, or just beyond the shift: there may be
    vehicles beside the ego.

    Parameters
    ----------
    corridor : right and left end for the rear axle about the shifted centre line, shape (N,) each [m]
    shift : shift of the lane's centre line away from the people, left positive [m]
    ego : state of the ego
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
    """Return how far to move the centre line, left positive [m]."""
    half = 0.5 * perception.ego.body.width
    aside = half + WANTED + max(ASIDE, farthest_out(perception.ego.body, perception.road.curvature))
    people = stays.any() and not way_into_lane.nobody_near(perception, lane.offset, LOOK_AHEAD, aside)
    vehicles = standing_beside(perception, lane, LOOK_AHEAD, aside)
    if not people and not vehicles.any():
        return 0.0
    way = way_into_lane.along_lane(perception, lane.offset, LOOK_AHEAD)
    side, to_them = jutting_in(perception, lane, vehicles, way)
    beside, gap = _passed(perception, way, stays, aside) if people else (np.zeros(0), np.zeros(0))
    room = max(0.5 * lane.width - half - TO_THE_LINE, 0.0)
    to_right, to_left = _to_vehicles(perception, lane, way)
    # Between people the ego takes the middle; for a vehicle it does not move too near to people.
    right, left = gap[beside < 0.0], gap[beside > 0.0]
    past_right = min(to_left, _to_people(left))
    past_left = min(to_right, _to_people(right))
    from_right = max(_wanted(right, room, to_left), _wanted(to_them[side < 0.0] + NEARER, room, past_right))
    from_left = max(_wanted(left, room, to_right), _wanted(to_them[side > 0.0] + NEARER, room, past_left))
    if from_right > 0.0 and from_left > 0.0:
        return 0.5 * (from_right - from_left)
    return from_right - from_left


def _passed(
    perception: Perception, way: FloatArray, stays: NDArray[np.bool_], aside: float
) -> tuple[FloatArray, FloatArray]:
    """Return where people who stay near the way are beside the body, left positive, and the least gaps [m].

    Only people nearer to the way than ``aside`` [m] are considered. In a bend the front swings out and the
    rear cuts in, so the gaps are computed from the places of the body along the way. A gap is inf if the body
    never is beside that person.
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
    """Return how far to move away from people or vehicles on one side [m].

    Parameters
    ----------
    gap : gap to each of them without any shift [m]
    room, free : room on the other side within the lane, and up to who is there [m]
    """
    passable = gap[(gap < WANTED) & (gap + min(room + BEYOND, free) > LEAST)]
    if not len(passable):
        return 0.0
    least = float(passable.min())
    return max(min(WANTED - least, room, free), min(ENOUGH - least, free))


def _to_people(gap: FloatArray) -> float:
    """Return how far the body may move before it is too near to one of the people on that side [m]."""
    return max(float(gap.min(initial=np.inf)) - ENOUGH, 0.0)


def _to_vehicles(perception: Perception, lane: Lane, way: FloatArray) -> tuple[float, float]:
    """Return how far the body may move to the right and to the left before it gets too near vehicles [m].

    Of vehicles that stand or come towards the ego, the distance on the true curve of the road counts too: in
    a bend, the front swings out towards them.

    Parameters
    ----------
    perception, lane : as for :func:`look`
    way : as for :func:`controllers.driving.lanes.vehicles_jutting_in.jutting_in`
    """
    box, half = footprints(perception.vehicles), 0.5 * perception.ego.body.width
    near = (box.front > -BESIDE) & (box.rear < LOOK_AHEAD)
    on_left, on_right = near & (box.right > lane.offset), near & (box.left < lane.offset)
    left = box.right[on_left].min(initial=np.inf) - lane.offset - half
    right = lane.offset - box.left[on_right].max(initial=-np.inf) - half
    met = standing(perception.vehicles) | box.oncoming
    side, gap = jutting_in(perception, lane, met & (on_left | on_right), way)
    to_left = min(left, gap[side > 0.0].min(initial=np.inf)) - TO_VEHICLES
    to_right = min(right, gap[side < 0.0].min(initial=np.inf)) - TO_VEHICLES
    return max(to_right, 0.0), max(to_left, 0.0)
