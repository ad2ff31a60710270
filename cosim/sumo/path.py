"""A smooth curve along a lane, and the conversion between world coordinates and its frame."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from itertools import accumulate

import numpy as np
import scipy

from analysis.polylines import arc_lengths
from cosim.arrays import FloatArray, IntArray
from cosim.sumo import corners

SPACING = 0.5
"""Largest distance between samples [m]."""
SMOOTHING = 5
"""Number of samples averaged, twice: a corner of SUMO's polyline becomes a bend of about 4 m; a bend of 6 m
radius is cut by less than 0.1 m."""
SEGMENT_COLUMNS = 12
_NOTHING = (np.zeros(0), np.zeros(0), np.zeros(0))
SAME_PLACE, ANOTHER = 6.0, 15.0
"""Samples no further apart than the first distance, but further than the second along the path, are two
passages of one place. The first is a vehicle's length, because one that waits across a lane blocks it with
its rear [m]."""
COMES_BACK = 0.5 * math.pi
"""A path that turns by less than this never comes to a place again [rad]."""
BEHIND = 2.0
"""A passage that an ego has already driven counts as this many times as far away as one to come."""
WALK = 20
"""Number of segments searched near a guess before the whole path is searched."""
ASKED_AGAIN = 64
"""Number of sets of points whose projections are remembered."""


class Path:
    """A polyline made smooth, with arc length, heading and curvature.

    ``stations`` are arc lengths of the polyline as given; ``along`` is the arc length of the smooth curve.
    The two differ because the curve cuts corners.

    Parameters
    ----------
    polyline : (n, 2), no two neighbouring points equal [m]
    origin : station of the first point [m]
    knots : station of each point, counted from the first; by default its arc length. Given for a polyline
        that was changed while its stations were kept [m]
    """

    def __init__(self, polyline: FloatArray, origin: float = 0.0, knots: FloatArray | None = None) -> None:
        knots = arc_lengths(polyline) if knots is None else knots
        grid = evenly(knots[-1])
        samples = np.column_stack([np.interp(grid, knots, polyline[:, axis]) for axis in (0, 1)])
        self._draw(samples, grid + origin)

    @classmethod
    def rounded(cls, polyline: FloatArray, origin: float = 0.0, knots: FloatArray | None = None) -> Path:
        """Return the path along a polyline whose corners are made round (:mod:`cosim.sumo.corners`)."""
        points, knots = corners.rounded(polyline, arc_lengths(polyline) if knots is None else knots)
        return cls(points, origin, knots)

    @classmethod
    def through(cls, samples: FloatArray, stations: FloatArray) -> Path:
        """Return the path along points about `SPACING` apart with the given stations.

        Parameters
        ----------
        samples : (n, 2) [m]
        stations : (n,), increasing [m]
        """
        path = cls.__new__(cls)
        path._draw(samples, stations)
        return path

    def _draw(self, samples: FloatArray, stations: FloatArray) -> None:
        self.samples = samples
        """Points on the polyline from which the curve is made, (n, 2) [m]."""
        self.stations = stations
        """Station of each sample [m]."""
        self.points = _smoothed(_smoothed(samples))
        """Points of the curve, one for each sample, (n, 2) [m]."""
        chords = np.diff(self.points, axis=0)
        lengths = np.hypot(*chords.T)
        origin = float(stations[0])
        cut = np.concatenate([[0.0], np.cumsum(lengths)])
        # `along` agrees with the station at the curve's origin: station 0 is where the lane begins.
        self.along = cut - float(np.interp(0.0, stations, cut)) if origin < 0.0 else cut + origin
        direction = np.unwrap(np.arctan2(chords[:, 1], chords[:, 0]))
        self.heading = np.concatenate([direction[:1], 0.5 * (direction[1:] + direction[:-1]), direction[-1:]])
        self.curvature = _smoothed(np.gradient(self.heading, self.along)[:, None])[:, 0]
        tangents = np.column_stack([np.cos(self.heading), np.sin(self.heading)])
        self._segments = np.column_stack(
            [
                self.points[:-1],
                chords,
                tangents[:-1],
                np.diff(tangents, axis=0),
                self.along[:-1],
                lengths,
                self.heading[:-1],
                np.diff(self.heading),
            ]
        )
        self._tree = scipy.spatial.cKDTree(self.points)
        self._known: dict[bytes, tuple[FloatArray, FloatArray]] = {}

    def station_along(self, station: float) -> float:
        """Return the arc length on the smooth curve [m] of a station of the polyline."""
        if station > self.stations[-1]:
            return float(self.along[-1] + station - self.stations[-1])
        return float(np.interp(station, self.stations, self.along))

    def project(
        self, points: FloatArray, near: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return arc length, offset to the left [m] and the curve's heading [rad] of each point.

        The curve is straight beyond its ends.

        Parameters
        ----------
        points : (n, 2) [m]
        near : arc length for each point; where the curve comes to the same place again, the passage
            nearest to this arc length counts, or with ``None`` the passage nearest to the point [m]
        """
        if not len(points):
            return _NOTHING
        last = len(self.points) - 2
        samples = self.nearest_samples(points)
        if near is not None and self.passages:
            samples = self.passage_nearest(points, samples, near)
        return _projected(points, np.minimum(samples, last), last, self.segments)

    def project_again(self, points: FloatArray, near: float) -> tuple[FloatArray, FloatArray]:
        """Return arc length and offset to the left [m] of points that are queried again at every step.

        Parameters
        ----------
        points : (n, 2) [m]
        near : arc length on the path; see `project_all` [m]
        """
        if self.passages:
            return project_all([self], points, [len(points)], [near])[:2]
        key = points.tobytes()
        found = self._known.get(key)
        if found is None:
            if len(self._known) >= ASKED_AGAIN:
                self._known.clear()
            found = self._known[key] = self.project(points)[:2]
        return found

    def at(self, along: FloatArray, across: FloatArray) -> FloatArray:
        """Return the world coordinates (n, 2) [m] of points in the curve's frame; inverse of `project`."""
        if len(along) == 1:
            return np.array([self._place(float(along[0]), float(across[0]))])
        segment = np.searchsorted(self.along, along, side="right") - 1
        rows = self.segments(np.minimum(np.maximum(segment, 0), len(self.points) - 2))
        px, py, cx, cy, tx, ty, turn_x, turn_y, start, length, _, _ = rows.T
        share = (along - start) / length
        inner = np.minimum(np.maximum(share, 0.0), 1.0)
        tangent_x, tangent_y = tx + inner * turn_x, ty + inner * turn_y
        side = across / np.hypot(tangent_x, tangent_y)
        places = np.empty((len(share), 2))
        places[:, 0] = px + share * cx - side * tangent_y
        places[:, 1] = py + share * cy + side * tangent_x
        return places

    def _place(self, along: float, across: float) -> tuple[float, float]:
        """Return what `at` returns for one point, but faster."""
        segment = int(self.along.searchsorted(along, side="right")) - 1
        row = self._segments[min(max(segment, 0), len(self.points) - 2)]
        px, py, cx, cy, tx, ty, turn_x, turn_y, start, length, _, _ = row.tolist()
        share = (along - start) / length
        inner = min(max(share, 0.0), 1.0)
        tangent_x, tangent_y = tx + inner * turn_x, ty + inner * turn_y
        # NumPy's function, as in `at`: Python's own may differ in the last digit.
        side = across / float(np.hypot(tangent_x, tangent_y))
        return px + share * cx - side * tangent_y, py + share * cy + side * tangent_x

    def place_near(self, x: float, y: float, guess: float) -> tuple[float, float]:
        """Return arc length and offset to the left [m] of one point not far from a guessed arc length.

        The result is that of `project`, but found faster.
        """
        segment = int(self.along.searchsorted(guess)) - 1
        last = len(self.points) - 2
        segment = min(max(segment, 0), last)
        share = across = 0.0
        for _ in range(WALK):
            px, py, cx, cy, tx, ty, turn_x, turn_y, along, length, _, _ = self._segments[segment].tolist()
            east, north = x - px, y - py
            constant = east * tx + north * ty
            linear = east * turn_x + north * turn_y - cx * tx - cy * ty
            quadratic = -(cx * turn_x + cy * turn_y)
            root = math.sqrt(max(linear * linear - 4.0 * quadratic * constant, 0.0))
            share = 2.0 * constant / max(root - linear, 1e-3 * length)
            inner = min(max(share, 0.0), 1.0)
            if 0 < segment < last:
                share = inner
            tangent_x, tangent_y = tx + inner * turn_x, ty + inner * turn_y
            across = (north - share * cy) * tangent_x - (east - share * cx) * tangent_y
            across /= math.hypot(tangent_x, tangent_y)
            if share >= 1.0 and segment < last:
                segment += 1
            elif share <= 0.0 and segment > 0 and constant < 0.0:
                segment -= 1
            else:
                return along + share * length, across
        found, offset, _ = self.project(np.array([[x, y]]))
        return float(found[0]), float(offset[0])

    def heading_at(self, along: float) -> float:
        """Return the curve's heading [rad]."""
        return interpolated(along, self.along, self.heading)

    def nearest_samples(self, points: FloatArray) -> IntArray:
        """Return the index of the sample nearest to each point (n, 2)."""
        return np.asarray(self._tree.query(points)[1], dtype=np.int64)

    @cached_property
    def passages(self) -> Mapping[int, IntArray]:
        """Samples of other passages of the same place, by sample; empty for a path that never comes back."""
        if np.ptp(self.heading) < COMES_BACK:
            return {}
        one, other = self._tree.query_pairs(SAME_PLACE, output_type="ndarray").T
        again = np.abs(self.along[one] - self.along[other]) > ANOTHER
        first, second = np.append(one[again], other[again]), np.append(other[again], one[again])
        order = np.argsort(first, kind="stable")
        numbers, starts = np.unique(first[order], return_index=True)
        return dict(zip(numbers.tolist(), np.split(second[order], starts)[1:], strict=True))

    def passage_nearest(
        self, points: FloatArray, samples: IntArray, along: FloatArray, behind: float = 1.0
    ) -> IntArray:
        """Return the samples nearest to points, on the passages that are nearest to given arc lengths.

        Parameters
        ----------
        points : (n, 2) [m]
        samples : samples nearest to the points on any passage, shape (n,)
        along : arc lengths, shape (n,) [m]
        behind : a passage before its arc length counts as this many times as far away
        """
        found = samples.copy()
        for i, (sample, wanted) in enumerate(zip(samples.tolist(), along.tolist(), strict=True)):
            others = self.passages.get(sample)
            if others is None:
                continue
            known = np.append(sample, others)
            away = self.along[known] - wanted
            nearest = np.argmin(np.where(away < 0.0, -behind * away, away))
            passage = known[np.abs(away - away[nearest]) < ANOTHER]
            found[i] = passage[np.argmin(np.hypot(*(self.points[passage] - points[i]).T))]
        return found

    def segments(self, numbers: IntArray, out: FloatArray | None = None) -> FloatArray:
        """Return one row for each of these segments, with what `project` needs."""
        return self._segments.take(numbers, axis=0, out=out, mode="clip")


