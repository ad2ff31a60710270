"""Walks of pedestrians over crossings: when each began and ended, and how long it was delayed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from analysis.arrays import BoolArray
from analysis.recording.fine_grid import Grid
from analysis.recording.reading import Columns
from analysis.recording.tracks import Track
from analysis.stretches import stretches
from analysis.thresholds import Thresholds


@dataclass(frozen=True, slots=True)
class CrossingWalk:
    """One walk of a pedestrian over a crossing; samples are those of the track."""

    person: Track
    crossing_id: str
    since: int
    """First sample after an earlier walk over the same crossing; 0 without one."""
    first: int
    last: int
    red: bool
    """Whether the pedestrian stepped on it against a red light."""


def walks(person: Track, rows: Columns) -> Iterator[CrossingWalk]:
    """Yield each uninterrupted walk of a pedestrian on a crossing.

    Parameters
    ----------
    person : Track
    rows : Columns
        The recorded table that the track was made from.
    """
    crossings = rows.texts["crossing_id"]
    on_crossing = rows.texts["phase"].equal("crossing", person.rows)
    red = rows.texts["signal"].equal("red", person.rows)
    codes = crossings.codes[person.rows]
    for code in np.unique(codes[on_crossing]).tolist():
        on_this = on_crossing & (codes == code)
        for first, last in stretches(on_this):
            against = first > 0 and bool(red[first])  # pedestrians who appear on it were not seen entering
            since = after_earlier_walk(on_this, first)
            yield CrossingWalk(person, crossings.names[code], since, first, last, against)


def after_earlier_walk(on_crossing: BoolArray, first: int) -> int:
    """Return the first sample after the last walk that ended before a sample; 0 if there is none."""
    earlier = np.flatnonzero(on_crossing[:first])
    return int(earlier[-1]) + 1 if len(earlier) else 0


def at_crossing(person: Track, rows: Columns, crossing_id: str, *phases: str) -> BoolArray:
    """Return at which samples a pedestrian is in one of the phases of one crossing."""
    inside = np.zeros(len(person.rows), dtype=np.bool_)
    for phase in phases:
        inside |= rows.texts["phase"].equal(phase, person.rows)
    return np.asarray(inside & rows.texts["crossing_id"].equal(crossing_id, person.rows))


def delay(
    person: Track, inside: BoolArray, since: int, last: int, grid: Grid, thresholds: Thresholds
) -> float:
    """Return how much longer the walk took than at the pedestrian's free speed [s].

    Parameters
    ----------
    person : Track
    inside : BoolArray
        Samples of the track at which the pedestrian waits for the crossing or is on it.
    since : int
        First sample that counts; those before it belong to an earlier walk.
    last : int
        Last sample on the crossing.
    grid : Grid
    thresholds : Thresholds

    Returns
    -------
    float
        nan for a pedestrian who is not seen to leave the crossing, or never walks.
    """
    speed = person.speed
    walking = speed > thresholds.pedestrian_standing_speed_mps
    if last + 1 >= len(speed) or not walking.any():
        return float("nan")
    free = float(np.percentile(speed[walking], thresholds.free_walking_percentile))
    time = grid.time[person.first : person.first + last + 2]
    lost = np.maximum(1.0 - speed[: last + 1] / free, 0.0)
    return float((np.diff(time) * lost)[since:][inside[since : last + 1]].sum())
