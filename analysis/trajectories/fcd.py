"""SUMO's output of floating car data, ``--fcd-output``: positions of front bumpers, degrees from north.

SUMO writes it as XML or, if the name of the file ends accordingly, as a table in CSV or Parquet.
"""

from __future__ import annotations

import gzip
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, cast
from xml.etree import ElementTree

import numpy as np
import pandas as pd

from analysis.errors import RecordingError
from analysis.trajectories.columns import class_of, numbers, require
from analysis.trajectories.table import PEDESTRIAN, Trajectories

ROOT = "fcd-export"
MARK = "timestep_time"
"""The first column of the tables, by which they are recognised."""
_NEEDED = ("id", "x", "y", "angle", "speed")
_COLUMNS = (MARK, *(f"vehicle_{name}" for name in (*_NEEDED, "type", "lane")))


def read_fcd(path: Path) -> Trajectories:
    """Return the trajectories of a file of floating car data, in the network's coordinates.

    A vehicle's class follows from its ``vClass``, else from the name of its type; it is a car if neither
    names a class.

    Raises
    ------
    RecordingError
        When the file cannot be read or is something else, or an element lacks an attribute or a number.
    """
    try:
        with _opened(path) as file:
            rows = list(_rows(path, file))
    except ElementTree.ParseError as error:
        raise RecordingError(f"{path}: not well-formed XML: {error}") from None
    except (OSError, EOFError) as error:
        raise RecordingError(f"{path}: cannot be read ({error})") from None
    names = ["id", "kind", "time_s", "x_m", "y_m", "heading_rad", "speed_mps", "row"]
    return _trajectories(path, pd.DataFrame(rows, columns=names))


def of_table(path: Path, table: pd.DataFrame) -> Trajectories:
    """Return the trajectories of floating car data that SUMO wrote as a table.

    Such a table lists persons like vehicles; rows without a lane are those of persons.

    Parameters
    ----------
    path : for messages
    table : the columns as SUMO names them, and ``row``

    Raises
    ------
    RecordingError
        For a missing column, or a cell that is not a number.
    """
    require(path, (name for name in table.columns if name != "row"), _COLUMNS, "SUMO's floating car data")
    walking = table["vehicle_lane"].isna() | (table["vehicle_lane"] == "")
    kinds = {name: class_of(name) or "car" for name in table["vehicle_type"].astype(str).unique()}
    names = table["vehicle_id"].astype(str)
    made = pd.DataFrame({"id": names.where(~walking, "person " + names)})
    made["kind"] = table["vehicle_type"].astype(str).map(kinds).where(~walking, PEDESTRIAN)
    made["time_s"] = numbers(path, table, MARK)
    made["x_m"], made["y_m"] = numbers(path, table, "vehicle_x"), numbers(path, table, "vehicle_y")
    heading = np.radians(90.0 - numbers(path, table, "vehicle_angle"))
    made["heading_rad"] = np.arctan2(np.sin(heading), np.cos(heading))
    made["speed_mps"] = numbers(path, table, "vehicle_speed")
    made["row"] = table["row"]
    return _trajectories(path, made)


def _trajectories(path: Path, made: pd.DataFrame) -> Trajectories:
    made["length_m"] = made["width_m"] = np.nan
    return Trajectories(made, str(path), None, "fcd", bodies_known=False, at_front=True)


def _opened(path: Path) -> BinaryIO:
    with path.open("rb") as file:
        packed = file.read(2) == b"\x1f\x8b"
    return cast(BinaryIO, gzip.open(path, "rb")) if packed else path.open("rb")


def _rows(path: Path, file: BinaryIO) -> Iterator[tuple[Any, ...]]:
    time, count = np.nan, 0
    for event, element in ElementTree.iterparse(file, events=("start", "end")):
        if event == "start":
            if count == 0 and element.tag != ROOT:
                raise RecordingError(f"{path}: the root element is <{element.tag}>; expected <{ROOT}>")
            count += 1
            if element.tag == "timestep":
                time = _time(path, element, count)
            continue
        if element.tag in ("vehicle", "person"):
            yield _row(path, element, time, count)
        if element.tag == "timestep":
            element.clear()


def _row(path: Path, element: ElementTree.Element, time: float, number: int) -> tuple[Any, ...]:
    for name in _NEEDED:
        if element.get(name) is None:
            raise RecordingError(f"{path}: element {number} at {time:g} s: <{element.tag}> has no {name}")
    x, y, angle, speed = (_number(path, element, name, number) for name in ("x", "y", "angle", "speed"))
    heading = np.radians(90.0 - angle)
    kind = PEDESTRIAN
    if element.tag == "vehicle":
        told = (element.get("vClass"), element.get("type"))
        kind = next((found for name in told if name and (found := class_of(name))), "car")
    # A vehicle and a person may share an id.
    name = element.attrib["id"] if element.tag == "vehicle" else f"person {element.attrib['id']}"
    return name, kind, time, x, y, float(np.arctan2(np.sin(heading), np.cos(heading))), speed, number


def _time(path: Path, element: ElementTree.Element, number: int) -> float:
    """Return the time of a step, given as seconds or as (days:)hours:minutes:seconds [s]."""
    parts = element.get("time", "").split(":")
    if len(parts) == 1:
        return _number(path, element, "time", number)
    try:
        values = [float(part) for part in parts]
    except ValueError:
        values = []
    if not 3 <= len(values) <= 4:
        text = element.get("time")
        raise RecordingError(
            f"{path}: element {number}: time of <timestep>: expected seconds or h:m:s, got {text!r}"
        )
    return sum(value * scale for value, scale in zip(reversed(values), (1, 60, 3600, 86400), strict=False))


def _number(path: Path, element: ElementTree.Element, name: str, number: int) -> float:
    try:
        return float(element.attrib[name])
    except (KeyError, ValueError):
        raise RecordingError(
            f"{path}: element {number}: {name} of <{element.tag}>: expected a number, "
            f"got {element.get(name)!r}"
        ) from None