def project_all(
    paths: Sequence[Path], points: FloatArray, counts: Sequence[int], near: Sequence[float] | None = None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return what `Path.project` returns, for points of several paths.

    Parameters
    ----------
    paths
    points : (n, 2), those of the first path first [m]
    counts : how many points belong to each path
    near : arc length on each path; where the path comes to the same place again, the passage nearest to this
        arc length counts, and passages to come are preferred to driven ones; with ``None``, the passage
        nearest to the point counts [m]
    """
    if not len(points):
        return _NOTHING
    ends = list(accumulate(counts))
    parts = [
        (path, slice(end - count, end)) for path, count, end in zip(paths, counts, ends, strict=True) if count
    ]
    last = np.repeat([len(path.points) - 2 for path in paths], counts)
    segment = np.concatenate([path.nearest_samples(points[part]) for path, part in parts])
    if near is not None:
        places = [along for along, count in zip(near, counts, strict=True) if count]
        for (path, part), along in zip(parts, places, strict=True):
            if path.passages:
                there = np.full(part.stop - part.start, along)
                segment[part] = path.passage_nearest(points[part], segment[part], there, BEHIND)
    segment = np.minimum(segment, last)

    def rows_of(numbers: IntArray) -> FloatArray:
        rows = np.empty((len(numbers), SEGMENT_COLUMNS))
        for path, part in parts:
            path.segments(numbers[part], rows[part])
        return rows

    return _projected(points, segment, last, rows_of)


def _projected(
    points: FloatArray,
    segment: IntArray,
    last: int | IntArray,
    rows_of: Callable[[IntArray], FloatArray],
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return arc length, offset and heading of points, each of which is near a known segment.

    Parameters
    ----------
    points : (n, 2) [m]
    segment : index of the segment that begins at the sample nearest to each point
    last : index of the last segment of each point's path
    rows_of : returns the rows of segments, one for each point
    """
    x, y = points[:, 0], points[:, 1]
    rows = rows_of(segment)
    # A point may also belong to the segment that ends at its nearest sample.
    before = (x - rows[:, 0]) * rows[:, 4] + (y - rows[:, 1]) * rows[:, 5] < 0.0
    if before.any():
        segment = np.maximum(segment - before, 0)
        rows = rows_of(segment)
    px, py, cx, cy, tx, ty, turn_x, turn_y, along, length, heading, bend = rows.T
    # The tangent turns evenly along a segment: a quadratic is zero where the offset is perpendicular to it.
    east, north = x - px, y - py
    constant = east * tx + north * ty
    linear = east * turn_x + north * turn_y - cx * tx - cy * ty
    quadratic = -(cx * turn_x + cy * turn_y)
    root = np.sqrt(np.maximum(linear * linear - 4.0 * quadratic * constant, 0.0))
    share = 2.0 * constant / np.maximum(root - linear, 1e-3 * length)
    inner = np.minimum(np.maximum(share, 0.0), 1.0)
    # The first and the last segment are straight, and go on beyond the curve's ends.
    share = np.where(
        segment == 0, np.minimum(share, 1.0), np.where(segment == last, np.maximum(share, 0.0), inner)
    )
    tangent_x, tangent_y = tx + inner * turn_x, ty + inner * turn_y
    across = (north - share * cy) * tangent_x - (east - share * cx) * tangent_y
    across /= np.sqrt(tangent_x * tangent_x + tangent_y * tangent_y)
    return along + share * length, across, heading + inner * bend


def interpolated(at: float, places: FloatArray, values: FloatArray) -> float:
    """Return what ``np.interp`` returns for one number, to the last bit but faster.

    >>> interpolated(1.5, np.array([0.0, 1.0, 2.0]), np.array([0.0, 10.0, 30.0]))
    20.0
    """
    number = int(places.searchsorted(at, "right")) - 1
    if number < 0:
        return float(values[0])
    if number >= len(places) - 1:
        return float(values[-1])
    low, below, above = float(places[number]), float(values[number]), float(values[number + 1])
    if low == at:
        return below
    slope = (above - below) / (float(places[number + 1]) - low)
    return slope * (at - low) + below


def evenly(length: float) -> FloatArray:
    """Return distances from 0 to a length [m], at most `SPACING` apart."""
    return np.linspace(0.0, length, max(int(np.ceil(length / SPACING)), 2) + 1)


def _smoothed(values: FloatArray) -> FloatArray:
    """Return the running mean over each sample and its neighbours; the ends are continued straight."""
    half = SMOOTHING // 2
    steps = np.arange(half, 0, -1)[:, None]
    before = values[:1] - steps * (values[1:2] - values[:1])
    after = values[-1:] + steps[::-1] * (values[-1:] - values[-2:-1])
    sums = np.cumsum(np.concatenate([np.zeros_like(values[:1]), before, values, after]), axis=0)
    return np.asarray((sums[SMOOTHING:] - sums[:-SMOOTHING]) / SMOOTHING)
