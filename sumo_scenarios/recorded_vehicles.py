"""Reads a CSV file of recorded vehicles, which SUMO moves as they were recorded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.model import Scenario
from sumo_scenarios.recorded_rows import FloatArray, read_rows

NUMBERS = ("time_s", "x_m", "y_m", "heading_rad", "speed_mps", "length_m", "width_m")
"""Numeric columns; positions are of the front bumper's middle, headings counter-clockwise from east."""
TEXTS = ("vehicle", "class", "edge")
"""Text columns: ``class`` is SUMO's vehicle class, ``edge`` the edge on which the vehicle appears."""


@dataclass(frozen=True, slots=True)
class RecordedVehicle:
    """One recorded vehicle."""

    name: str
    vehicle_class: str
    edge: str
    length: float
    width: float
    motion: FloatArray
    """Time since the end of the warm-up, x, y, heading and speed, shape (n, 5) [s, m, rad, m/s]."""


def vehicles_file(scenario: Scenario) -> Path | None:
    """Return a scenario's file of recorded vehicles, or ``None``."""
    if scenario.table is None or scenario.folder is None or not scenario.table.recorded_vehicles:
        return None
    return scenario.folder / scenario.table.recorded_vehicles


def read_recorded_vehicles(path: Path) -> Mapping[str, RecordedVehicle]:
    """Return the recorded vehicles of a file by their names.

    Raises
    ------
    ScenarioError
        If a column is missing, a value is not a number, or time does not increase; the message is one line.
    """
    texts: dict[str, tuple[str, str]] = {}
    rows: dict[str, list[tuple[float, ...]]] = {}
    for row in read_rows(path, NUMBERS, TEXTS):
        name = row.texts["vehicle"]
        mine = rows.setdefault(name, [])
        if mine and row.numbers[0] <= mine[-1][0]:
            raise ScenarioError(
                f"{row.place}: time_s of '{name}' is {row.numbers[0]:g}, expected time to go on"
            )
        mine.append(row.numbers)
        texts.setdefault(name, (row.texts["class"], row.texts["edge"]))
    found = {}
    for name, mine in rows.items():
        table = np.array(mine, dtype=np.float64)
        kind, edge = texts[name]
        found[name] = RecordedVehicle(name, kind, edge, float(table[0, 5]), float(table[0, 6]), table[:, :5])
    return found
