"""Resampling of trajectories to one clock: samples at whole steps, bodies of known size, no gaps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analysis.trajectories.table import BODIES, PEDESTRIAN, Trajectories
from cosim.arrays import FloatArray
from cosim.errors import InputError

LONGEST_GAP_S = 1.0
"""Longest gap that is filled; after a longer one, the track continues as another track [s]."""
SHORTEST_STEP_S, LONGEST_STEP_S = 0.02, 1.0
SHORTEST_S = 0.5
"""Shorter pieces of a track are left out [s]."""
BODIES_FROM = ("assumed", "recorded")


@dataclass(frozen=True, slots=True)
class Clock:
    """Clock of whole steps."""

    step_s: float

    def number(self, time: FloatArray) -> NDArray[np.int64]:
        """Return the number of the step nearest to a time."""
        return np.round(time / self.step_s).astype(np.int64)


def clock_of(found: Trajectories) -> Clock:
    """Return the clock of a recording: the median time between two samples of a road user.

    Raises
    ------
    InputError
        If the median is too short or too long for a judgement.
    """
    steps = found.frame.groupby("id", sort=False)["time_s"].diff().dropna()
    step = round(float(steps.median()), 4) if len(steps) else 0.0
    if not SHORTEST_STEP_S <= step <= LONGEST_STEP_S:
        raise InputError(
            f"{found.source}: samples are {step:g} s apart; "
            f"expected {SHORTEST_STEP_S:g} to {LONGEST_STEP_S:g} s"
        )
    return Clock(step)


def on_clock(found: Trajectories, clock: Clock, bodies: str | None = None) -> pd.DataFrame:
    """Return samples at whole steps, interpolated linearly between the recorded samples.

    Parameters
    ----------
    found
    clock
    bodies : ``assumed`` lengths and widths or the ``recorded`` ones (median of a track, assumed where there
        is none); by default, recorded if the layout has reliable ones

    Returns
    -------
    DataFrame
        As `Trajectories.frame`, with ``step`` and ``acceleration_mps2``, sorted by id and time; a track with
        a gap is split into several, named ``id``, ``id/2`` and so on.
    """
    frame = found.frame
    recorded = found.bodies_known if bodies is None else bodies == BODIES_FROM[1]
    pieces = []
    for name, track in frame.groupby("id", sort=True):
        time = track["time_s"].to_numpy(np.float64)
        cuts = np.flatnonzero(np.diff(time) > LONGEST_GAP_S) + 1
        number = 0
        for rows in np.split(np.arange(len(time)), cuts):
            if time[rows[-1]] - time[rows[0]] < SHORTEST_S:
                continue
            number += 1
            piece = _resampled(track.iloc[rows], clock)
            piece["id"] = str(name) if number == 1 else f"{name}/{number}"
            kind = str(track["kind"].iloc[0])
            for column, assumed in zip(("length_m", "width_m"), BODIES[kind], strict=True):
                size = float(track[column].median()) if recorded and track[column].notna().any() else assumed
                piece[column] = size
            piece["kind"] = kind
            pieces.append(piece)
    if not pieces:
        raise InputError(f"{found.source}: no track is longer than {SHORTEST_S:g} s")
    made = pd.concat(pieces, ignore_index=True)
    if found.at_front:
        back = np.where(made["kind"] == PEDESTRIAN, 0.0, 0.5 * made["length_m"])
        made["x_m"] -= back * np.cos(made["heading_rad"])
        made["y_m"] -= back * np.sin(made["heading_rad"])
    return made


def _resampled(track: pd.DataFrame, clock: Clock) -> pd.DataFrame:
    time = track["time_s"].to_numpy(np.float64)
    first = int(np.ceil(time[0] / clock.step_s - 0.5))
    steps = np.arange(first, int(np.floor(time[-1] / clock.step_s + 0.5)) + 1)
    at = steps * clock.step_s
    if len(steps) == len(time) and np.abs(at - time).max() <= 0.5 * clock.step_s:
        # With one sample per step, a constant shift of the clock must not shift the road users.
        at = time
    columns = {name: np.interp(at, time, track[name]) for name in ("x_m", "y_m", "speed_mps")}
    heading = np.interp(at, time, np.unwrap(track["heading_rad"].to_numpy(np.float64)))
    columns["heading_rad"] = np.arctan2(np.sin(heading), np.cos(heading))
    speed = columns["speed_mps"]
    slope = np.gradient(speed, clock.step_s) if len(speed) > 1 else np.zeros_like(speed)
    row = track["row"].to_numpy()[np.minimum(np.searchsorted(time, at - 1e-9), len(time) - 1)]
    return pd.DataFrame(
        {"step": steps, "time_s": steps * clock.step_s, **columns, "acceleration_mps2": slope, "row": row}
    )
