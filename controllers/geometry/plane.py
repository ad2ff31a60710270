"""The route frame, which bends with the road, laid out in a plane."""

from __future__ import annotations

import math

import numpy as np

from controllers.arrays import FloatArray
from controllers.geometry.remembered import remembered
from controllers.interface import EgoState, Pedestrians, RoadAhead, Vehicles


def to_plane(road: RoadAhead, along: FloatArray, across: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return places (n, 2) of the route frame in the plane [m], and the centre line's heading there [rad].

    The plane's origin and axes are those of the route frame at the rear axle, behind which the road is taken
    as straight.
    """
    line = _laid_out(road.curvature, road.curvature_step)
    if line is None:
        return _pairs(along, across), np.zeros(len(along))
    step, (bent, heading, x, y) = road.curvature_step, line
    at = np.minimum(np.maximum((along / step).astype(np.int64), 0), len(x) - 1)
    beyond = along - at * step
    bend = bent[np.minimum(at, len(bent) - 1)]
    turned = heading[at] + np.where((along > 0.0) & (at < len(x) - 1), beyond * bend, 0.0)
    course = 0.5 * (heading[at] + turned)
    place_x = x[at] + beyond * np.cos(course) - across * np.sin(turned)
    place_y = y[at] + beyond * np.sin(course) + across * np.cos(turned)
    return _pairs(place_x, place_y), turned


def _pairs(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return both as columns, (n, 2); ``np.column_stack`` takes several times as long for a few rows."""
    both = np.empty((len(first), 2))
    both[:, 0], both[:, 1] = first, second
    return both


@remembered
def bends(curvature: FloatArray) -> FloatArray:
    """Return the curvature of each step of the road, the mean of that at both ends, shape (n,) [1/m].

    The perception gives the curvature at places. If each step had the curvature of its beginning, the line
    would turn half a step late, and be half a metre beside the lane after a right-angled turn.
    """
    return 0.5 * (curvature + np.append(curvature[1:], curvature[-1:]))


@remembered
def _laid_out(
    curvature: FloatArray, step: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray] | None:
    """Return the curvature of each step, and the centre line's headings and places at the ends of all steps.

    Return ``None`` if the line is straight.
    """
    if not curvature.any():
        return None
    bent = bends(curvature)
    heading = np.concatenate(([0.0], np.cumsum(bent) * step))
    middle = heading[:-1] + 0.5 * bent * step
    x = np.concatenate(([0.0], np.cumsum(np.cos(middle)) * step))
    y = np.concatenate(([0.0], np.cumsum(np.sin(middle)) * step))
    return bent, heading, x, y


def people_in_plane(ego: EgoState, road: RoadAhead, people: Pedestrians) -> tuple[FloatArray, FloatArray]:
    """Return where pedestrians are in the plane of :func:`to_plane`, and their velocities, (n, 2) each.

    Both are computed from their places in the world, if these are known, because in the route frame
    pedestrians at a crossing are given in the frame of that crossing.
    """
    if not np.isnan(people.position).any():
        origin, turn = _from_world(ego)
        return (people.position - origin) @ turn, people.velocity @ turn
    places, heading = to_plane(road, people.along, people.across)
    ahead, left = np.cos(heading), np.sin(heading)
    along, across = people.along_speed, people.across_speed
    return places, _pairs(along * ahead - across * left, along * left + across * ahead)


def vehicles_in_plane(ego: EgoState, road: RoadAhead, vehicles: Vehicles) -> tuple[FloatArray, FloatArray]:
    """Return front bumpers' centres (n, 2) in the plane of :func:`to_plane` [m], and headings there [rad].

    They are computed from the places in the world, if these are known, because in a bend each part of a body
    beside the road has its own place along it.
    """
    if not np.isnan(vehicles.heading).any():
        origin, turn = _from_world(ego)
        return (vehicles.position - origin) @ turn, vehicles.heading - (ego.heading - ego.heading_error)
    turned = vehicles.heading_error
    middle = vehicles.across + 0.5 * vehicles.length * np.sin(turned)
    places, heading = to_plane(road, vehicles.along, middle)
    return places, heading + turned


def _from_world(ego: EgoState) -> tuple[FloatArray, FloatArray]:
    """Return the plane's origin in the world, and the rotation of row vectors into it."""
    line = ego.heading - ego.heading_error
    cosine, sine = math.cos(line), math.sin(line)
    origin = np.array([ego.x + ego.across * sine, ego.y - ego.across * cosine])
    return origin, np.array([[cosine, -sine], [sine, cosine]])
