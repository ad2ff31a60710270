"""Traffic lights of a replay in each frame: the one ahead of the ego, and those of crossings."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from analysis.arrays import FloatArray

KEPT_S = 2.0
"""A crossing's light is read off the pedestrians there; without any, the last state stays this long [s]."""
_CODES = {"green": 0, "red": 1}
NAMES = ["green", "red"]


def crossing_signals(rows: pd.DataFrame, times: FloatArray) -> dict[str, list[int | None]]:
    """Return for each crossing with a light its index in `NAMES` at each instant; ``None`` if unknown.

    Parameters
    ----------
    rows
        Rows of neighbours.parquet or traffic.parquet; older recordings of egos have no lights.
    times : (n,) [s]
    """
    if "signal" not in rows or len(times) == 0:
        return {}
    known = rows[rows["signal"].notna() & rows["crossing_id"].notna()]
    now = np.round(known["time_s"].to_numpy(dtype=np.float64), 6)
    known = known[(now >= times[0]) & (now <= times[-1])]
    found: dict[str, list[int | None]] = {}
    for crossing, some in known.groupby("crossing_id", sort=True):
        at = dict(zip(np.round(some["time_s"], 6), some["signal"].map(_CODES), strict=True))
        states: list[int | None] = []
        last, since = None, -np.inf
        for time in times.tolist():
            if time in at:
                last, since = int(at[time]), time
            states.append(last if time - since <= KEPT_S else None)
        found[str(crossing)] = states
    return found


def signal_ahead(rows: pd.DataFrame) -> dict[str, Any] | None:
    """Return state and place of the light ahead of the ego at each of its rows; ``None`` if there is none."""
    if "signal_ahead" not in rows or not rows["signal_ahead"].notna().any():
        return None
    states = [None if pd.isna(state) else str(state) for state in rows["signal_ahead"]]
    places = {
        name: [None if np.isnan(value) else round(value, 2) for value in rows[column].astype(float).tolist()]
        for name, column in (("x_m", "signal_x_m"), ("y_m", "signal_y_m"))
    }
    return {"state": states, **places}
