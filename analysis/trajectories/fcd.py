"""SUMO's output of floating car data, ``--fcd-output``: positions of front bumpers, degrees from north."""

from __future__ import annotations

import gzip
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, cast
from xml.etree import ElementTree

import numpy as np
import pandas as pd

from analysis.errors import RecordingError
from analysis.trajectories.columns import class_of
from analysis.trajectories.table import PEDESTRIAN, Trajectories

ROOT = "fcd-export"
_NEEDED = ("id", "x", "y", "angle", "speed")


def read_fcd(path: Path) -> Trajectories:
    """Return the trajectories of a file of floating car data, in the network's coordinates.

    A vehicle's class is that of its ``vClass`` or else of its type's name, a car where neither tells.

    Raises
    ------
    RecordingError
        When it cannot be read, is something else, or an element lacks an attribute or holds no number.
    """
    try:
        with _opened(path) as file:
            rows = list(_rows(path, file))
    except ElementTree.ParseError as error:
        raise RecordingError(f"{path}: not well-formed XML: {error}") from None
    except (OSError, EOFError) as error:
        raise RecordingError(f"{path}: cannot be read ({error})") from None
    names = ["id", "kind", "time_s", "x_m", "y_m", "heading_rad", "speed_mps", "row"]
    made = pd.DataFrame(rows, columns=names)
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
                time = _number(path, element, "time", count)
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


def _number(path: Path, element: ElementTree.Element, name: str, number: int) -> float:
    try:
        return float(element.attrib[name])
    except (KeyError, ValueError):
        raise RecordingError(
            f"{path}: element {number}: {name} of <{element.tag}>: expected a number, "
            f"got {element.get(name)!r}"
        ) from None
