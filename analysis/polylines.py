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


def distance_from(line: FloatArray, x: float, y: float) -> float:
    """Return the distance of a place from the nearest point of a line [m].

    Examples
    --------
    >>> distance_from(np.array([[0.0, 0.0], [10.0, 0.0]]), 4.0, 3.0)
    3.0
    """
    place, way = np.array([x, y]), np.diff(line, axis=0)
    along = ((place - line[:-1]) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-12)
    nearest = line[:-1] + np.clip(along, 0.0, 1.0)[:, None] * way
    return float(np.hypot(*(place - nearest).T).min())


def crossing_point(
    polyline: FloatArray, line: FloatArray, from_station: float = 0.0
) -> tuple[float, FloatArray, FloatArray] | None:
    """Return where a polyline meets a line: station [m], and both directions; ``None`` if nowhere.

    If they meet more than once, the first meeting at or after ``from_station`` counts, or else the last one.

    Parameters
    ----------
    polyline, line : (n, 2) and (m, 2) [m]
    from_station : distance along the polyline [m]
    """
    start, step = polyline[:-1, None, :], np.diff(polyline, axis=0)[:, None, :]
    other, other_step = line[None, :-1, :], np.diff(line, axis=0)[None, :, :]
    rest = other - start
    determinant = step[..., 0] * other_step[..., 1] - step[..., 1] * other_step[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (rest[..., 0] * other_step[..., 1] - rest[..., 1] * other_step[..., 0]) / determinant
        other_share = (rest[..., 0] * step[..., 1] - rest[..., 1] * step[..., 0]) / determinant
    hits = np.argwhere((share >= 0.0) & (share < 1.0) & (other_share >= 0.0) & (other_share <= 1.0))
    if not len(hits):
        return None
    lengths = np.hypot(step[:, 0, 0], step[:, 0, 1])
    begins = np.cumsum(lengths) - lengths
    stations = begins[hits[:, 0]] + share[tuple(hits.T)] * lengths[hits[:, 0]]
    chosen = int(next(iter(np.flatnonzero(stations >= from_station)), len(hits) - 1))
    first, second = hits[chosen]
    station = float(stations[chosen])
    return station, step[first, 0] / lengths[first], other_step[0, second] / np.hypot(*other_step[0, second])


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
