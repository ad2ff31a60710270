"""Tracks of egos, from their own recording."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.polylines import arc_lengths
from analysis.recording.fine_grid import Grid, by_name, refine, row_of_sample, step_of, unbroken
from analysis.recording.reading import Columns, RecordedRun
from analysis.recording.tracks import Track
from analysis.thresholds import Thresholds


class EgoTracks:
    """Tracks of egos: cubic Hermite in the rear axle's position and velocity, linear heading.

    Each track is computed on request and not kept.

    Parameters
    ----------
    run : RecordedRun
    rows : Columns
        Recorded rows of the egos.
    grid : Grid
    thresholds : Thresholds

    Notes
    -----
    The cubic is replaced by the straight line in a step where it would run backwards (its end slopes
    exceed three times the mean slope), which happens when a vehicle stops within the step.
    """

    def __init__(self, run: RecordedRun, rows: Columns, grid: Grid, thresholds: Thresholds) -> None:
        self._rows, self._grid, self._overhang = rows, grid, thresholds.ego_rear_overhang_m
        self._levels = run.levels.of_lanes(rows.texts["lane"].names, rows.texts["lane"].codes)
        self._pieces: list[tuple[str, int, IntArray, FloatArray]] = []
        """Name, first recorded step, rows and headings of each track."""
        for name, index in by_name(rows, "ego_id"):
            number = {key: values[index] for key, values in rows.numbers.items()}
            time = number["time_s"]
            x, y, headings = number["front_x_m"], number["front_y_m"], number["heading_rad"]
            for piece in unbroken(run, time, x, y, number["speed_mps"], heading=headings):
                heading = np.unwrap(headings[piece])
                self._pieces.append((name, step_of(run, time[piece][0]), index[piece], heading))

    def __iter__(self) -> Iterator[Track]:
        return map(self._track, range(len(self._pieces)))

    def during(self, first: int, last: int) -> list[Track]:
        """Return the tracks recorded between two samples of the fine grid, each cut to that stretch."""
        factor, found = self._grid.factor, []
        for number, (_, begin, index, _) in enumerate(self._pieces):
            if begin * factor <= last and first <= (begin + len(index) - 1) * factor:
                low, high = max(0, first // factor - begin), -(-last // factor) - begin
                found.append(self._track(number, slice(low, high + 1)))
        return found

    def _track(self, number: int, steps: slice = slice(None)) -> Track:
        """Return a track, or some recorded steps of it."""
        name, begin, index, heading = self._pieces[number]
        index, heading, factor = index[steps], heading[steps], self._grid.factor
        recorded = {key: self._rows.numbers[key][index] for key in _OF_EGOS}
        length, width = float(recorded["length_m"][0]), float(recorded["width_m"][0])
        speed, time = recorded["speed_mps"], recorded["time_s"]
        lever = length - self._overhang
        axle_x = recorded["front_x_m"] - lever * np.cos(heading)
        axle_y = recorded["front_y_m"] - lever * np.sin(heading)
        fine_heading, fine_speed = refine(heading, factor), refine(speed, factor)
        ahead = 0.5 * length - self._overhang
        cubic = _runs_forward(time, axle_x, axle_y, heading, speed)
        axle = [
            _hermite(time, values, slope, cubic, factor)
            for values, slope in ((axle_x, speed * np.cos(heading)), (axle_y, speed * np.sin(heading)))
        ]
        x, y = axle[0] + ahead * np.cos(fine_heading), axle[1] + ahead * np.sin(fine_heading)
        rows = row_of_sample(index, factor)
        return Track(
            name=name,
            kind="",
            first=(begin + (steps.start or 0)) * factor,
            rows=rows,
            x=x,
            y=y,
            heading=fine_heading,
            x_speed=fine_speed * np.cos(fine_heading),
            y_speed=fine_speed * np.sin(fine_heading),
            speed=fine_speed,
            acceleration=refine(recorded["acceleration_mps2"], factor),
            path=arc_lengths(np.column_stack([x, y])),
            level=self._levels[rows],
            length=length,
            width=width,
        )


_OF_EGOS = (
    "time_s",
    "front_x_m",
    "front_y_m",
    "speed_mps",
    "acceleration_mps2",
    "length_m",
    "width_m",
)


def _runs_forward(
    time: FloatArray, x: FloatArray, y: FloatArray, heading: FloatArray, speed: FloatArray
) -> BoolArray:
    if len(time) < 2:
        return np.zeros(0, dtype=np.bool_)
    middle = 0.5 * (heading[1:] + heading[:-1])
    mean = (np.diff(x) * np.cos(middle) + np.diff(y) * np.sin(middle)) / np.diff(time)
    return np.asarray((speed[:-1] <= 3.0 * mean) & (speed[1:] <= 3.0 * mean))


def _hermite(
    time: FloatArray, values: FloatArray, slopes: FloatArray, cubic: BoolArray, factor: int
) -> FloatArray:
    if factor == 1 or len(values) < 2:
        return values.astype(np.float64)
    s = (np.arange(factor) / factor)[None, :]
    step = np.diff(time)[:, None]
    start, change = values[:-1, None], np.diff(values)[:, None]
    first = step * slopes[:-1, None] - change
    second = change - step * slopes[1:, None]
    bend = s * (1.0 - s) * (first * (1.0 - s) + second * s)
    between = start + s * change + np.where(cubic[:, None], bend, 0.0)
    return np.append(between.ravel(), values[-1])
