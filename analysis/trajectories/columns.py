"""Checks of the columns that a layout needs, and the classes that its names stand for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from analysis.arrays import BoolArray
from analysis.errors import RecordingError

CLASSES: Mapping[str, tuple[str, ...]] = {
    "pedestrian": ("pedestrian", "ped", "person", "walker", "adult", "child"),
    "bicycle": ("bicycle", "bike", "cyclist", "cycle", "e_scooter", "escooter"),
    "motorcycle": ("motorcycle", "motorbike", "moped", "powered_two_wheeler"),
    "bus": ("bus", "coach", "tram"),
    "truck": ("truck", "truck_bus", "lorry", "trailer", "heavy"),
    "van": ("van", "delivery", "medium"),
    "car": ("car", "passenger", "auto", "taxi", "vehicle"),
}
"""Class in this program -> names that recordings give it."""


def class_of(name: str) -> str | None:
    """Return the class for a name in a recording; ``None`` for an unknown name.

    >>> class_of("Truck_Bus"), class_of("veh_motorbike"), class_of("dog")
    ('truck', 'motorcycle', None)
    """
    text = name.strip().lower().replace("-", "_").replace(" ", "_")
    for here, names in CLASSES.items():
        if text in names:
            return here
    parts = set(text.split("_"))
    for here, names in CLASSES.items():
        if parts & set(names):
            return here
    return None


def require(path: Path | str, present: Iterable[str], needed: Iterable[str], layout: str) -> None:
    """Refuse a table that lacks needed columns.

    Raises
    ------
    RecordingError
        If columns are missing; the message names them and the columns that exist.
    """
    there = list(present)
    missing = [name for name in needed if name not in there]
    if missing:
        raise RecordingError(
            f"{path}: row 1: no column {', '.join(map(repr, missing))} ({layout}); "
            f"there are {', '.join(there[:12])}"
        )


def row_of(frame: pd.DataFrame, bad: BoolArray) -> int:
    """Return the row in the file of the first marked sample."""
    return int(frame["row"].to_numpy(np.int64)[int(np.argmax(bad))])


def numbers(path: Path | str, frame: pd.DataFrame, column: str) -> pd.Series:
    """Return a column of numbers; an empty cell is nan.

    Raises
    ------
    RecordingError
        For a text that is not a number; the message names its row.
    """
    values = pd.to_numeric(frame[column], errors="coerce").astype("float64")
    bad = (values.isna() & frame[column].notna()).to_numpy()
    if bad.any():
        raise RecordingError(
            f"{path}: row {row_of(frame, bad)}: {column}: expected a number, "
            f"got {frame[column].to_list()[int(bad.argmax())]!r}"
        )
    return values


def classes(path: Path | str, frame: pd.DataFrame, column: str) -> pd.Series:
    """Return a column of classes, translated to the names in `CLASSES`.

    Raises
    ------
    RecordingError
        For an unknown class; the message names its row.
    """
    names = frame[column].astype(str)
    known = {name: class_of(name) for name in names.unique()}
    found = names.map(known)
    bad = found.isna().to_numpy()
    if bad.any():
        raise RecordingError(
            f"{path}: row {row_of(frame, bad)}: unknown class {names.to_list()[int(bad.argmax())]!r}; "
            "expected one of "
            f"{', '.join(CLASSES)}"
        )
    return found
