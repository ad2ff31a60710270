"""Lines of sight from a place to pedestrians; vehicles block them as rectangles, whatever their height."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from analysis.arrays import BoolArray, FloatArray
from analysis.geometry import to_frame
from analysis.recording.tracks import Track

_MARGIN_M = 1e-6


def is_visible(
    eye_x: FloatArray,
    eye_y: FloatArray,
    x: FloatArray,
    y: FloatArray,
    first: int,
    vehicles: Iterable[Track],
) -> BoolArray:
    """Return where no vehicle's rectangle cuts the straight line from the eye to a point.

    Parameters
    ----------
    eye_x, eye_y : FloatArray
        The eye at consecutive samples of the fine grid [m].
    x, y : FloatArray
        The observed point at the same samples [m].
    first : int
        Fine index of the first sample.
    vehicles : Iterable[Track]
        All vehicles that may block the view; each does so only while it is recorded.
    """
    seen = np.ones(len(x), dtype=np.bool_)
    last = first + len(x) - 1
    if len(x) == 0:
        return seen
    low_x, high_x = min(eye_x.min(), x.min()), max(eye_x.max(), x.max())
    low_y, high_y = min(eye_y.min(), y.min()), max(eye_y.max(), y.max())
    there = [one for one in vehicles if one.first <= last and one.first + len(one.x) > first]
    for vehicle in there:
        begin, end = max(first, vehicle.first), min(last, vehicle.last)
        own = slice(begin - vehicle.first, end - vehicle.first + 1)
        half = 0.5 * float(np.hypot(vehicle.length, vehicle.width)) + _MARGIN_M
        there_x, there_y = vehicle.x[own], vehicle.y[own]
        if there_x.max() < low_x - half or there_x.min() > high_x + half:
            continue
        if there_y.max() < low_y - half or there_y.min() > high_y + half:
            continue
        here = slice(begin - first, end - first + 1)
        seen[here] &= ~_cuts(vehicle, own, eye_x[here], eye_y[here], x[here], y[here])
    return seen


def _cuts(
    vehicle: Track, own: slice, eye_x: FloatArray, eye_y: FloatArray, x: FloatArray, y: FloatArray
) -> BoolArray:
    """Return where the segment meets the rectangle: its parts inside the two slabs overlap."""
    heading = vehicle.heading[own]
    from_x, from_y = to_frame(eye_x - vehicle.x[own], eye_y - vehicle.y[own], heading)
    to_x, to_y = to_frame(x - vehicle.x[own], y - vehicle.y[own], heading)
    enter, leave = np.zeros(len(x)), np.ones(len(x))
    for start, end, half in ((from_x, to_x, 0.5 * vehicle.length), (from_y, to_y, 0.5 * vehicle.width)):
        change = end - start
        moves = np.abs(change) > 1e-12
        safe = np.where(moves, change, 1.0)
        one, two = (-half - start) / safe, (half - start) / safe
        outside = ~moves & (np.abs(start) > half)
        enter = np.maximum(enter, np.where(moves, np.minimum(one, two), np.where(outside, 2.0, 0.0)))
        leave = np.minimum(leave, np.where(moves, np.maximum(one, two), 1.0))
    return np.asarray(enter <= leave)
