"""The area that an ego's body and a pedestrian's disc both sweep, and when each was in it.

The *ego is in the area* while its rectangle touches what the disc sweeps over its whole path; the
*pedestrian is in the area* while the disc touches what the rectangle sweeps. For straight paths that
cross at right angles this is the strip of the body's width times the strip of the disc's diameter.
Instants are interpolated between samples of at most 0.05 s.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.encounters.lines import Lines
from analysis.geometry import pairs_within, signed_distance
from analysis.polylines import arc_lengths
from analysis.recording.fine_grid import Grid
from analysis.recording.tracks import Track
from analysis.stretches import stretches

_POINT_SPACING_M = 0.05
_POSE_SPACING_M = 0.1
_SAME_PLACE = 1e-6


@dataclass(frozen=True, slots=True)
class Visit:
    """One stay inside an area."""

    enter: float
    """Time of entry; beginning of the track if it begins inside [s]."""
    leave: float
    """Time of exit; nan if the track ends inside [s]."""
    first: int
    """First sample of the track inside; ``last`` is the last one."""
    last: int

    def later(self, samples: int) -> Visit:
        """Return the stay as counted on a track that begins this many samples earlier."""
        return replace(self, first=self.first + samples, last=self.last + samples)


@dataclass(frozen=True, slots=True)
class ConflictArea:
    """One conflict area and the stays of both in it [s, m]."""

    ego: Visit
    person: Visit
    x: float
    y: float

    @property
    def time_between(self) -> float:
        """Time from when the first one leaves until the second one enters; negative when interleaved [s]."""
        gaps = [self.person.enter - self.ego.leave, self.ego.enter - self.person.leave]
        known = [gap for gap in gaps if gap == gap]
        return max(known) if known else -np.inf


def conflict_areas(ego: Track, person: Track, grid: Grid, pairing_s: float) -> list[ConflictArea]:
    """Return the conflict areas of two tracks, at most one for each stay of the ego.

    Where a pedestrian enters the same area more than once, the stay nearest in time counts.
    """
    radius = 0.5 * person.width
    reach = 0.5 * float(np.hypot(ego.length, ego.width)) + radius
    margin = reach + 2.0 * (ego.largest_step + person.largest_step)
    # An ego that stands for hours is at one place, however many samples its track has.
    x, y = ego.places
    near = _near_box(x, y, person.x, person.y, margin)
    if not near.any():
        return []
    near_person = np.flatnonzero(_near_box(person.x, person.y, x[near], y[near], margin))
    if len(near_person) == 0:
        return []
    near_ego = np.flatnonzero(_near_box(ego.x, ego.y, person.x, person.y, margin))
    # The samples of standing users repeat; only those that moved are computed.
    moved, again = _moved(ego, near_ego)
    poses = near_ego[moved]
    line = _thinned(person, near_person, _POINT_SPACING_M)
    ego_depth = _depth(ego, poses, person, line, radius + ego.largest_shift, by_pose=True)
    ego_visits = _visits(_time(ego, grid), near_ego, ego_depth[again] - radius)
    if not ego_visits:
        return []
    moved, again = _moved(person, near_person)
    points = near_person[moved]
    swept = _thinned(ego, near_ego, _POSE_SPACING_M)
    person_depth = _depth(ego, swept, person, points, radius + person.largest_step, by_pose=False)
    person_visits = _visits(_time(person, grid), near_person, person_depth[again] - radius)
    areas = []
    for own in ego_visits:
        candidates = [
            _area(own, other, person)
            for other in person_visits
            if (len(ego_visits) == 1 and len(person_visits) == 1) or _share_ground(ego, own, person, other)
        ]
        candidates = [area for area in candidates if area.time_between <= pairing_s]
        if candidates:
            areas.append(min(candidates, key=lambda area: max(area.time_between, 0.0)))
    return areas


def reach(ego: Track) -> float:
    """Return how far the ego's rectangle reaches at most from its sampled centres, also between them [m]."""
    return 0.5 * float(np.hypot(ego.length, ego.width)) + 2.0 * ego.largest_step


def stays_on_lines(ego: Track, grid: Grid, lines: Lines) -> Iterator[tuple[int, Visit]]:
    """Yield each stay of the ego's rectangle on the ground of a line: line by line, in the order of time."""
    line, sample = lines.near(ego, reach(ego))
    if len(line) == 0:
        return
    new = np.concatenate([[True], line[1:] != line[:-1]])
    moved, again = _moved(ego, sample, new)
    depth = lines.distances(ego, line[moved], sample[moved], ego.largest_shift)[again]
    outside = depth - lines.half_widths[line]
    starts = np.flatnonzero(new)
    met = np.minimum.reduceat(outside, starts) <= 0.0
    ends = np.append(starts[1:], len(line))
    time = _time(ego, grid)
    for start, end in zip(starts[met].tolist(), ends[met].tolist(), strict=True):
        for visit in _visits(time, sample[start:end], outside[start:end]):
            yield int(line[start]), visit


