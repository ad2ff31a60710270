"""How near a car comes to rectangles such as the bodies of other vehicles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.interface import Body

_CORNERS = np.array([(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)])


class Boxes(NamedTuple):
    """Rectangles in a plane, n of them; shape (n,) each."""

    x: FloatArray
    """Coordinate of the middle [m]; shape (K, n) if they move."""
    y: FloatArray
    heading: FloatArray
    """[rad]; shape (K, n) if they turn."""
    length: FloatArray
    """[m]"""
    width: FloatArray


def corners(front: FloatArray, heading: FloatArray, length: FloatArray, width: FloatArray) -> FloatArray:
    """Return the corners of rectangles, front left first and on to the right, shape (n, 4, 2) [m].

    Parameters
    ----------
    front : middles of their fronts, shape (n, 2) [m]
    heading, length, width : shape (n,) [rad, m]
    """
    forward = np.column_stack((np.cos(heading), np.sin(heading)))
    leftward = np.column_stack((-forward[:, 1], forward[:, 0]))
    return np.stack(
        [
            front - back * length[:, None] * forward + half * width[:, None] * leftward
            for back, half in ((0.0, 0.5), (0.0, -0.5), (1.0, -0.5), (1.0, 0.5))
        ],
        axis=1,
    )


def box_clearances(x: FloatArray, y: FloatArray, heading: FloatArray, body: Body, boxes: Boxes) -> FloatArray:
    """Return the distances between a rectangle and others, 0 where they overlap, shape (K, m, n) [m].

    The least distance between convex shapes that do not overlap is that from a corner of one to the other.

    Parameters
    ----------
    x, y, heading : poses of the rear axle at K instants on m paths, shape (K, m) [m, rad]
    body : the rectangle
    boxes : the other rectangles

    >>> place, zero = np.zeros((1, 1)), np.zeros(1)
    >>> ahead = Boxes(zero + 7.55, zero, zero, zero + 4.0, zero + 2.0)
    >>> box_clearances(place, place, place, Body(), ahead).round(3).tolist()
    [[[2.0]]]
    """
    half = 0.5 * np.array([body.length, body.width])
    halves = 0.5 * np.column_stack((boxes.length, boxes.width))
    own, others = _axes(heading), _axes(boxes.heading)
    if others.ndim == 4:
        others = others[:, None]
    place = np.stack((x, y), axis=-1)
    middle = place + (body.front - half[0]) * own[..., 0, :]
    centre = np.stack((boxes.x, boxes.y), axis=-1)
    if centre.ndim == 3:
        centre = centre[:, None]
    between = centre - middle[:, :, None, :]  # (K, m, n, 2)
    # Corners of the others along and across the body, and its own along and across each of the others.
    theirs = between[..., None, :] + (_CORNERS * halves[:, None, :]) @ others
    mine = (_CORNERS * half) @ own
    seen = theirs @ np.swapaxes(own, -1, -2)[:, :, None]
    seen_by = (mine[:, :, None] - between[..., None, :]) @ np.swapaxes(others, -1, -2)
    nearest, parted = _beyond(seen, half)
    nearest_to_them, parted_for_them = _beyond(seen_by, halves)
    return np.where(parted | parted_for_them, np.minimum(nearest, nearest_to_them), 0.0)


def _axes(heading: FloatArray) -> FloatArray:
    """Return the unit vectors ahead and to the left, shape (..., 2, 2)."""
    cosine, sine = np.cos(heading), np.sin(heading)
    return np.stack((np.stack((cosine, sine), axis=-1), np.stack((-sine, cosine), axis=-1)), axis=-2)


def _beyond(corners: FloatArray, half: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return how far the nearest of four corners (..., 4, 2) is outside a box, and whether a side parts them.

    The box has its middle at the origin and its sides along the axes; ``half`` are half its sides, (..., 2).
    """
    outside = np.maximum(np.abs(corners) - half[..., None, :], 0.0)
    nearest = _of_four(np.minimum, np.hypot(outside[..., 0], outside[..., 1]), axis=-1)
    low, high = _of_four(np.minimum, corners, axis=-2), _of_four(np.maximum, corners, axis=-2)
    parted = (low > half) | (high < -half)
    return nearest, parted[..., 0] | parted[..., 1]


def _of_four(chosen: np.ufunc, values: FloatArray, axis: int) -> FloatArray:
    """Return the same as ``chosen.reduce`` along an axis of length 4, several times as fast."""
    first, second, third, fourth = np.moveaxis(values, axis, 0)
    return np.asarray(chosen(chosen(first, second), chosen(third, fourth)))
