"""Reads pedestrians' trajectories from a CSV file of time, x, y and optionally a person, or OpenSCENARIO."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.openscenario import ENDING, read_walks
from sumo_scenarios.recorded_rows import FloatArray, read_rows

COLUMNS = ("time_s", "x_m", "y_m")
PERSON = "person"
FASTEST_MPS = 12.5
"""Highest speed of a person: world records are run at 12.4 m/s [m/s]."""
ROUNDING_S = 1e-9


def read_trajectories(path: Path) -> Mapping[str, FloatArray]:
    """Return time, x and y of each person, shape (n, 3) [s, m]; the name is empty if the file has no persons.

    Raises
    ------
    ScenarioError
        If a column is missing, a value is not a number, time does not increase, a person is faster than 12.5
        m/s or has fewer than two rows; the message is one line with file and row.
    """
    if path.suffix.lower() == ENDING:
        return _of_walks(path, read_walks(path))
    found: dict[str, list[tuple[float, ...]]] = {}
    for row in read_rows(path, COLUMNS, optional=[PERSON]):
        person = row.texts.get(PERSON, "")
        if PERSON in row.texts and not person:
            raise ScenarioError(f"{row.place}: column '{PERSON}' is empty")
        points = found.setdefault(person, [])
        if points:
            _check_step(row.place, points[-1], row.numbers, person)
        points.append(row.numbers)
    if not found:
        raise ScenarioError(f"{path}: has no rows; expected at least two of a person")
    return _arrays(path, found)


def _of_walks(path: Path, walks: Mapping[str, list[tuple[float, float, float]]]) -> Mapping[str, FloatArray]:
    """Return the walks of an OpenSCENARIO file, checked like those of a CSV file."""
    for person, points in walks.items():
        for number, (before, now) in enumerate(pairwise(points), 2):
            _check_step(f"{path}, vertex {number}", before, now, person)
    return _arrays(path, walks)


def _arrays(path: Path, found: Mapping[str, Sequence[tuple[float, ...]]]) -> Mapping[str, FloatArray]:
    for person, points in found.items():
        if len(points) < 2:
            raise ScenarioError(f"{path}: {_who(person)} has one row only; expected at least two")
    return {person: np.array(points, dtype=np.float64) for person, points in found.items()}


def _check_step(place: str, before: Sequence[float], now: Sequence[float], person: str) -> None:
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


def _who(person: str) -> str:
    return f"person '{person}'" if person else "the person"