def _area(own: Visit, other: Visit, person: Track) -> ConflictArea:
    inside = slice(other.first, other.last + 1)
    return ConflictArea(own, other, float(person.x[inside].mean()), float(person.y[inside].mean()))


def _time(track: Track, grid: Grid) -> FloatArray:
    return grid.time[track.first : track.last + 1]


def _near_box(
    x: FloatArray, y: FloatArray, other_x: FloatArray, other_y: FloatArray, margin: float
) -> BoolArray:
    """Return which places are near the bounding box of other places."""
    near: BoolArray = (x >= other_x.min() - margin) & (x <= other_x.max() + margin)
    near &= (y >= other_y.min() - margin) & (y <= other_y.max() + margin)
    return near


def _moved(track: Track, index: IntArray, new: BoolArray | None = None) -> tuple[IntArray, IntArray]:
    """Return the samples that differ from the one before, and which of them each sample equals.

    A sample differs if the track is elsewhere than at the sample before, or if it is marked as ``new``."""
    x, y, heading = track.x[index], track.y[index], np.nan_to_num(track.heading[index])
    change = np.hypot(np.diff(x), np.diff(y)) + np.abs(np.diff(heading))
    moved = np.concatenate([[True], change > _SAME_PLACE])
    if new is not None:
        moved |= new
    return np.flatnonzero(moved), np.asarray(np.cumsum(moved) - 1)


def _thinned(track: Track, index: IntArray, spacing: float) -> IntArray:
    """Return the samples that are about ``spacing`` apart along the path, first and last included."""
    x, y = track.x[index], track.y[index]
    path = arc_lengths(np.column_stack([x, y]))
    keep = np.concatenate([[True], np.diff(np.floor(path / spacing)) > 0.0])
    keep[-1] = True
    return np.asarray(index[keep])


def _depth(
    ego: Track, poses: IntArray, person: Track, points: IntArray, wanted: float, by_pose: bool
) -> FloatArray:
    return _smallest_distance(ego, poses, person.x[points], person.y[points], by_pose, wanted)


def _smallest_distance(
    ego: Track, poses: IntArray, x: FloatArray, y: FloatArray, by_pose: bool, wanted: float
) -> FloatArray:
    """Return for each pose (or each point) the smallest signed distance to any point (or pose).

    Distances above ``wanted`` may be given too large, up to infinity: the distance from the rectangle's
    centre alone rules out most pairs.
    """
    half_length, half_width = 0.5 * ego.length, 0.5 * ego.width
    reach = float(np.hypot(half_length, half_width)) + wanted + _SAME_PLACE
    pose, point = pairs_within(ego.x[poses], ego.y[poses], x, y, reach)
    smallest = np.full(len(poses) if by_pose else len(x), np.inf)
    if len(pose) == 0:
        return smallest
    heading = ego.heading[poses]
    cos, sin = np.cos(heading)[pose], np.sin(heading)[pose]
    dx, dy = x[point] - ego.x[poses][pose], y[point] - ego.y[poses][pose]
    distance = signed_distance(dx * cos + dy * sin, dy * cos - dx * sin, half_length, half_width)
    if by_pose:
        starts = np.flatnonzero(np.concatenate([[True], pose[1:] != pose[:-1]]))
        smallest[pose[starts]] = np.minimum.reduceat(distance, starts)
    else:
        np.minimum.at(smallest, point, distance)
    return smallest


def _visits(time: FloatArray, samples: IntArray, outside: FloatArray) -> list[Visit]:
    """Return the stays where ``outside`` <= 0; it is given at ``samples`` and positive at all others."""
    full = np.full(len(time), np.inf)
    full[samples] = outside
    inside: BoolArray = full <= 0.0
    visits = []
    for first, last in stretches(inside):
        enter = float(time[0]) if first == 0 else _zero(time, full, first - 1)
        leave = float("nan") if last == len(time) - 1 else _zero(time, full, last)
        visits.append(Visit(enter, leave, first, last))
    return visits


def _zero(time: FloatArray, values: FloatArray, before: int) -> float:
    """Return where the values pass through 0 between a sample and the next."""
    a, b = float(values[before]), float(values[before + 1])
    if not np.isfinite(a):
        return float(time[before + 1])
    if not np.isfinite(b):
        return float(time[before])
    return float(time[before] + (time[before + 1] - time[before]) * a / (a - b))


def _share_ground(ego: Track, own: Visit, person: Track, other: Visit) -> bool:
    poses = _thinned(ego, np.arange(own.first, own.last + 1), _POSE_SPACING_M)
    points = _thinned(person, np.arange(other.first, other.last + 1), _POINT_SPACING_M)
    radius = 0.5 * person.width
    return bool(_depth(ego, poses, person, points, radius, by_pose=True).min() <= radius)
