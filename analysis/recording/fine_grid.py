"""The fine time grid: recorded instants are refined by an integer factor.

Samples are at most ``substep_s`` apart. An object that is missing from the recording for an instant, or that
jumps, continues as a new track.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from analysis.arrays import FloatArray, IntArray
from analysis.geometry import turned
from analysis.recording.reading import Columns, RecordedRun
from analysis.thresholds import Thresholds

_JUMP_M = 2.0
_JUMP_RAD, _TIGHTEST_M = 1.0, 2.0
"""In a step, vehicles turn by this angle plus 1.5 times what they turn at this radius, at most [rad, m]."""


@dataclass(frozen=True, slots=True)
class Grid:
    """The fine time grid of a run."""

    factor: int
    """Fine samples per recorded step."""
    time: FloatArray
    """Time of each sample; sample ``k * factor`` is recorded instant k [s]."""


def samples_per_step(run: RecordedRun, thresholds: Thresholds) -> int:
    """Return how many samples of the fine grid there are in a recorded step."""
    return max(1, math.ceil(run.step_s / thresholds.substep_s - 1e-9))


def make_grid(run: RecordedRun, thresholds: Thresholds) -> Grid:
    """Return the fine grid of a run."""
    factor = samples_per_step(run, thresholds)
    return Grid(factor, refine(run.times, factor))


def by_name(rows: Columns, key: str, chosen: IntArray | None = None) -> Iterator[tuple[str, IntArray]]:
    """Yield each name in alphabetical order with its rows, ascending in time."""
    texts = rows.texts[key]
    index = np.arange(len(rows)) if chosen is None else chosen
    if len(index) == 0:
        return
    codes = texts.codes[index]
    order = np.argsort(codes, kind="stable")
    bounds = np.flatnonzero(np.diff(codes[order])) + 1
    groups = [index[part] for part in np.split(order, bounds)]
    yield from sorted((texts.at(int(group[0])), group) for group in groups)


def unbroken(
    run: RecordedRun,
    time: FloatArray,
    x: FloatArray,
    y: FloatArray,
    speed: FloatArray,
    left_out: IntArray | None = None,
    heading: FloatArray | None = None,
) -> list[slice]:
    """Return the stretches without a missing instant and without a jump.

    ``left_out`` is the number of rows that were left out before each row on purpose; these are not missing.
    With a ``heading``, a vehicle that is turned round in a step jumps, too: SUMO turns one round on a lane
    that is drawn against its way.
    """
    step = np.searchsorted(run.times, np.round(time, 6))
    driven = 1.5 * np.maximum(speed[1:], speed[:-1]) * np.diff(time)
    skipped = np.zeros(max(len(time) - 1, 0), np.int64) if left_out is None else left_out[1:]
    # While there is no ego, nothing is recorded at all: such instants are missing from the run's own, too.
    missed = (np.diff(step) != 1 + skipped) | (np.diff(time) > (1.5 + skipped) * run.step_s)
    broken = missed | (np.hypot(np.diff(x), np.diff(y)) > driven + _JUMP_M)
    if heading is not None:
        broken |= turned(heading[:-1], heading[1:]) > driven / _TIGHTEST_M + _JUMP_RAD
    ends = [0, *(np.flatnonzero(broken) + 1).tolist(), len(time)]
    return [slice(a, b) for a, b in pairwise(ends)]


def step_of(run: RecordedRun, time: float) -> int:
    """Return the number of a recorded instant."""
    return int(np.searchsorted(run.times, np.round(time, 6)))


def refine(values: FloatArray, factor: int) -> FloatArray:
    """Return the values with ``factor − 1`` linearly interpolated values between each two."""
    if factor == 1 or len(values) < 2:
        return values.astype(np.float64)
    share = np.arange(factor) / factor
    between = values[:-1, None] + np.diff(values)[:, None] * share
    return np.append(between.ravel(), values[-1])


def row_of_sample(rows: IntArray, factor: int) -> IntArray:
    """Return the row at or before each sample."""
    return np.repeat(rows, factor)[: (len(rows) - 1) * factor + 1]
