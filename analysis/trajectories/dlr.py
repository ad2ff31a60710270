"""The layout of the DLR Urban Traffic dataset, version 1.2.0 [DLR2024]_: UTM 32N, 20 Hz, UTC.

The wheel of the Python package ``tasi`` holds 15 minutes of it.
"""

from __future__ import annotations

import zipfile
from importlib import metadata
from pathlib import Path
from typing import IO

import numpy as np
import pandas as pd

from analysis.errors import RecordingError
from analysis.trajectories.columns import numbers, require
from analysis.trajectories.table import Trajectories

MARK = "center_easting"
CRS = "EPSG:32632"
PACKAGED = "tasi"
"""Package that holds the recording; its name stands for the recording."""
_CLASSES = {
    "classifications_pedestrian": "pedestrian",
    "classifications_bicycle": "bicycle",
    "classifications_motorbike": "motorcycle",
    "classifications_car": "car",
    "classifications_van": "van",
    "classifications_truck": "truck",
}
_NUMBERS = {
    "x_m": "center_easting",
    "y_m": "center_northing",
    "speed_mps": "velocity_magnitude",
    "heading_rad": "yaw",
    "length_m": "dimension_length",
    "width_m": "dimension_width",
}


def packaged() -> Path:
    """Return the archive in the package ``tasi``, without importing it: the import would contact a server.

    Raises
    ------
    RecordingError
        When the package is not installed, or holds no such archive.
    """
    try:
        files = metadata.files(PACKAGED) or []
    except metadata.PackageNotFoundError:
        raise RecordingError(
            f"{PACKAGED}: not installed; it holds the recording: pip install --no-deps {PACKAGED}==0.15.4"
        ) from None
    for file in files:
        if file.name.startswith("DLR-Urban-Traffic") and file.suffix == ".zip":
            return Path(str(file.locate()))
    raise RecordingError(f"{PACKAGED}: holds no archive of the DLR Urban Traffic dataset")


def open_archive(path: Path) -> tuple[zipfile.ZipFile, IO[bytes]]:
    """Return an archive of the dataset and the trajectories in it, both open.

    Raises
    ------
    RecordingError
        When it is not an archive, or does not hold one table of trajectories.
    """
    try:
        archive = zipfile.ZipFile(path)
    except (OSError, zipfile.BadZipFile) as error:
        raise RecordingError(f"{path}: cannot be read as an archive ({error})") from None
    names = [name for name in archive.namelist() if "/trajectories/" in name and name.endswith(".csv")]
    if len(names) != 1:
        archive.close()
        raise RecordingError(f"{path}: expected one table of trajectories, found {len(names)}")
    return archive, archive.open(names[0])


def of_table(path: Path, table: pd.DataFrame) -> Trajectories:
    """Return the trajectories of a table of the dataset; time counts from the last full second before them.

    The class of a road user is the one with the highest mean probability over the track.

    Raises
    ------
    RecordingError
        For a missing column, or a cell that is not a number.
    """
    needed = ["timestamp", "id", *_NUMBERS.values(), *_CLASSES]
    require(path, (name for name in table.columns if name != "row"), needed, "DLR Urban Traffic")
    made = pd.DataFrame({"id": table["id"].astype(str)})
    kinds = table[list(_CLASSES)].groupby(made["id"]).mean().idxmax(axis=1).map(_CLASSES)
    made["kind"] = made["id"].map(kinds)
    try:
        stamps = pd.to_datetime(table["timestamp"], utc=True, format="ISO8601")
    except ValueError as error:
        raise RecordingError(f"{path}: timestamp: {error}") from None
    made["time_s"] = (stamps - stamps.min().floor("s")).dt.total_seconds()
    for name, column in _NUMBERS.items():
        made[name] = numbers(path, table, column)
    made["heading_rad"] = np.radians(made["heading_rad"])
    made["row"] = table["row"]
    return Trajectories(made, str(path), CRS, "dlr", bodies_known=False)
