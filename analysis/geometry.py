"""Exact geometry of an oriented rectangle and a disc in straight relative motion, for arrays.

Positions are those of the disc's centre in the frame of the rectangle: origin at its centre, x along
its length. ``half_length`` and ``half_width`` are the rectangle's half extents, ``radius`` the disc's.
All arguments broadcast against each other.
"""

from __future__ import annotations

import numpy as np

from analysis.arrays import FloatArray, IntArray

Number = float | FloatArray


_BLOCK = 1_000_000
_SLACK = 1e-6
_STILL = 1e-12
"""Speeds below this count as zero, since nothing is reached within a relevant time [m/s]."""


def turned(heading: FloatArray, other: FloatArray) -> FloatArray:
    """Return the angles between headings, from 0 to pi [rad].

    >>> turned(np.array([0.1, 3.0]), np.array([-0.1, -3.0])).round(3).tolist()
    [0.2, 0.283]
    """
    return np.asarray(np.abs((other - heading + np.pi) % (2.0 * np.pi) - np.pi))


def to_frame(x: Number, y: Number, heading: Number) -> tuple[FloatArray, FloatArray]:
    """Return the vector (x, y) in axes rotated by ``heading`` [rad]."""
    cos, sin = np.cos(heading), np.sin(heading)
    return np.asarray(x * cos + y * sin), np.asarray(y * cos - x * sin)


def signed_distance(x: Number, y: Number, half_length: Number, half_width: Number) -> FloatArray:
    """Return the distance of a point from the rectangle's outline, negative inside [m]."""
    dx, dy = np.abs(x) - half_length, np.abs(y) - half_width
    outside = np.hypot(np.maximum(dx, 0.0), np.maximum(dy, 0.0))
    return np.asarray(outside + np.minimum(np.maximum(dx, dy), 0.0))


