"""People who stay beside the ego's way: how near its body comes to them, and how fast it may pass.

The body is placed along the way into a lane, with all four corners on the true curve of the road. Pedestrians
who are not expected to enter that way are discs at the places where the ego meets them. Those who walk along
the road where it bends may follow the bend or go straight on. The nearer the body comes to them, the more
slowly the ego passes. Pedestrians who wait at a crossing or stand in the road may set off while the
ego passes, so it must be able to stop before they reach it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.driving.lanes import way_into_lane
from controllers.driving.standing import walking
from controllers.geometry.path_clearance import disc_clearances
from controllers.geometry.plane import people_in_plane, to_plane
from controllers.geometry.swing import farthest_out
from controllers.interface import Body, Perception, RoadAhead

LOOK_AHEAD, LOOK_AHEAD_S = 50.0, 6.0
"""Positions of the rear axle are considered up to this distance, or as far as it gets in this time [m, s]."""
TOUCHING, CREEPING = 0.3, 1.0
"""Pedestrians nearer than this are passed at this speed [m, m/s]."""
NEAR, SLOW = 0.55, 2.5
"""Pedestrians between ``TOUCHING`` and this distance are passed at this speed [m, m/s]."""
FREE, FAST = 0.8, 14.0
"""The passing speed rises to this speed at this distance; beyond it there is no limit [m, m/s]."""
BESIDE_WALKERS = 1.0
"""Walking pedestrians may step aside: nearer than ``NEAR`` they are passed no faster than this [m/s]."""
SETTING_OFF, STOPPING, REACTING = 1.5, 8.0, 0.25
"""Speed of pedestrians who set off from a crossing's end [m/s], deceleration and reaction time with which the
ego stops for them [m/s^2, s]."""
SEEN, FIRST_BRAKING, SLOWEST, SLOW_STOP = 0.1, 11.0, 0.15, 0.5
"""A slow ego stands before its deceleration has built up: once it has seen them set off [s], it loses this
times the square of the time [m/s^3]. Lowest speed past them, and speed up to which this holds [m/s]."""
HASTE = 2.5
"""Pedestrians who stand in the road may set off as fast as they came, but no faster than this [m/s]."""
UNBOUNDED = 100.0
"""This speed stands for no limit [m/s]."""
ASIDE = 2.2
"""Pedestrians farther than this beside the body of a car cannot be near its front, even where it swings out;
the front of a longer vehicle swings out farther [m]."""
STRAIGHT_ON_S, BENDING = 2.5, 0.05
"""For how long people who walk along a bend may go straight on instead, and the change of direction of the
road that counts as a bend [s, rad]."""
LARGEST_SWING = 1.5
"""The front of a car swings out by no more than this; that of a longer vehicle may swing out more [m]."""


class Bystanders(NamedTuple):
    """Distances from the body to each of n pedestrians at k positions of the rear axle."""

    places: FloatArray
    """The k positions along the road, shape (k,) [m]."""
    who: NDArray[np.intp]
    """Index into ``Perception.pedestrians``, shape (n,)."""
    wait: NDArray[np.bool_]
    """True for those who wait to step onto a crossing, shape (n,)."""
    walk: NDArray[np.bool_]
    """True for those who walk, shape (n,)."""
    sets_off: FloatArray
    """Speed at which those who stand in the road may set off; nan for others, shape (n,) [m/s]."""
    guessed: NDArray[np.bool_]
    """True for a second entry of those who may go straight on where the road bends, shape (n,)."""
    clearance: FloatArray
    """Distance from the body to each pedestrian at each position, shape (k, n) [m]."""

    def least(self, count: int) -> FloatArray:
        """Return the least distance to each of ``count`` pedestrians; inf for those not considered [m]."""
        least = np.full(count, np.inf)
        least[self.who[~self.guessed]] = self.clearance[:, ~self.guessed].min(axis=0, initial=np.inf)
        return least

    def speed_limit(self, waited_for: NDArray[np.int64]) -> tuple[FloatArray, FloatArray] | None:
        """Return positions of the rear axle and the speed allowed there, shape (k,); ``None`` for no limit.

        Parameters
        ----------
        waited_for : pedestrians who are not passed, or are passed by other rules, by index
        """
        passed = ~np.isin(self.who, waited_for)
        nearest = self.clearance[:, passed].min(axis=1, initial=np.inf)
        at_crossing = self.clearance[:, passed & self.wait].min(axis=1, initial=np.inf)
        walkers = self.clearance[:, passed & self.walk & ~self.guessed].min(axis=1, initial=np.inf)
        limits = (
            passing_speed(nearest),
            np.where(at_crossing < FREE, speed_to_stop(at_crossing), UNBOUNDED),
            np.where(walkers < NEAR, BESIDE_WALKERS, UNBOUNDED),
        )
        limit = np.minimum.reduce(limits)
        for i in np.flatnonzero(passed & ~np.isnan(self.sets_off)):
            limit = np.minimum(limit, speed_to_stop(self.clearance[:, i], float(self.sets_off[i])))
        return (self.places, limit) if limit.min() < UNBOUNDED else None


def passing_speed(clearance: FloatArray) -> FloatArray:
    """Return how fast pedestrians who stay where they are may be passed at each distance [m/s].

    >>> passing_speed(np.array([0.2, 0.4, 0.6, 0.8])).tolist()
    [1.0, 2.5, 4.8, 100.0]
    """
    rising = SLOW + (FAST - SLOW) * (clearance - NEAR) / (FREE - NEAR)
    bounded = np.where(clearance < TOUCHING, CREEPING, np.maximum(rising, SLOW))
    return np.where(clearance < FREE, bounded, UNBOUNDED).round(9)


def speed_to_stop(clearance: FloatArray, pace: float = SETTING_OFF) -> FloatArray:
    """Return the speed from which the ego stops before a pedestrian at each distance has reached it [m/s].

    >>> speed_to_stop(np.array([0.2, 0.36, 0.6, 0.75])).tolist()
    [0.15, 0.2156, 1.2, 2.0]
    """
    time = clearance / pace
    slow = np.clip(FIRST_BRAKING * np.maximum(time - SEEN, 0.0) ** 2, SLOWEST, SLOW_STOP)
    return np.maximum(STOPPING * (time - REACTING), slow).round(9)


def bystanders(
    perception: Perception,
    offset: float,
    enters: NDArray[np.bool_],
    sets_off: FloatArray,
    arrives: Callable[[FloatArray], FloatArray],
) -> Bystanders | None:
    """Return how near the body comes to the people beside its way into a lane; ``None`` without any.

    Parameters
    ----------
    perception
        What the ego is told.
    offset
        Across coordinate of the lane's centre line [m].
    enters
        Which pedestrians may enter the way. The ego waits for them, or passes them with the margins of their
        class; of them, only those who are already beside the body count here, and those who have stopped
        and may turn back.
    sets_off
        See ``Expectation`` [m/s].
    arrives
        Returns when the rear axle is expected at places along the road, shape (k,) [s].
    """
    ego, people = perception.ego, perception.pedestrians
    counts = ~enters | (people.along < ego.body.front) | ~np.isnan(sets_off)
    if not counts.any():
        return None
    swing = farthest_out(ego.body, perception.road.curvature)
    farthest = max(LOOK_AHEAD, LOOK_AHEAD_S * ego.speed)
    aside = 0.5 * ego.body.width + max(ASIDE, swing + FREE)
    turning = _who_walk_along_a_bend(perception, counts)
    if not len(turning) and way_into_lane.nobody_near(perception, offset, farthest, aside):
        return None
    places, way = way_into_lane.poses(perception, offset, farthest)
    near, at = way_into_lane.people_beside(perception, way, aside)
    near, at = near[counts[near]], at[counts[near]]
    who, there = near, np.broadcast_to(at[:, None], (len(near), len(places), 2))
    if len(turning):
        guessed, straight = _going_straight_on(perception, turning, arrives(places), way, aside)
        who, there = np.concatenate((near, guessed)), np.concatenate((there, straight))
    if not len(who):
        return None
    x, y, heading = way[:, :, None]
    radius = np.broadcast_to(people.radius[who, None], there.shape[:2])
    clearance = disc_clearances(x, y, heading, ego.body, there[..., 0], there[..., 1], radius)[:, 0, :]
    return Bystanders(
        places,
        who,
        people.waiting[who],
        walking(people)[who],
        np.minimum(sets_off[who], HASTE),
        np.arange(len(who)) >= len(near),
        clearance,
    )


def _who_walk_along_a_bend(perception: Perception, counts: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return which of some pedestrians walk beside a bend of the road, by index."""
    people, road = perception.pedestrians, perception.road
    walk = counts & (people.crossing < 0) & walking(people)
    if not (walk.any() and road.curvature.any()):
        return np.empty(0, np.intp)
    then = people.along + STRAIGHT_ON_S * people.along_speed
    (_, now), (_, turned) = (to_plane(road, along, people.across) for along in (people.along, then))
    return (walk & (np.abs(turned - now) > BENDING)).nonzero()[0]


