"""Post-encroachment times of egos and other vehicles that cross each other's way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.encounters.candidates import STAY_S, VEHICLE_SPACING_M, Places, places_on
from analysis.geometry import rectangle_separation
from analysis.recording.levels import Levels
from analysis.recording.tracks import Grid, Track
from analysis.thresholds import Thresholds

_POSE_SPACING_M = 0.25


@dataclass(frozen=True, slots=True)
class Encroachment:
    """The shortest time between one's body leaving ground and the other's arriving there."""

    pet: float
    """[s]."""
    own: int
    """Samples of both tracks between which it lies."""
    other: int


def encroachments(
    egos: Sequence[Track],
    vehicles: Sequence[Track],
    grid: Grid,
    levels: Levels,
    thresholds: Thresholds,
    largest: float = 0.0,
) -> dict[tuple[int, int], Encroachment]:
    """Return by numbers of ego and vehicle who drove over the same ground, crossing, within the PET limit.

    To the sample; footprints are those of rectangles about 0.25 m apart. ``largest`` is half the diagonal of
    a vehicle that is not among these, but whose places were looked up as these are [m].
    """
    limit = thresholds.severity_pet_slight_s
    reach = max(2.0 * largest, *(float(np.hypot(one.length, one.width)) for one in (*egos, *vehicles)))
    reach += 2.0 * VEHICLE_SPACING_M
    scale = reach / (limit + STAY_S)
    own, other = (places_on(tracks, grid, VEHICLE_SPACING_M, scale) for tracks in (egos, vehicles))
    pairs = scipy.spatial.cKDTree(own.points).sparse_distance_matrix(
        scipy.spatial.cKDTree(other.points), reach, p=np.inf, output_type="ndarray"
    )
    i, j = pairs["i"], pairs["j"]
    headings = [_headings(tracks, some) for tracks, some in ((egos, own), (vehicles, other))]
    across = _crosses(headings[0][i], headings[1][j], thresholds.longitudinal_angle_deg)
    i, j = i[across], j[across]
    key = own.owner[i] * len(vehicles) + other.owner[j]
    found = {}
    order = np.argsort(key, kind="stable")
    for mine in np.split(order, np.flatnonzero(np.diff(key[order])) + 1):
        if len(mine) == 0:
            continue
        at, to = divmod(int(key[mine[0]]), len(vehicles))
        if egos[at].name == vehicles[to].name:
            continue
        stays = _stays(egos[at], own.sample[i[mine]]), _stays(vehicles[to], other.sample[j[mine]])
        one = _encroachment(egos[at], vehicles[to], *stays, grid, levels, thresholds)
        if one is not None:
            found[at, to] = one
    return found


def _headings(tracks: Sequence[Track], places: Places) -> FloatArray:
    at = zip(places.owner.tolist(), places.sample.tolist(), strict=True)
    return np.array([tracks[number].heading[sample] for number, sample in at])


def _crosses(heading: FloatArray, other: FloatArray, angle_deg: float) -> BoolArray:
    turn = np.abs((other - heading + np.pi) % (2.0 * np.pi) - np.pi)
    limit = np.radians(angle_deg)
    return np.asarray((turn > limit) & (turn < np.pi - limit))


def _stays(track: Track, near: IntArray) -> tuple[IntArray, IntArray]:
    """Return first and last sample of each stay within a pose spacing of the path, around some samples."""
    low = np.searchsorted(track.path, track.path[near.min()] - track.length, "left")
    high = np.searchsorted(track.path, track.path[near.max()] + track.length, "right")
    samples = np.arange(low, high)
    new = np.diff(np.floor(track.path[samples] / _POSE_SPACING_M)) > 0.0
    starts = samples[np.concatenate([[True], new])]
    return starts, np.append(starts[1:], high) - 1


def _encroachment(
    ego: Track,
    vehicle: Track,
    own: tuple[IntArray, IntArray],
    other: tuple[IntArray, IntArray],
    grid: Grid,
    levels: Levels,
    thresholds: Thresholds,
) -> Encroachment | None:
    time, there = grid.time[ego.first :], grid.time[vehicle.first :]
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
    return Encroachment(float(gaps[best]), int(a[best]), int(b[best]))