def pairs_within(
    x: FloatArray, y: FloatArray, other_x: FloatArray, other_y: FloatArray, reach: float
) -> tuple[IntArray, IntArray]:
    """Return index pairs of all positions within a distance, sorted by the first, and perhaps a few beyond.

    Examples
    --------
    >>> first, second = pairs_within(*np.array([[0.0, 9.0], [0.0, 0.0]]), *np.array([[3.0], [4.0]]), 5.0)
    >>> first.tolist(), second.tolist()
    ([0], [0])
    """
    if not len(x):
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    # Relative to the middle, so that the squares below stay small and exact enough.
    middle_x, middle_y = float(x.mean()), float(y.mean())
    x, y, other_x, other_y = x - middle_x, y - middle_y, other_x - middle_x, other_y - middle_y
    own = np.stack([-2.0 * x, -2.0 * y, x * x + y * y, np.ones_like(x)], axis=1)
    other = np.stack([other_x, other_y, np.ones_like(other_x), other_x * other_x + other_y * other_y])
    most = reach * reach + _SLACK
    block = max(1, _BLOCK // max(1, len(other_x)))
    count = len(other_x)
    found = [
        np.flatnonzero(own[at : at + block] @ other <= most) + at * count for at in range(0, len(own), block)
    ]
    first, second = np.divmod(np.concatenate(found), count)
    return first, second


def clearance(x: Number, y: Number, half_length: Number, half_width: Number, radius: Number) -> FloatArray:
    """Return the distance between rectangle and disc, 0 if they overlap [m].

    Examples
    --------
    >>> float(clearance(20.0, 0.0, 2.25, 0.9, 0.3))
    17.45
    """
    dx = np.maximum(np.abs(x) - half_length, 0.0)
    dy = np.maximum(np.abs(y) - half_width, 0.0)
    return np.asarray(np.maximum(np.hypot(dx, dy) - radius, 0.0))


def time_to_contact(
    x: Number,
    y: Number,
    x_speed: Number,
    y_speed: Number,
    half_length: Number,
    half_width: Number,
    radius: Number,
) -> FloatArray:
    """Return the smallest t >= 0 at which rectangle and disc touch at constant relative velocity [s].

    The time is 0 if they overlap already, and inf if they never touch; touching exactly counts as contact.

    Notes
    -----
    The disc's centre touches the rectangle grown by the radius: the union of two rectangles
    (a + r) x b and a x (b + r) and four discs of radius r at the corners. The earliest entry into any
    of the five is the answer; for a corner with offset f, with A = |u|^2, B = f.u, C = |f|^2 - r^2, the
    root is C / (-B + sqrt(B^2 - A C)), which does not cancel.
    """
    x, y, u, w, a, b, r = (
        np.asarray(value, dtype=np.float64)
        for value in np.broadcast_arrays(x, y, x_speed, y_speed, half_length, half_width, radius)
    )
    u, w = _settled(u), _settled(w)
    best = np.minimum(_box_entry(x, y, u, w, a + r, b), _box_entry(x, y, u, w, a, b + r))
    squared = u * u + w * w
    for corner_x, corner_y in ((a, b), (a, -b), (-a, b), (-a, -b)):
        best = np.minimum(best, _disc_entry(x - corner_x, y - corner_y, u, w, squared, r))
    touching = np.hypot(np.maximum(np.abs(x) - a, 0.0), np.maximum(np.abs(y) - b, 0.0)) <= r
    return np.where(touching, 0.0, best)


def _settled(speed: FloatArray) -> FloatArray:
    return np.where(np.abs(speed) < _STILL, 0.0, speed)


def _box_entry(
    x: FloatArray, y: FloatArray, u: FloatArray, w: FloatArray, a: FloatArray, b: FloatArray
) -> FloatArray:
    """Return when a moving point enters a box around the origin; inf for never."""
    enter = np.zeros_like(x)
    leave = np.full_like(x, np.inf)
    for position, speed, half in ((x, u, a), (y, w, b)):
        moving = speed != 0.0
        divisor = np.where(moving, speed, 1.0)
        near = (-np.copysign(half, divisor) - position) / divisor
        far = (np.copysign(half, divisor) - position) / divisor
        missed = ~moving & (np.abs(position) > half)
        enter = np.maximum(enter, np.where(moving, near, np.where(missed, np.inf, 0.0)))
        leave = np.minimum(leave, np.where(moving, far, np.inf))
    return np.where(enter <= leave, enter, np.inf)


def _disc_entry(
    fx: FloatArray, fy: FloatArray, u: FloatArray, w: FloatArray, squared: FloatArray, r: FloatArray
) -> FloatArray:
    """Return when a point at offset f from a disc's centre enters it; inf for never or inside."""
    b = fx * u + fy * w
    c = fx * fx + fy * fy - r * r
    # B^2 - A C without cancellation: A r^2 - (f x u)^2.
    cross = fx * w - fy * u
    discriminant = squared * r * r - cross * cross
    hits = (discriminant >= 0.0) & (b < 0.0) & (c >= 0.0)
    divisor = np.where(hits, -b + np.sqrt(np.maximum(discriminant, 0.0)), 1.0)
    return np.where(hits, c / divisor, np.inf)


def closest_approach(
    x: Number,
    y: Number,
    x_speed: Number,
    y_speed: Number,
    half_length: Number,
    half_width: Number,
    radius: Number,
    horizon: Number = np.inf,
) -> tuple[FloatArray, FloatArray]:
    """Return the smallest clearance [m] and its first time [s] within ``horizon`` at constant velocity.

    Without relative motion, or if the two already separate, these are the present clearance and 0.

    Notes
    -----
    The clearance of a point from a convex box is a convex function of time. Its minimum is at t = 0, at
    the horizon, at the first touch, or where the point passes a corner at right angles, or where it
    enters a slab beside the box; the smallest over these candidates is exact.
    """
    x, y, u, w, a, b, r, end = (
        np.asarray(value, dtype=np.float64)
        for value in np.broadcast_arrays(x, y, x_speed, y_speed, half_length, half_width, radius, horizon)
    )
    u, w = _settled(u), _settled(w)
    squared = u * u + w * w
    moves = squared > 0.0
    divisor = np.where(moves, squared, 1.0)
    best = clearance(x, y, a, b, r)
    when = np.zeros_like(best)
    touch = time_to_contact(x, y, u, w, a, b, r)
    candidates = [np.where(np.isfinite(end), end, 0.0)]
    for corner_x, corner_y in ((a, b), (a, -b), (-a, b), (-a, -b)):
        candidates.append(np.where(moves, -((x - corner_x) * u + (y - corner_y) * w) / divisor, 0.0))
    for position, speed, half in ((x, u, a), (y, w, b)):
        safe = np.where(speed != 0.0, speed, 1.0)
        for side in (-half, half):
            candidates.append(np.where(speed != 0.0, (side - position) / safe, 0.0))
    for candidate in candidates:
        t = np.clip(candidate, 0.0, end)
        there = clearance(x + u * t, y + w * t, a, b, r)
        closer = (there < best - 1e-15) | ((there <= best) & (t < when))
        best = np.where(closer, there, best)
        when = np.where(closer, t, when)
    hits = np.isfinite(touch) & (touch <= end)
    return np.where(hits, 0.0, best), np.where(hits, touch, when)


def rectangle_separation(
    x: FloatArray,
    y: FloatArray,
    heading: FloatArray,
    length: Number,
    width: Number,
    other_x: FloatArray,
    other_y: FloatArray,
    other_heading: FloatArray,
    other_length: Number,
    other_width: Number,
) -> tuple[FloatArray, FloatArray]:
    """Return the largest gap over the four axes of two rectangles [m], and the direction of its axis [rad].

    The gap is negative exactly if the rectangles overlap (separating-axis theorem); a positive gap is a lower
    bound of their distance. Positions are centres.
    """
    dx, dy = other_x - x, other_y - y
    turn = other_heading - heading
    cos, sin = np.abs(np.cos(turn)), np.abs(np.sin(turn))
    gaps, axes = [], []
    for axis, own, foreign in (
        (heading, length, other_length * cos + other_width * sin),
        (heading + np.pi / 2, width, other_length * sin + other_width * cos),
        (other_heading, other_length, length * cos + width * sin),
        (other_heading + np.pi / 2, other_width, length * sin + width * cos),
    ):
        gaps.append(np.abs(dx * np.cos(axis) + dy * np.sin(axis)) - 0.5 * (own + foreign))
        axes.append(axis)
    stacked = np.stack(gaps)
    choice = np.argmax(stacked, axis=0)
    pick = choice[None]
    return (
        np.take_along_axis(stacked, pick, axis=0)[0],
        np.take_along_axis(np.stack(axes), pick, axis=0)[0],
    )


def gap_along(
    axis: FloatArray,
    x: FloatArray,
    y: FloatArray,
    heading: FloatArray,
    length: Number,
    width: Number,
    other_x: FloatArray,
    other_y: FloatArray,
    other_heading: FloatArray,
    other_length: Number,
    other_width: Number,
) -> FloatArray:
    """Return the gap between the projections of two rectangles on an axis of direction ``axis`` [m]."""
    extent = length * np.abs(np.cos(heading - axis)) + width * np.abs(np.sin(heading - axis))
    other = other_length * np.abs(np.cos(other_heading - axis)) + other_width * np.abs(
        np.sin(other_heading - axis)
    )
    distance = np.abs((other_x - x) * np.cos(axis) + (other_y - y) * np.sin(axis))
    return np.asarray(distance - 0.5 * (extent + other))
