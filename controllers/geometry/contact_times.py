"""When rectangles and discs touch that move straight on, or straight between samples."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray, IntArray

_CORNERS = np.array([[-1.0], [1.0], [-1.0], [1.0]])


def disc_contact_times(
    rear: float,
    front: float,
    half_width: float,
    x: FloatArray,
    y: FloatArray,
    x_speed: FloatArray,
    y_speed: FloatArray,
    radius: FloatArray,
) -> FloatArray:
    """Return when discs first touch a rectangle [s]; inf for never, 0 for those that touch it already.

    Parameters
    ----------
    rear, front, half_width : the rectangle is [rear, front] × [−half_width, half_width] [m]
    x, y : centres in the rectangle's frame [m]
    x_speed, y_speed : constant velocities relative to the rectangle [m/s]
    radius : [m]

    Notes
    -----
    The rectangle grown by the disc consists of two rectangles and four discs at the corners; the first
    contact with any of them counts.
    """
    if len(x) == 0:
        return np.zeros(0)
    grown = np.stack((radius, np.zeros(len(x))))
    boxes = box_contact_times(rear - grown, front + grown, half_width + grown[::-1], x, y, x_speed, y_speed)
    to_x, to_y = x - np.array([[rear], [rear], [front], [front]]), y - half_width * _CORNERS
    corners = _point_times(to_x, to_y, x_speed, y_speed, radius)
    first: FloatArray = np.minimum(boxes.min(axis=0), corners.min(axis=0))
    return first


def sampled_contact_times(
    rear: float,
    front: float,
    half_width: float,
    times: FloatArray,
    x: FloatArray,
    y: FloatArray,
    radius: FloatArray,
) -> tuple[FloatArray, IntArray]:
    """Return when discs first touch a rectangle [s], inf for never, and the last sample before.

    Parameters
    ----------
    rear, front, half_width : as for :func:`disc_contact_times`
    times : times of the samples, ascending, at least two, shape (K,) [s]
    x, y : centres in the rectangle's frame; they move straight between samples and after the last, (n, K) [m]
    radius : between two samples the larger radius counts, (n, K) [m]

    >>> turns = np.array([[8.0, 8.0, 4.0]]), np.array([[4.0, 2.0, 0.0]])
    >>> sampled_contact_times(0.0, 4.0, 1.0, np.arange(3.0), *turns, np.full((1, 3), 0.5))
    (array([1.875]), array([1]))
    """
    duration = np.diff(times)
    x_speed, y_speed = np.diff(x, axis=1) / duration, np.diff(y, axis=1) / duration
    widest = np.maximum(radius[:, :-1], radius[:, 1:])
    moves = [values.ravel() for values in (x[:, :-1], y[:, :-1], x_speed, y_speed, widest)]
    after = disc_contact_times(rear, front, half_width, *moves).reshape(x_speed.shape)
    until = np.append(duration[:-1], np.inf)
    met = np.where(after <= until, times[:-1] + after, np.inf)
    interval = np.argmin(met, axis=1)
    return met[np.arange(len(met)), interval], interval


def box_contact_times(
    rear: float | FloatArray,
    front: float | FloatArray,
    half_width: float | FloatArray,
    x: FloatArray,
    y: FloatArray,
    x_speed: FloatArray,
    y_speed: FloatArray,
) -> FloatArray:
    """Return when points first lie in a rectangle [s]; inf for never, 0 for those that lie in it already.

    Parameters
    ----------
    rear, front, half_width : as for :func:`disc_contact_times`, one for all points or one for each [m]
    x, y, x_speed, y_speed : as for :func:`disc_contact_times`

    >>> box_contact_times(0.0, 4.0, 1.0, np.array([6.0]), np.zeros(1), np.array([-2.0]), np.zeros(1))
    array([1.])
    """
    enters_x, leaves_x = _between(np.asarray(rear), np.asarray(front), x, x_speed)
    enters_y, leaves_y = _between(-np.asarray(half_width), np.asarray(half_width), y, y_speed)
    enters, leaves = np.maximum(enters_x, enters_y), np.minimum(leaves_x, leaves_y)
    return np.where((enters <= leaves) & (leaves >= 0.0), np.maximum(enters, 0.0), np.inf)


def _between(
    low: FloatArray, high: FloatArray, place: FloatArray, speed: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return when a coordinate enters and leaves an interval [s]."""
    still = np.abs(speed) < 1e-12
    safe = np.where(still, 1.0, speed)
    one, other = (low - place) / safe, (high - place) / safe
    inside = (place >= low) & (place <= high)
    enters = np.where(still, np.where(inside, -np.inf, np.inf), np.minimum(one, other))
    leaves = np.where(still, np.where(inside, np.inf, -np.inf), np.maximum(one, other))
    return enters, leaves


def _point_times(
    x: FloatArray, y: FloatArray, x_speed: FloatArray, y_speed: FloatArray, radius: FloatArray
) -> FloatArray:
    """Return when points first are as near to the origin as their radius; inf for never [s]."""
    squared = x_speed**2 + y_speed**2
    moving = squared > 1e-12
    approach = -(x * x_speed + y * y_speed)
    excess = x**2 + y**2 - radius**2
    root = approach**2 - squared * excess
    time = (approach - np.sqrt(np.maximum(root, 0.0))) / np.where(moving, squared, 1.0)
    meets = moving & (root >= 0.0) & (time >= 0.0)
    return np.where(excess <= 0.0, 0.0, np.where(meets, time, np.inf))
