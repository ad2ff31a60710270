"""Recorded vehicles that SUMO moves as they were recorded: a CSV file of who was where when."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.model import Scenario

FloatArray = NDArray[np.float64]

NUMBERS = ("time_s", "x_m", "y_m", "heading_rad", "speed_mps", "length_m", "width_m")
"""Position of the middle of the front bumper; the heading is counter-clockwise from east."""
TEXTS = ("vehicle", "class", "edge")
"""``class`` is SUMO's, ``edge`` the one on which the vehicle comes into view."""


@dataclass(frozen=True, slots=True)
class RecordedVehicle:
    """One recorded vehicle."""

    name: str
    vehicle_class: str
    edge: str
    length: float
    width: float
    motion: FloatArray
    """Time since the first step, x, y, heading and speed, shape (n, 5) [s, m, rad, m/s]."""


def vehicles_file(scenario: Scenario) -> Path | None:
    """Return the file of recorded vehicles of a scenario; ``None`` without one."""
    if scenario.table is None or scenario.folder is None or not scenario.table.recorded_vehicles:
        return None
    return scenario.folder / scenario.table.recorded_vehicles


def read_recorded_vehicles(path: Path) -> Mapping[str, RecordedVehicle]:
    """Return the recorded vehicles of a file by their names.

    Raises
    ------
    ScenarioError
        One line with file and row: a column that is missing, what is no number, or time that does not go on.
    """
    try:
        with path.open(encoding="utf-8", newline="") as file:
            return _read(path, csv.DictReader(file))
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise ScenarioError(f"{path}: no CSV file: {error}") from error


def _read(path: Path, reader: csv.DictReader[str]) -> Mapping[str, RecordedVehicle]:
    header = reader.fieldnames or ()
    for name in (*TEXTS, *NUMBERS):
        if name not in header:
            raise ScenarioError(f"{path}: column '{name}' is missing; got {', '.join(header) or 'nothing'}")
    texts: dict[str, tuple[str, str]] = {}
    rows: dict[str, list[tuple[float, ...]]] = {}
    for row in reader:
        place = f"{path}, row {reader.line_num}"
        values = tuple(_number(place, name, row[name]) for name in NUMBERS)
        name = row["vehicle"] or ""
        mine = rows.setdefault(name, [])
        if mine and values[0] <= mine[-1][0]:
            raise ScenarioError(f"{place}: time_s of '{name}' is {values[0]:g}, expected time to go on")
        mine.append(values)
        texts.setdefault(name, (row["class"] or "", row["edge"] or ""))
    found = {}
    for name, mine in rows.items():
        table = np.array(mine, dtype=np.float64)
        kind, edge = texts[name]
        found[name] = RecordedVehicle(name, kind, edge, float(table[0, 5]), float(table[0, 6]), table[:, :5])
    return found


def _number(place: str, name: str, text: str | None) -> float:
    try:
        value = float(text or "")
    except ValueError:
        raise ScenarioError(f"{place}: {name} is {text!r}; expected a number") from None
    if not math.isfinite(value):
        raise ScenarioError(f"{place}: {name} is {text!r}; expected a finite number")
    return value
