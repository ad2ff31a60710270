"""People who stay beside the way: how near the body comes to them, and how fast it may pass.

The body is laid along the way into a lane, with all four corners on the true curve of the road. Pedestrians
not expected to enter that way are discs where they are. The nearer the body comes to them, the slower it
passes. Those who wait at a crossing or stand in the road may set off while it does, so that it has to stop
before they reach it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.driving.lanes import way_into_lane
from controllers.driving.standing import walking
from controllers.geometry.path_clearance import disc_clearances
from controllers.geometry.swing import farthest_out
from controllers.interface import Body, Perception, RoadAhead

LOOK_AHEAD, LOOK_AHEAD_S = 50.0, 6.0
"""Positions of the rear axle up to this one are looked at, and those it gets to in this time [m, s]."""
TOUCHING, CREEPING = 0.3, 1.0
"""Nearer than this somebody is passed with this speed [m, m/s]."""
NEAR, SLOW = 0.55, 2.5
"""Nearer than this with this one [m, m/s]."""
FREE, FAST = 0.8, 14.0
"""Up to this distance the speed rises, to this one; from there on it does not matter [m, m/s]."""
BESIDE_WALKERS = 1.0
"""Who walks may step aside: nearer than ``NEAR`` they are passed no faster than this [m/s]."""
SETTING_OFF, STOPPING, REACTING, INCHING = 1.5, 8.0, 0.25, 0.5
"""Speed of who sets off from a crossing's end, how the ego stops for them [m/s, m/s^2, s], and how slowly it
passes them at the least [m/s]."""
HASTE = 2.5
"""Who stands in the road may set off as fast as they came, at most with this [m/s]."""
UNBOUNDED = 100.0
"""Stands for no limit [m/s]."""
ASIDE = 2.2
"""Whoever is farther beside the body on the rear axle's way cannot be near the front of a car that swings
out; that of a longer vehicle comes farther out [m]."""
LARGEST_SWING = 1.5
"""Of a car [m]."""


class Bystanders(NamedTuple):
    """How near the body comes to each of n pedestrians at k positions of the rear axle."""

    places: FloatArray
    """Along the road, shape (k,) [m]."""
    who: NDArray[np.intp]
    """Index into ``Perception.pedestrians``, shape (n,)."""
    wait: NDArray[np.bool_]
    """Whose next step is onto a crossing, shape (n,)."""
    walk: NDArray[np.bool_]
    """Who is on the move, shape (n,)."""
    sets_off: FloatArray
    """How fast those who stand in the road may set off; nan for others, shape (n,) [m/s]."""
    clearance: FloatArray
    """Shape (k, n) [m]."""

    def least(self, count: int) -> FloatArray:
        """Return the least distance to each of ``count`` pedestrians; inf for those looked past [m]."""
        least = np.full(count, np.inf)
        least[self.who] = self.clearance.min(axis=0)
        return least

    def speed_limit(self, waited_for: NDArray[np.int64]) -> tuple[FloatArray, FloatArray] | None:
        """Return positions of the rear axle and the speed allowed there, shape (k,); ``None`` for no limit.

        Parameters
        ----------
        waited_for : who is not passed, or is passed otherwise, by index
        """
        passed = ~np.isin(self.who, waited_for)
        nearest = self.clearance[:, passed].min(axis=1, initial=np.inf)
        at_crossing = self.clearance[:, passed & self.wait].min(axis=1, initial=np.inf)
        walkers = self.clearance[:, passed & self.walk].min(axis=1, initial=np.inf)
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
    """Return how fast pedestrians who stay where they are may be passed at a distance [m/s].

    >>> passing_speed(np.array([0.2, 0.4, 0.6, 0.8])).tolist()
    [1.0, 2.5, 4.8, 100.0]
    """
    rising = SLOW + (FAST - SLOW) * (clearance - NEAR) / (FREE - NEAR)
    bounded = np.where(clearance < TOUCHING, CREEPING, np.maximum(rising, SLOW))
    return np.where(clearance < FREE, bounded, UNBOUNDED).round(9)


def speed_to_stop(clearance: FloatArray, pace: float = SETTING_OFF) -> FloatArray:
    """Return from which speed the ego stops before somebody at a distance has walked up to it [m/s].

    >>> speed_to_stop(np.array([0.2, 0.6, 0.75])).tolist()
    [0.5, 1.2, 2.0]
    """
    return np.maximum(STOPPING * (clearance / pace - REACTING), INCHING).round(9)


def bystanders(
    perception: Perception, offset: float, enters: NDArray[np.bool_], sets_off: FloatArray
) -> Bystanders | None:
    """Return how near the body comes to the people beside its way into a lane; ``None`` without any.

    Parameters
    ----------
    perception
        What the ego is told.
    offset
        Across coordinate of the lane's centre line [m].
    enters
        Who of the pedestrians may enter the way. Those are waited for, or passed with the margins of their
        class; of them only who is beside the body already counts, or who has stopped and may turn back.
    sets_off
        See ``Expectation`` [m/s].
    """
    ego, people = perception.ego, perception.pedestrians
    counts = ~enters | (people.along < ego.body.front) | ~np.isnan(sets_off)
    if not counts.any():
        return None
    swing = farthest_out(ego.body, perception.road.curvature)
    farthest = max(LOOK_AHEAD, LOOK_AHEAD_S * ego.speed)
    aside = 0.5 * ego.body.width + max(ASIDE, swing + FREE)
    if way_into_lane.nobody_near(perception, offset, farthest, aside):
        return None
    places, way = way_into_lane.poses(perception, offset, farthest)
    near, at = way_into_lane.people_beside(perception, way, aside)
    who, at = near[counts[near]], at[counts[near]]
    if not len(who):
        return None
    x, y, heading = way[:, :, None]
    still = (
        np.broadcast_to(values[:, None], (len(who), len(places))) for values in (*at.T, people.radius[who])
    )
    clearance = disc_clearances(x, y, heading, ego.body, *still)[:, 0, :]
    walk = walking(people)[who]
    return Bystanders(places, who, people.waiting[who], walk, np.minimum(sets_off[who], HASTE), clearance)


def swing_out(road: RoadAhead, body: Body, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return how far the front juts out to the right and to the left of a bend where it is, shape (n,) [m].

    The rear axle keeps to the centre line, so the front leaves it outward: by half its distance squared
    over the bend's radius.
    """
    if not road.curvature.any():
        none = np.zeros(len(along))
        return none, none
    at = ((along - 0.5 * body.front) / road.curvature_step).astype(np.int64)
    bend = road.curvature[np.minimum(np.maximum(at, 0), len(road.curvature) - 1)]
    largest = max(LARGEST_SWING, farthest_out(body, road.curvature))
    swing = np.clip(0.5 * body.front**2 * bend, -largest, largest)
    return np.maximum(swing, 0.0), np.maximum(-swing, 0.0)
