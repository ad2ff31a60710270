"""Pairs of vehicles and pedestrians that could have met, found in a tree of places and times.

The exact geometry of a pair is needed only if the two came to the same ground within some seconds of each
other, or if the vehicle passed a crossing while the pedestrian waited for it or walked on it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import scipy

from analysis.arrays import FloatArray, IntArray
from analysis.encounters.crossings import Traversal
from analysis.recording.fine_grid import Grid
from analysis.recording.reading import RecordedRun
from analysis.recording.tracks import Track, Way
from analysis.stretches import stretches

VEHICLE_SPACING_M, PERSON_SPACING_M = 1.0, 0.5
"""Distance along a track between the places that are looked up [m]."""
STAY_S = 4.0
"""A place is looked up at least this often, even while a road user stands [s]."""


class Meeting(NamedTuple):
    """Where a vehicle and a pedestrian came near each other: first and last sample of each track."""

    vehicle: tuple[int, int]
    person: tuple[int, int]


class Places(NamedTuple):
    """Places looked up on many tracks."""

    points: FloatArray
    """Place and scaled time, shape (n, 3) [m]."""
    heading: FloatArray
    owner: IntArray
    sample: IntArray


def met(
    vehicles: Sequence[Track],
    persons: Sequence[Track],
    grid: Grid,
    within_s: float,
    largest: tuple[float, float] = (0.0, 0.0),
) -> dict[tuple[int, int], Meeting]:
    """Return the pairs that came to the same ground within ``within_s``, by numbers of vehicle and person.

    Parameters
    ----------
    vehicles, persons : Sequence
    grid : Grid
    within_s : float
        Pairs with more time between them did not meet [s].
    largest : tuple
        Half the diagonal of the largest vehicle and half the width of the widest person of the whole
        recording, if these tracks are a part of it: all parts are then looked up alike [m].
    """
    if not vehicles or not persons:
        return {}
    reach = max(largest[0], *(0.5 * float(np.hypot(one.length, one.width)) for one in vehicles))
    reach += max(largest[1], *(0.5 * one.width for one in persons)) + VEHICLE_SPACING_M + PERSON_SPACING_M
    scale = reach / (within_s + STAY_S)
    own = places_on(vehicles, grid, VEHICLE_SPACING_M, scale)
    other = places_on(persons, grid, PERSON_SPACING_M, scale)
    pairs = scipy.spatial.cKDTree(own.points).sparse_distance_matrix(
        scipy.spatial.cKDTree(other.points), reach, p=np.inf, output_type="ndarray"
    )
    i, j = pairs["i"], pairs["j"]
    if not len(i):
        return {}
    key = own.owner[i] * len(persons) + other.owner[j]
    order = np.argsort(key, kind="stable")
    key, i, j = key[order], own.sample[i[order]], other.sample[j[order]]
    starts = np.flatnonzero(np.concatenate([[True], np.diff(key) > 0]))
    low, high = np.minimum.reduceat, np.maximum.reduceat
    spans = zip(low(i, starts), high(i, starts), low(j, starts), high(j, starts), strict=True)
    return {
        divmod(int(pair), len(persons)): Meeting((int(a), int(b)), (int(c), int(d)))
        for pair, (a, b, c, d) in zip(key[starts], spans, strict=True)
    }


def places_on(
    tracks: Sequence[Track | Way],
    grid: Grid,
    spacing: float,
    scale: float,
    within: tuple[float, float] = (-np.inf, np.inf),
) -> Places:
    """Return where tracks were.

    Parameters
    ----------
    tracks : Sequence
        At least one track.
    grid : Grid
    spacing : float
        Approximate distance between places [m].
    scale : float
        Factor by which times are multiplied [m/s].
    within : tuple
        Range of scaled times in which places are returned [m].
    """
    begin, end = min(int(one.fine[0]) for one in tracks), max(int(one.fine[-1]) for one in tracks)
    stays = np.floor(grid.time[begin : end + 1] / STAY_S)
    turns = np.flatnonzero(np.diff(stays) != 0.0) + 1 + begin
    found = []
    for number, track in enumerate(tracks):
        own = track.fine
        moved = np.append(True, np.diff(np.floor(track.path / spacing)) != 0.0)
        since, until = np.searchsorted(turns, own[[0, -1]], "right")
        fine = np.union1d(own[moved], turns[since:until])
        time = scale * grid.time[fine]
        chosen = (time >= within[0]) & (time <= within[1])
        at = np.searchsorted(own, fine[chosen], "right") - 1
        points = np.column_stack((track.x[at], track.y[at], time[chosen]))
        found.append((points, track.heading[at], np.full(len(at), number), at))
    return Places(*(np.concatenate(one) for one in zip(*found, strict=True)))


def waited(
    vehicles: Sequence[Track],
    persons: Sequence[Track],
    passed: Mapping[tuple[str, str], Sequence[Traversal]],
    run: RecordedRun,
    grid: Grid,
    within_s: float,
) -> set[tuple[int, int]]:
    """Return the pairs whose vehicle passed a crossing while the person was on it or waited for it.

    Pairs are given by numbers, as in `met`.

    Parameters
    ----------
    vehicles, persons : Sequence
    passed : Mapping
        Passages of each vehicle over each crossing, by names of vehicle and crossing.
    run : RecordedRun
    grid : Grid
    within_s : float
        Passages up to this much earlier or later count as well [s].
    """
    number = {id(track): index for index, track in enumerate(vehicles)}
    by_crossing: dict[str, list[tuple[int, float, float]]] = {}
    for (_, crossing), passages in passed.items():
        for one in passages:
            time = grid.time[one.track.first : one.track.last + 1]
            stay = number[id(one.track)], float(time[one.visit.first]), float(time[one.visit.last])
            by_crossing.setdefault(crossing, []).append(stay)
    table = {crossing: np.array(stays) for crossing, stays in by_crossing.items()}
    texts = run.neighbours.texts["crossing_id"]
    found: set[tuple[int, int]] = set()
    for index, person in enumerate(persons):
        codes = texts.codes[person.rows]
        time = grid.time[person.first : person.last + 1]
        for code in np.unique(codes[codes >= 0]).tolist():
            stays = table.get(texts.names[code])
            if stays is None:
                continue
            for first, last in stretches(codes == code):
                there = (stays[:, 1] <= time[last] + within_s) & (stays[:, 2] >= time[first] - within_s)
                found |= {(int(vehicle), index) for vehicle in stays[there, 0]}
    return found
