"""The layout of a plain table of trajectories, whose columns have their units in their names."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from analysis.errors import RecordingError
from analysis.trajectories.columns import classes, numbers, require
from analysis.trajectories.table import DEGREES, Trajectories

UNITS: Mapping[str, Mapping[str, float]] = {
    "time": {"s": 1.0, "ms": 1e-3},
    "x": {"m": 1.0, "ft": 0.3048},
    "y": {"m": 1.0, "ft": 0.3048},
    "heading": {"rad": 1.0, "deg": np.pi / 180.0},
    "speed": {"mps": 1.0, "kmh": 1.0 / 3.6, "mph": 0.44704, "ftps": 0.3048},
    "length": {"m": 1.0, "ft": 0.3048},
    "width": {"m": 1.0, "ft": 0.3048},
}
"""Quantity -> unit at the end of the column's name -> factor to SI."""
NEEDED = "id, class, time_s, x_m, y_m (or lon_deg, lat_deg)"


def of_table(path: Path, table: pd.DataFrame) -> Trajectories:
    """Return the trajectories of a plain table.

    Parameters
    ----------
    path : for messages
    table : columns ``id``, ``class``, ``time_s``, ``x_m`` and ``y_m`` or ``lon_deg`` and ``lat_deg``, and if
        known ``heading_rad`` (counter-clockwise from east), ``speed_mps``, ``length_m``, ``width_m``; each
        quantity may have another unit of `UNITS` in its name. Positions are the centres of bodies.

    Raises
    ------
    RecordingError
        For a missing column, a text that is not a number, or two units where there must be one.
    """
    in_degrees = {"lon_deg", "lat_deg"} <= set(table.columns)
    columns = {quantity: _column(path, table, quantity) for quantity in UNITS}
    needed = ["id", "class"]
    needed += [] if columns["time"] else ["time_s"]
    if not in_degrees:
        needed += [f"{axis}_m" for axis in ("x", "y") if columns[axis] is None]
    require(path, (name for name in table.columns if name != "row"), needed, f"a plain table: {NEEDED}")
    if not in_degrees:
        _one_unit(path, columns["x"], columns["y"])
    made = pd.DataFrame({"id": table["id"].astype(str), "kind": classes(path, table, "class")})
    for quantity, name in (
        ("time", "time_s"),
        ("heading", "heading_rad"),
        ("speed", "speed_mps"),
        ("length", "length_m"),
        ("width", "width_m"),
        ("x", "x_m"),
        ("y", "y_m"),
    ):
        made[name] = _in_si(path, table, quantity, columns[quantity])
    if in_degrees:
        made["x_m"], made["y_m"] = numbers(path, table, "lon_deg"), numbers(path, table, "lat_deg")
    made["row"] = table["row"]
    return Trajectories(
        made, str(path), DEGREES if in_degrees else None, "csv", columns["length"] is not None
    )


def _column(path: Path, table: pd.DataFrame, quantity: str) -> str | None:
    found = [f"{quantity}_{unit}" for unit in UNITS[quantity] if f"{quantity}_{unit}" in table.columns]
    if len(found) > 1:
        raise RecordingError(f"{path}: row 1: columns {' and '.join(found)} exclude each other")
    return found[0] if found else None


def _one_unit(path: Path, x: str | None, y: str | None) -> None:
    if x is not None and y is not None and x.partition("_")[2] != y.partition("_")[2]:
        raise RecordingError(f"{path}: row 1: mixed units {x} and {y}; expected one unit for both")


def _in_si(path: Path, table: pd.DataFrame, quantity: str, column: str | None) -> pd.Series:
    if column is None:
        return pd.Series(np.nan, index=table.index)
    return numbers(path, table, column) * UNITS[quantity][column.partition("_")[2]]
