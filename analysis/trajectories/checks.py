"""Checks that refuse impossible trajectories in one line with the file, the row and what was expected."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from analysis.errors import RecordingError
from analysis.trajectories.columns import row_of

JUMP_MPS = 70.0
"""No road user in a town moves faster [m/s]."""
JUMP_M = 5.0
"""A step of at most this length is noise, not a jump [m]."""
LONGEST_TURN = 2.0 * np.pi + 1e-6
DEGREES_EXTENT = 1.0
"""A site extends over less than this in degrees, and over more in metres."""
_FACTORS = {"km/h": 3.6, "mph": 2.23694, "ft/s": 3.28084}
_AGREEMENT = 0.1
"""Recorded speeds are taken to be in another unit if they match it within this share."""
_LEAST_MOVING = 20
_MOVING_MPS = 1.0


def sorted_and_checked(frame: pd.DataFrame, path: Path | str) -> pd.DataFrame:
    """Return the samples sorted by id and time.

    Parameters
    ----------
    frame : the columns of `analysis.trajectories.table.COLUMNS` and ``row``, in the file's order
    path : for messages

    Raises
    ------
    RecordingError
        For no rows, an undefined number, time that runs backwards or stands, a jump, or a wrong unit.
    """
    if len(frame) == 0:
        raise RecordingError(f"{path}: no rows; expected samples of road users")
    nameless = frame["id"].isna().to_numpy(bool)
    if nameless.any():
        raise RecordingError(f"{path}: row {row_of(frame, nameless)}: id: expected a name, found none")
    for column in ("time_s", "x_m", "y_m"):
        bad = ~np.isfinite(frame[column].to_numpy(np.float64))
        if bad.any():
            raise RecordingError(f"{path}: row {row_of(frame, bad)}: {column}: expected a number, found none")
    _forward(frame, path)
    ordered = frame.sort_values(["id", "time_s"], kind="stable", ignore_index=True)
    _no_jumps(ordered, path)
    _radians(ordered, path)
    _metres(ordered, path)
    _speeds(ordered, path)
    return ordered


def _forward(frame: pd.DataFrame, path: Path | str) -> None:
    before = frame.groupby("id", sort=False)["time_s"].shift()
    back = (frame["time_s"] < before).to_numpy()
    if back.any():
        at = int(np.argmax(back))
        raise RecordingError(
            f"{path}: row {row_of(frame, back)}: time of {frame['id'].iloc[at]!r} runs backwards from "
            f"{before.iloc[at]:g} s to {frame['time_s'].iloc[at]:g} s; expected ascending times of each id"
        )
    same = (frame["time_s"] == before).to_numpy()
    if same.any():
        at = int(np.argmax(same))
        raise RecordingError(
            f"{path}: row {row_of(frame, same)}: {frame['id'].iloc[at]!r} has a second sample at "
            f"{frame['time_s'].iloc[at]:g} s; expected one id for each road user"
        )


def _no_jumps(frame: pd.DataFrame, path: Path | str) -> None:
    same = (frame["id"] == frame["id"].shift()).to_numpy()
    way = np.hypot(frame["x_m"].diff().to_numpy(), frame["y_m"].diff().to_numpy())
    time = frame["time_s"].diff().to_numpy()
    jump = same & (way > JUMP_M) & (way > JUMP_MPS * time)
    if jump.any():
        at = int(np.argmax(jump))
        raise RecordingError(
            f"{path}: row {row_of(frame, jump)}: {frame['id'].iloc[at]!r} jumps {way[at]:.1f} m in "
            f"{time[at]:g} s; expected tracks without jumps, one id for each piece"
        )


def _radians(frame: pd.DataFrame, path: Path | str) -> None:
    heading = frame["heading_rad"].to_numpy(np.float64)
    high = np.abs(heading) > LONGEST_TURN
    if high.any():
        at = int(np.argmax(high))
        raise RecordingError(
            f"{path}: row {row_of(frame, high)}: heading {heading[at]:g} is no angle in radians; "
            "degrees go into a column heading_deg"
        )


def _metres(frame: pd.DataFrame, path: Path | str) -> None:
    x, y = frame["x_m"].to_numpy(), frame["y_m"].to_numpy()
    small = max(np.ptp(x), np.ptp(y)) < DEGREES_EXTENT and np.abs(x).max() <= 180.0 and np.abs(y).max() <= 90
    moved = frame["speed_mps"].fillna(0.0).max() > _MOVING_MPS
    if small and (moved or (x.min() > 0.0 and y.min() > 20.0 and not np.allclose(x, np.round(x)))):
        raise RecordingError(
            f"{path}: row {int(frame['row'].iloc[0])}: positions such as {x[0]:g}, {y[0]:g} look like "
            "degrees; longitude and latitude go into columns lon_deg and lat_deg, or take --crs EPSG:4326"
        )


def _speeds(frame: pd.DataFrame, path: Path | str) -> None:
    """Refuse speeds that equal those of the positions, but in another unit."""
    same = (frame["id"] == frame["id"].shift()).to_numpy()
    time = frame["time_s"].diff().to_numpy()
    way = np.hypot(frame["x_m"].diff().to_numpy(), frame["y_m"].diff().to_numpy())
    said = frame["speed_mps"].to_numpy(np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        moved = way / time
    known = same & np.isfinite(said) & (moved > _MOVING_MPS)
    if np.count_nonzero(known) < _LEAST_MOVING:
        return
    ratio = float(np.median(said[known] / moved[known]))
    meanings = {factor: f"speeds look like {unit}" for unit, factor in _FACTORS.items()}
    for factor in _FACTORS.values():
        meanings[1.0 / factor] = "positions are not in the same unit as the speeds (feet?)"
    nearest = min(meanings, key=lambda factor: abs(ratio / factor - 1.0))
    if abs(ratio / nearest - 1.0) < _AGREEMENT:
        raise RecordingError(
            f"{path}: row {row_of(frame, known)}: {meanings[nearest]}: they are {ratio:.2f} times those of "
            "the positions; expected metres and m/s, or the unit in the column's name"
        )
