"""Post-encroachment times of egos and other vehicles that cross each other's path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.encounters.candidates import STAY_S, VEHICLE_SPACING_M, places_on
from analysis.geometry import rectangle_separation, turned
from analysis.recording.fine_grid import Grid
from analysis.recording.levels import Levels
from analysis.recording.tracks import Way
from analysis.thresholds import Thresholds

_POSE_SPACING_M = 0.25


@dataclass(frozen=True, slots=True)
class Encroachment:
    """The shortest time between one body leaving a piece of ground and the other arriving there."""

    pet: float
    """[s]."""
    own: int
    """Fine index at which the ego came onto that ground; ``other`` is that of the vehicle."""
    other: int
    speed: float
    """Speed of the vehicle at ``other`` [m/s]."""


def encroachments(
    egos: Sequence[Way],
    vehicles: Mapping[int, Way],
    grid: Grid,
    levels: Levels,
    thresholds: Thresholds,
    largest: float = 0.0,
) -> dict[tuple[int, int], Encroachment]:
    """Return the encroachments of crossing pairs within the PET limit, by numbers of ego and vehicle.

    Times are exact to the sample; the footprints are rectangles about 0.25 m apart. ``largest`` is half the
    diagonal of the largest vehicle of the whole recording, if these are a part of it: all parts are then
    looked up alike [m].
    """
    if not egos or not vehicles:
        return {}
    numbers, ways = list(vehicles), list(vehicles.values())
    limit = thresholds.severity_pet_slight_s
    reach = max(2.0 * largest, *(float(np.hypot(one.length, one.width)) for one in (*egos, *ways)))
    reach += 2.0 * VEHICLE_SPACING_M
    scale = reach / (limit + STAY_S)
    own = places_on(egos, grid, VEHICLE_SPACING_M, scale)
    low, high = own.points[:, 2].min() - 2.0 * reach, own.points[:, 2].max() + 2.0 * reach
    other = places_on(ways, grid, VEHICLE_SPACING_M, scale, (low, high))
    pairs = scipy.spatial.cKDTree(own.points).sparse_distance_matrix(
        scipy.spatial.cKDTree(other.points), reach, p=np.inf, output_type="ndarray"
    )
    i, j = pairs["i"], pairs["j"]
    across = _crosses(own.heading[i], other.heading[j], thresholds.longitudinal_angle_deg)
    i, j = i[across], j[across]
    key = own.owner[i] * len(ways) + other.owner[j]
    found = {}
    order = np.argsort(key, kind="stable")
    for mine in np.split(order, np.flatnonzero(np.diff(key[order])) + 1):
        if len(mine) == 0:
            continue
        at, to = divmod(int(key[mine[0]]), len(ways))
        if egos[at].name == ways[to].name:
            continue
        stays = _stays(egos[at], own.sample[i[mine]]), _stays(ways[to], other.sample[j[mine]])
        one = _encroachment(egos[at], ways[to], *stays, grid, levels, thresholds)
        if one is not None:
            found[at, numbers[to]] = one
    return found


def _crosses(heading: FloatArray, other: FloatArray, angle_deg: float) -> BoolArray:
    turn = turned(heading, other)
    limit = np.radians(angle_deg)
    return np.asarray((turn > limit) & (turn < np.pi - limit))


def _stays(track: Way, near: IntArray) -> tuple[IntArray, IntArray]:
    """Return first and last sample of each stay within one pose spacing of the path, around given samples."""
    low = np.searchsorted(track.path, track.path[near.min()] - track.length, "left")
    high = np.searchsorted(track.path, track.path[near.max()] + track.length, "right")
    samples = np.arange(low, high)
    new = np.diff(np.floor(track.path[samples] / _POSE_SPACING_M)) > 0.0
    starts = samples[np.concatenate([[True], new])]
    return starts, np.append(starts[1:], high) - 1


def _encroachment(
    ego: Way,
    vehicle: Way,
    own: tuple[IntArray, IntArray],
    other: tuple[IntArray, IntArray],
    grid: Grid,
    levels: Levels,
    thresholds: Thresholds,
) -> Encroachment | None:
    time, there = grid.time[ego.fine], grid.time[vehicle.fine]
    later = there[other[0]][None, :] - time[own[1]][:, None]
    sooner = time[own[0]][:, None] - there[other[1]][None, :]
    between = np.maximum(later, sooner)
    i, j = np.nonzero((between >= 0.0) & (between <= thresholds.severity_pet_slight_s))
    gaps, a, b = between[i, j], own[0][i], other[0][j]
    kept = _crosses(ego.heading[a], vehicle.heading[b], thresholds.longitudinal_angle_deg)
    kept &= ~levels.apart[ego.level[a], vehicle.level[b]]
    gaps, a, b = gaps[kept], a[kept], b[kept]
    bodies = [
        (one.x[at], one.y[at], one.heading[at], one.length, one.width) for one, at in ((ego, a), (vehicle, b))
    ]
    hit = np.flatnonzero(rectangle_separation(*bodies[0], *bodies[1])[0] <= 0.0)
    if len(hit) == 0:
        return None
    best = int(hit[np.argmin(gaps[hit])])
    first, second = int(a[best]), int(b[best])
    speed = float(vehicle.speed[second])
    return Encroachment(float(gaps[best]), int(ego.fine[first]), int(vehicle.fine[second]), speed)
