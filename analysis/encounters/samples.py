"""All samples of all encounters in flat arrays, so that every measure is computed at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.encounters.finding import Encounter, exposed_samples
from analysis.geometry import clearance, time_to_contact, to_frame
from analysis.recording.fine_grid import Grid
from analysis.recording.reading import RecordedRun
from analysis.thresholds import Thresholds


@dataclass(frozen=True, slots=True)
class Samples:
    """Flat arrays over the samples of all encounters, encounter after encounter.

    Distances and velocities are those of the pedestrian in the frame of the ego's rectangle.
    """

    starts: IntArray
    """Index of each encounter's first sample."""
    owner: IntArray
    """Encounter of each sample."""
    time: FloatArray
    duration: FloatArray
    """Time until the next sample of the same encounter; 0 at its last one [s]."""
    x: FloatArray
    y: FloatArray
    x_speed: FloatArray
    """Pedestrian's own velocity along the ego [m/s]."""
    y_speed: FloatArray
    ego_speed: FloatArray
    person_speed: FloatArray
    half_length: FloatArray
    half_width: FloatArray
    radius: FloatArray
    exposed: BoolArray
    """Whether predicted collisions count at the sample."""
    clearance: FloatArray
    """Distance between the surfaces at the sample [m]."""
    ttc: FloatArray
    """Exact time to contact at constant velocities; inf without one, nan where not exposed [s]."""

    def __len__(self) -> int:
        return len(self.time)

    @property
    def relative_x_speed(self) -> FloatArray:
        """Velocity of the pedestrian relative to the ego, along the ego [m/s]."""
        return np.asarray(self.x_speed - self.ego_speed)

    @property
    def same_as_next(self) -> BoolArray:
        """Whether the next sample belongs to the same encounter; one shorter than the arrays."""
        return np.asarray(self.owner[1:] == self.owner[:-1])

    def smallest(self, values: FloatArray) -> tuple[FloatArray, IntArray]:
        """Return each encounter's smallest value, nan taken as inf, and its first sample."""
        if len(self.starts) == 0:
            return np.zeros(0), np.zeros(0, dtype=np.int64)
        filled = np.where(np.isnan(values), np.inf, values)
        low = np.minimum.reduceat(filled, self.starts)
        at = np.where(filled == low[self.owner], np.arange(len(filled)), len(filled))
        return low, np.minimum.reduceat(at, self.starts)

    def largest(self, values: FloatArray) -> tuple[FloatArray, IntArray]:
        """Return each encounter's largest value, nan taken as -inf, and its first sample."""
        low, at = self.smallest(-values)
        return -low, at

    def total(self, values: FloatArray) -> FloatArray:
        """Return each encounter's sum of the values."""
        if len(self.starts) == 0:
            return np.zeros(0)
        return np.asarray(np.add.reduceat(values, self.starts))

    def any(self, flags: BoolArray) -> BoolArray:
        """Return whether the flag is set at any sample of each encounter."""
        if len(self.starts) == 0:
            return np.zeros(0, dtype=np.bool_)
        return np.asarray(np.logical_or.reduceat(flags, self.starts))


def gather(encounters: Sequence[Encounter], run: RecordedRun, grid: Grid, thresholds: Thresholds) -> Samples:
    """Return the flat samples of the encounters."""
    count = len(encounters)
    sizes = np.array([one.last - one.first + 1 for one in encounters], dtype=np.int64)
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int64) if count else np.zeros(0, np.int64)
    owner = np.repeat(np.arange(count), sizes)
    columns: dict[str, list[FloatArray]] = {
        name: [] for name in ("time", "dx", "dy", "heading", "px", "py", "ego_speed", "person_speed")
    }
    exposed: list[BoolArray] = [np.zeros(0, dtype=np.bool_)]
    for one in encounters:
        a = slice(one.first - one.ego.first, one.last - one.ego.first + 1)
        b = slice(one.first - one.person.first, one.last - one.person.first + 1)
        columns["time"].append(grid.time[one.first : one.last + 1])
        columns["dx"].append(one.person.x[b] - one.ego.x[a])
        columns["dy"].append(one.person.y[b] - one.ego.y[a])
        columns["heading"].append(one.ego.heading[a])
        columns["px"].append(one.person.x_speed[b])
        columns["py"].append(one.person.y_speed[b])
        columns["ego_speed"].append(one.ego.speed[a])
        columns["person_speed"].append(one.person.speed[b])
        exposed.append(exposed_samples(one, run, thresholds.standing_speed_mps))
    flat = {name: np.concatenate([np.zeros(0), *parts]) for name, parts in columns.items()}
    x, y = to_frame(flat["dx"], flat["dy"], flat["heading"])
    x_speed, y_speed = to_frame(flat["px"], flat["py"], flat["heading"])
    half_length = np.array([0.5 * one.ego.length for one in encounters])[owner]
    half_width = np.array([0.5 * one.ego.width for one in encounters])[owner]
    radius = np.array([0.5 * one.person.width for one in encounters])[owner]
    counted = np.concatenate(exposed)
    duration = np.zeros(len(owner))
    if len(owner) > 1:
        duration[:-1] = np.where(owner[1:] == owner[:-1], np.diff(flat["time"]), 0.0)
    ttc = np.full(len(owner), np.nan)
    ttc[counted] = time_to_contact(
        x[counted],
        y[counted],
        (x_speed - flat["ego_speed"])[counted],
        y_speed[counted],
        half_length[counted],
        half_width[counted],
        radius[counted],
    )
    return Samples(
        starts=starts,
        owner=owner,
        time=flat["time"],
        duration=duration,
        x=x,
        y=y,
        x_speed=x_speed,
        y_speed=y_speed,
        ego_speed=flat["ego_speed"],
        person_speed=flat["person_speed"],
        half_length=half_length,
        half_width=half_width,
        radius=radius,
        exposed=counted,
        clearance=clearance(x, y, half_length, half_width, radius),
        ttc=ttc,
    )
