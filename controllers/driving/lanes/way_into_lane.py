"""The way from the ego's place into the middle of a lane, on the true curve of the road."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import BoolArray, FloatArray
from controllers.driving.lanes.minimum_jerk import minimum_jerk
from controllers.geometry.plane import people_in_plane, to_plane
from controllers.geometry.remembered import remembered
from controllers.interface import Body, EgoState, Pedestrians, Perception, RoadAhead

MOVING_OVER, MOVING_OVER_S = 6.0, 3.0
"""Distance, or time if that takes longer, in which the ego moves over into the lane [m, s]."""
SPACING = 0.5
"""Distance between the places considered [m]."""
WALKING, CLOSING, FORESEEN_S = 0.5, 1.0, 6.0
"""Above this speed, pedestrians who walk along the road are met at another place than where they are now;
least closing speed to them, and longest time over which they are predicted [m/s, m/s, s]."""
WALKING_UP, SOONER_S = 0.2, 1.0
"""Pedestrians who walk faster than this to where their crossing begins are met there, or on the way to it;
they may get there this much sooner than predicted [m/s, s]."""
ROUNDING = 0.1
"""Allowance for the accuracy of the test in :func:`nobody_near` [m]."""


def poses(perception: Perception, offset: float, farthest: float) -> tuple[FloatArray, FloatArray]:
    """Return places along the road, shape (k,) [m], and the rear axle's x, y and heading there, (3, k).

    The plane is that of :func:`controllers.geometry.plane.to_plane`.

    Parameters
    ----------
    perception : what the ego is told
    offset : across coordinate of the lane's centre line [m]
    farthest : how far to look [m]
    """
    ego = perception.ego
    places = np.arange(0.0, farthest + SPACING, SPACING)
    over = max(MOVING_OVER, MOVING_OVER_S * ego.speed)
    across = ego.across + (offset - ego.across) * minimum_jerk(places / over)
    at, heading = to_plane(perception.road, places, across)
    way = np.empty((3, len(places)))
    way[0], way[1] = at[:, 0], at[:, 1]
    way[2, 0] = heading[0] + ego.heading_error
    way[2, 1:] = heading[1:] + np.arctan((across[1:] - across[:-1]) / SPACING)
    return places, way


def along_lane(perception: Perception, offset: float, farthest: float) -> FloatArray:
    """Return x, y and heading of a rear axle in the middle of a lane, (3, k), in the plane of :func:`poses`.

    Parameters
    ----------
    perception, offset, farthest : as for :func:`poses`
    """
    places = np.arange(0.0, farthest + SPACING, SPACING)
    at, heading = to_plane(perception.road, places, np.full(len(places), offset))
    way = np.empty((3, len(places)))
    way[0], way[1], way[2] = at[:, 0], at[:, 1], heading
    return way


def beside_body(way: FloatArray, body: Body, places: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return how far places are beside the body on its way, left positive [m], and whether alongside it.

    Parameters
    ----------
    way : x, y and heading of its rear axle, (3, k)
    body
    places : in the plane of :func:`poses`, (..., 2) [m]

    Returns
    -------
    Both of shape (..., k).
    """
    dx, dy = places[..., :1] - way[0], places[..., 1:] - way[1]
    cosine, sine = np.cos(way[2]), np.sin(way[2])
    ahead, beside = cosine * dx + sine * dy, cosine * dy - sine * dx
    return beside, (ahead < body.front) & (ahead > -body.rear_overhang)


def people_beside(
    perception: Perception, way: FloatArray, aside: float
) -> tuple[NDArray[np.intp], FloatArray]:
    """Return who is near a way, by index, shape (n,), and their places in its plane, (n, 2) [m].

    Pedestrians who walk along the road count at the place where the ego meets them, and so do those who walk
    to where their crossing begins.

    Parameters
    ----------
    perception : what the ego is told
    way : as :func:`poses` returns it, (3, k)
    aside : how far beside the rear axle's way to look [m]
    """
    places = _meeting_places(perception.ego, perception.road, perception.pedestrians)
    apart = np.hypot(places[:, :1] - way[0], places[:, 1:] - way[1]).min(axis=1)
    who = (apart - perception.pedestrians.radius < aside).nonzero()[0]
    return who, places[who]


def nobody_near(perception: Perception, offset: float, farthest: float, aside: float) -> bool:
    """Return whether :func:`people_beside` certainly finds nobody near the way of :func:`poses`.

    No place of the way is farther from the plane's origin than its length plus its largest offset.

    Parameters
    ----------
    perception, offset, farthest : as for :func:`poses`
    aside : as for :func:`people_beside`
    """
    places = _meeting_places(perception.ego, perception.road, perception.pedestrians)
    reach = farthest + SPACING + max(abs(perception.ego.across), abs(offset)) + aside + ROUNDING
    gone = np.hypot(places[:, 0], places[:, 1]) - perception.pedestrians.radius > reach
    return bool(gone.all())


@remembered
def _meeting_places(ego: EgoState, road: RoadAhead, people: Pedestrians) -> FloatArray:
    """Return the places in the plane where the ego meets each pedestrian, shape (n, 2) [m].

    They are computed from the places in the world: in the route frame, pedestrians at a crossing are given in
    the frame of that crossing, which is inaccurate in a bend.
    """
    places, _ = people_in_plane(ego, road, people)
    gap = people.along - ego.body.front
    walk = (people.crossing < 0) & (np.abs(people.along_speed) > WALKING) & (gap > 0.0)
    if walk.any():
        until = np.minimum(gap / np.maximum(ego.speed - people.along_speed, CLOSING), FORESEEN_S)
        there, _ = to_plane(road, people.along + until * people.along_speed, people.across)
        places = np.where(walk[:, None], there, places)
    return places + _walked_up(ego, road, people, gap)


def _walked_up(ego: EgoState, road: RoadAhead, people: Pedestrians, gap: FloatArray) -> FloatArray:
    """Return how far those who walk to where their crossing begins will have come, shape (n, 2) [m].

    They are expected to stop there, which may be beside the lane or in it.

    Parameters
    ----------
    ego, road, people
    gap : distance from the front bumper to each pedestrian, shape (n,) [m]
    """
    come = np.zeros(len(gap))
    for i in np.flatnonzero(people.waiting & (people.crossing >= 0) & (gap > 0.0)):
        crossing, across, speed = road.crossings[people.crossing[i]], people.across[i], people.across_speed[i]
        begins = crossing.begins(across)
        if speed * (begins - across) > 0.0 and abs(speed) > WALKING_UP:
            until = min(gap[i] / max(ego.speed, CLOSING), FORESEEN_S) + SOONER_S
            come[i] = math.copysign(min(abs(begins - across), abs(speed) * until), speed)
    if not come.any():
        return np.zeros((len(gap), 2))
    now, _ = to_plane(road, people.along, people.across)
    then, _ = to_plane(road, people.along, people.across + come)
    return then - now
