"""How near a car on a given path comes to discs, to other vehicles and to the edges of its road."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.geometry.footprints import footprints
from controllers.interface import Body, Vehicles


def disc_clearances(
    along: FloatArray,
    across: FloatArray,
    heading: FloatArray,
    body: Body,
    disc_along: FloatArray,
    disc_across: FloatArray,
    radius: FloatArray,
) -> FloatArray:
    """Return the distances between a rectangle and discs, shape (K, m, n) [m].

    Inside the rectangle, the distance of a disc's centre from the nearest side counts as negative: whoever
    leans on a car and comes farther under it comes nearer.

    Parameters
    ----------
    along, across, heading : poses of the rear axle at K instants on m paths, shape (K, m) [m, rad]
    body : the rectangle
    disc_along, disc_across, radius : discs at the same instants, shape (n, K) [m]

    >>> place = np.zeros((1, 1))
    >>> disc = np.array([[5.55]]), np.array([[0.0]]), np.array([[0.5]])
    >>> disc_clearances(place, place, place, Body(), *disc).round(3).tolist()
    [[[1.5]]]
    """
    x = disc_along.T[:, None, :] - along[:, :, None]
    y = disc_across.T[:, None, :] - across[:, :, None]
    cosine, sine = np.cos(heading)[:, :, None], np.sin(heading)[:, :, None]
    ahead, beside = cosine * x + sine * y, cosine * y - sine * x
    middle = body.front - 0.5 * body.length
    beyond = np.abs(ahead - middle) - 0.5 * body.length
    aside = np.abs(beside) - 0.5 * body.width
    outside = np.hypot(np.maximum(beyond, 0.0), np.maximum(aside, 0.0))
    inside = np.minimum(np.maximum(beyond, aside), 0.0)
    return np.asarray(outside + inside - radius.T[:, None, :])


def beyond_edges(
    across: FloatArray, heading: FloatArray, body: Body, right_edge: float, left_edge: float
) -> FloatArray:
    """Return how far the body juts out beyond the road's edges; negative inside, shape of ``across`` [m].

    >>> beyond_edges(np.array([0.0, 1.0]), np.zeros(2), Body(), -1.75, 1.75).round(2).tolist()
    [-0.85, 0.15]
    """
    middle = across + (body.front - 0.5 * body.length) * np.sin(heading)
    half = 0.5 * (body.length * np.abs(np.sin(heading)) + body.width * np.abs(np.cos(heading)))
    return np.asarray(np.maximum(middle + half - left_edge, right_edge - middle + half))


def vehicles_met(
    times: FloatArray,
    along: FloatArray,
    across: FloatArray,
    heading: FloatArray,
    body: Body,
    vehicles: Vehicles,
    side: float,
) -> NDArray[np.bool_]:
    """Return which of n vehicles, at constant velocities, the car meets on each of m paths, shape (m, n).

    All bodies count as boxes along the road.

    Parameters
    ----------
    times : shape (K,) [s]
    along, across, heading : as for :func:`disc_clearances`
    body : body of the car
    vehicles : the other vehicles
    side : distance to be kept beside them [m]
    """
    box = footprints(vehicles)
    half = 0.5 * (body.length * np.abs(np.cos(heading)) + body.width * np.abs(np.sin(heading)))
    half_wide = 0.5 * (body.length * np.abs(np.sin(heading)) + body.width * np.abs(np.cos(heading)))
    offset = body.front - 0.5 * body.length
    middle = (along + offset * np.cos(heading))[:, :, None]
    sideways = (across + offset * np.sin(heading))[:, :, None]
    gone, drifted = np.outer(times, vehicles.along_speed), np.outer(times, vehicles.across_speed)
    apart_along = np.maximum((box.rear + gone)[:, None, :] - middle, middle - (box.front + gone)[:, None, :])
    apart_across = np.maximum(
        (box.right + drifted)[:, None, :] - sideways, sideways - (box.left + drifted)[:, None, :]
    )
    met = (apart_along < half[:, :, None]) & (apart_across < half_wide[:, :, None] + side)
    return np.asarray(met.any(axis=0))
