"""A smooth curve along a lane, and the way between the world and its frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

FloatArray = NDArray[np.float64]

SPACING = 0.5
"""Distance between samples [m]."""
SMOOTHING = 5
"""Samples averaged, twice: a corner of SUMO's polyline becomes a bend of about 4 m; a bend of 6 m radius is
cut by less than 0.1 m."""
REFINEMENTS = 3
"""Newton steps of a projection."""


class Path:
    """A polyline made smooth, with arc length, heading and curvature.

    ``stations`` are arc lengths of the polyline as given; ``along`` is the arc length of the smooth curve.
    The two differ by the corners that were cut.

    Parameters
    ----------
    polyline : (n, 2), no two neighbouring points equal [m]
    origin : station of the first point [m]
    """

    def __init__(self, polyline: FloatArray, origin: float = 0.0) -> None:
        steps = np.hypot(*np.diff(polyline, axis=0).T)
        knots = np.concatenate([[0.0], np.cumsum(steps)])
        count = max(int(np.ceil(knots[-1] / SPACING)), 2) + 1
        grid = np.linspace(0.0, knots[-1], count)
        raw = np.column_stack([np.interp(grid, knots, polyline[:, axis]) for axis in (0, 1)])
        self.points = _smoothed(_smoothed(raw))
        chords = np.diff(self.points, axis=0)
        lengths = np.hypot(*chords.T)
        self._stations = grid + origin
        cut = np.concatenate([[0.0], np.cumsum(lengths)])
        # `along` agrees with the station at the curve's origin: station 0 is where the lane begins.
        self.along = cut - float(np.interp(0.0, self._stations, cut)) if origin < 0.0 else cut + origin
        direction = np.unwrap(np.arctan2(chords[:, 1], chords[:, 0]))
        self.heading = np.concatenate([direction[:1], 0.5 * (direction[1:] + direction[:-1]), direction[-1:]])
        self.curvature = _smoothed(np.gradient(self.heading, self.along)[:, None])[:, 0]
        self._segments = np.column_stack([self.points[:-1], chords, lengths])
        self._tree = cKDTree(self.points)

    def station_along(self, station: float) -> float:
        """Return the arc length on the smooth curve [m] of a station of the polyline."""
        if station > self._stations[-1]:
            return float(self.along[-1] + station - self._stations[-1])
        return float(np.interp(station, self._stations, self.along))

    def project(self, points: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return arc length, offset to the left [m] and the curve's heading [rad] of each point.

        The curve is straight beyond its ends.

        Parameters
        ----------
        points : (n, 2) [m]
        """
        if not len(points):
            empty = np.zeros(0)
            return empty, empty, empty
        x, y = points[:, 0], points[:, 1]
        last = len(self.points) - 2
        segment = np.minimum(self._tree.query(points)[1], last)
        px, py, cx, cy, length = self._segments[segment].T
        share = ((x - px) * cx + (y - py) * cy) / (length * length)
        # A point nearer to a sample may belong to the segment before it.
        before = (share < 0.0) & (segment > 0)
        if before.any():
            segment = np.where(before, segment - 1, segment)
            px, py, cx, cy, length = self._segments[segment].T
            share = ((x - px) * cx + (y - py) * cy) / (length * length)
        low = np.where(segment == 0, -np.inf, 0.0)
        high = np.where(segment == last, np.inf, 1.0)
        start = self.heading[segment]
        bend = self.heading[segment + 1] - start
        share = np.minimum(np.maximum(share, low), high)
        for _ in range(REFINEMENTS):
            # The normal turns along the segment; the foot is where the rest has no part along the tangent.
            heading = start + np.minimum(np.maximum(share, 0.0), 1.0) * bend
            cosine, sine = np.cos(heading), np.sin(heading)
            east, north = x - px - share * cx, y - py - share * cy
            across = north * cosine - east * sine
            step = (east * cosine + north * sine) / np.maximum(length - across * bend, 0.2 * length)
            share = np.minimum(np.maximum(share + step, low), high)
        heading = start + np.minimum(np.maximum(share, 0.0), 1.0) * bend
        across = (y - py - share * cy) * np.cos(heading) - (x - px - share * cx) * np.sin(heading)
        return self.along[segment] + share * length, across, heading

    def at(self, along: FloatArray, across: FloatArray) -> FloatArray:
        """Return the world coordinates (n, 2) [m] of points in the curve's frame; inverse of `project`."""
        segment = np.clip(np.searchsorted(self.along, along, side="right") - 1, 0, len(self.points) - 2)
        share = (along - self.along[segment]) / (self.along[segment + 1] - self.along[segment])
        x, y, chord_x, chord_y, _ = self._segments[segment].T
        start = self.heading[segment]
        heading = start + np.clip(share, 0.0, 1.0) * (self.heading[segment + 1] - start)
        return np.column_stack(
            [
                x + share * chord_x - across * np.sin(heading),
                y + share * chord_y + across * np.cos(heading),
            ]
        )

    def heading_at(self, along: float) -> float:
        """Return the curve's heading [rad]."""
        return float(np.interp(along, self.along, self.heading))


def _smoothed(values: FloatArray) -> FloatArray:
    """Return the running mean over the sample and its neighbours; the ends are continued straight."""
    half = SMOOTHING // 2
    steps = np.arange(half, 0, -1)[:, None]
    before = values[:1] - steps * (values[1:2] - values[:1])
    after = values[-1:] + steps[::-1] * (values[-1:] - values[-2:-1])
    sums = np.cumsum(np.concatenate([np.zeros_like(values[:1]), before, values, after]), axis=0)
    return np.asarray((sums[SMOOTHING:] - sums[:-SMOOTHING]) / SMOOTHING)


def crossing_point(polyline: FloatArray, line: FloatArray) -> tuple[float, FloatArray, FloatArray] | None:
    """Return where a polyline first meets a line: station [m], and both directions; ``None`` if nowhere.

    Parameters
    ----------
    polyline, line : (n, 2) and (m, 2) [m]
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
    first, second = hits[0]
    lengths = np.hypot(step[:, 0, 0], step[:, 0, 1])
    station = float(lengths[:first].sum() + share[first, second] * lengths[first])
    return station, step[first, 0] / lengths[first], other_step[0, second] / np.hypot(*other_step[0, second])
