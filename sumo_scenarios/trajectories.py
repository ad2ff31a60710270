"""Recorded trajectories of pedestrians: a CSV file of time, x, y and perhaps a person, or OpenSCENARIO."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.openscenario import ENDING, read_walks

FloatArray = NDArray[np.float64]

COLUMNS = ("time_s", "x_m", "y_m")
PERSON = "person"
FASTEST_MPS = 12.5
"""Nobody runs faster: world records are run at 12.4 m/s."""
ROUNDING_S = 1e-9


def read_trajectories(path: Path) -> Mapping[str, FloatArray]:
    """Return time, x and y (n, 3) [s, m] of each person of a file; the person is empty without that column.

    Raises
    ------
    ScenarioError
        One line with file and row: a column that is missing, something that is no number, time that does
        not go on, somebody faster than 12.5 m/s, or a person with fewer than two rows.
    """
    if path.suffix.lower() == ENDING:
        return _of_walks(path, read_walks(path))
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            return _read(path, csv.DictReader(file))
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise ScenarioError(f"{path}: no CSV file: {error}") from error


def _read(path: Path, reader: csv.DictReader[str]) -> Mapping[str, FloatArray]:
    header = [name.strip() for name in reader.fieldnames or ()]
    reader.fieldnames = header
    missing = [name for name in COLUMNS if name not in header]
    if missing:
        raise ScenarioError(
            f"{path}: column '{missing[0]}' is missing; expected {', '.join(COLUMNS)} and perhaps {PERSON}, "
            f"got {', '.join(header) or 'nothing'}"
        )
    found: dict[str, list[tuple[float, float, float]]] = {}
    for row in reader:
        place = f"{path}, row {reader.line_num}"
        time, x, y = (_number(place, name, row[name]) for name in COLUMNS)
        person = (row.get(PERSON) or "").strip()
        if PERSON in header and not person:
            raise ScenarioError(f"{place}: column '{PERSON}' is empty")
        points = found.setdefault(person, [])
        if points:
            _check_step(place, points[-1], (time, x, y), person)
        points.append((time, x, y))
    if not found:
        raise ScenarioError(f"{path}: has no rows; expected at least two of a person")
    return _arrays(path, found)


def _of_walks(path: Path, walks: Mapping[str, list[tuple[float, float, float]]]) -> Mapping[str, FloatArray]:
    """Return the walks of an OpenSCENARIO file, checked like those of a CSV file."""
    for person, points in walks.items():
        for number, (before, now) in enumerate(pairwise(points), 2):
            _check_step(f"{path}, vertex {number}", before, now, person)
    return _arrays(path, walks)


def _arrays(path: Path, found: Mapping[str, list[tuple[float, float, float]]]) -> Mapping[str, FloatArray]:
    for person, points in found.items():
        if len(points) < 2:
            raise ScenarioError(f"{path}: {_who(person)} has one row only; expected at least two")
    return {person: np.array(points, dtype=np.float64) for person, points in found.items()}


def _check_step(
    place: str, before: tuple[float, float, float], now: tuple[float, float, float], person: str
) -> None:
    passed = now[0] - before[0]
    if passed <= ROUNDING_S:
        raise ScenarioError(
            f"{place}: time_s is {now[0]:g}, after {before[0]:g} in the row before of {_who(person)}; "
            "expected time to go on"
        )
    speed = math.dist(before[1:], now[1:]) / passed
    if speed > FASTEST_MPS:
        raise ScenarioError(
            f"{place}: {_who(person)} would move at {speed:.1f} m/s; expected at most {FASTEST_MPS:g} m/s"
        )


def _number(place: str, name: str, text: str | None) -> float:
    try:
        value = float(text or "")
    except ValueError:
        raise ScenarioError(f"{place}: {name} is {text!r}; expected a number") from None
    if not math.isfinite(value):
        raise ScenarioError(f"{place}: {name} is {text!r}; expected a finite number")
    return value


def _who(person: str) -> str:
    return f"person '{person}'" if person else "the person"