def _going_straight_on(
    perception: Perception, who: NDArray[np.intp], when: FloatArray, way: FloatArray, aside: float
) -> tuple[NDArray[np.intp], FloatArray]:
    """Return who comes near a way by walking straight on, and where they are then.

    Parameters
    ----------
    perception
        What the ego is told.
    who
        Which pedestrians, by index.
    when
        When the ego is at each of the k poses of its way, shape (k,) [s].
    way
        x, y and heading of the rear axle, shape (3, k).
    aside
        How far beside the way to look [m].

    Returns
    -------
    n of the pedestrians, by index, and their places in the plane of the way at those times, (n, k, 2) [m].
    """
    places, velocities = people_in_plane(perception.ego, perception.road, perception.pedestrians)
    until = np.minimum(when, STRAIGHT_ON_S)[:, None]
    there = places[who, None] + until * velocities[who, None]
    apart = np.hypot(there[..., 0] - way[0], there[..., 1] - way[1]).min(axis=1)
    near = apart - perception.pedestrians.radius[who] < aside
    return who[near], there[near]


def swing_out(road: RoadAhead, body: Body, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how far the front swings out to the right and to the left at each place, shape (n,) [m].

    In a bend the rear axle keeps to the centre line, so the front swings outward: by half the square of its
    distance from the rear axle, divided by the bend's radius.
    """
    if not road.curvature.any():
        none = np.zeros(len(along))
        return none, none
    at = ((along - 0.5 * body.front) / road.curvature_step).astype(np.int64)
    bend = road.curvature[np.minimum(np.maximum(at, 0), len(road.curvature) - 1)]
    largest = max(LARGEST_SWING, farthest_out(body, road.curvature))
    swing = np.clip(0.5 * body.front**2 * bend, -largest, largest)
    return np.maximum(swing, 0.0), np.maximum(-swing, 0.0)
