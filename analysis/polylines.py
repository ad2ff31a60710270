"""Polylines in the plane, as points of shape (n, 2) [m]."""

from __future__ import annotations

import numpy as np

from analysis.arrays import BoolArray, FloatArray


def arc_lengths(line: FloatArray) -> FloatArray:
    """Return the distances of a line's points along the line [m].

    Examples
    --------
    >>> arc_lengths(np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 6.0]])).tolist()
    [0.0, 5.0, 7.0]
    """
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])


def inside(outline: FloatArray, points: FloatArray) -> BoolArray:
    """Return which points are inside a polygon, where a ray crosses the outline an odd number of times.

    Parameters
    ----------
    outline
        Corners; the first need not be repeated at the end.
    points
        Shape (m, 2).

    Examples
    --------
    >>> inside(np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]), np.array([[0.5, 0.5], [1.5, 1.5]])).tolist()
    [True, False]
    """
    x, y = points[:, :1], points[:, 1:]
    x0, y0 = outline[:, 0], outline[:, 1]
    x1, y1 = np.roll(x0, -1), np.roll(y0, -1)
    spans = (y0 > y) != (y1 > y)
    rise = np.where(spans, y1 - y0, 1.0)
    crossed = spans & (x < x0 + (y - y0) / rise * (x1 - x0))
    return np.asarray(np.count_nonzero(crossed, axis=1) % 2 == 1)
