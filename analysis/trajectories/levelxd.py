"""The layout of inD, rounD and uniD: ``NN_tracks.csv`` ``_tracksMeta.csv`` and ``_recordingMeta.csv``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from analysis.errors import RecordingError
from analysis.trajectories.columns import classes, numbers, require, row_of
from analysis.trajectories.table import Trajectories

MARK = "trackId"
_TRACKS = ("trackId", "frame", "xCenter", "yCenter", "heading", "width", "length", "xVelocity", "yVelocity")
_META = ("trackId", "class")
_RECORDING = ("frameRate", "xUtmOrigin", "yUtmOrigin", "lonLocation")
_END = "_tracks.csv"


def of_table(path: Path, table: pd.DataFrame) -> Trajectories:
    """Return the trajectories of a recording.

    Parameters
    ----------
    path : path of ``NN_tracks.csv``; the two other files are in the same folder
    table : its content

    Raises
    ------
    RecordingError
        For a missing file or column, or a cell that is not a number.
    """
    require(path, (name for name in table.columns if name != "row"), _TRACKS, "inD, rounD, uniD")
    if not path.name.endswith(_END):
        raise RecordingError(
            f"{path}: expected a name that ends with {_END}, beside it those of its meta data"
        )
    meta = _beside(path, "_tracksMeta.csv", _META)
    recording = _beside(path, "_recordingMeta.csv", _RECORDING)
    first = {name: float(numbers(path, recording, name).iloc[0]) for name in _RECORDING}
    if not first["frameRate"] > 0.0:
        raise RecordingError(f"{path}: frameRate: expected a number above 0, got {first['frameRate']:g}")
    kinds = dict(zip(meta["trackId"].astype(str), classes(path, meta, "class"), strict=True))
    made = pd.DataFrame({"id": table["trackId"].astype(str)})
    made["kind"] = made["id"].map(kinds)
    unknown = made["kind"].isna().to_numpy()
    if unknown.any():
        name = made["id"].to_list()[int(unknown.argmax())]
        raise RecordingError(f"{path}: row {row_of(table, unknown)}: track {name} is not in the meta data")
    made["time_s"] = numbers(path, table, "frame") / first["frameRate"]
    made["x_m"] = numbers(path, table, "xCenter") + first["xUtmOrigin"]
    made["y_m"] = numbers(path, table, "yCenter") + first["yUtmOrigin"]
    made["speed_mps"] = np.hypot(numbers(path, table, "xVelocity"), numbers(path, table, "yVelocity"))
    heading = np.radians(numbers(path, table, "heading"))
    made["heading_rad"] = np.arctan2(np.sin(heading), np.cos(heading))
    for name, column in (("length_m", "length"), ("width_m", "width")):
        size = numbers(path, table, column)
        made[name] = size.where(size > 0.0)  # pedestrians and cyclists have no size
    made["row"] = table["row"]
    zone = int((first["lonLocation"] + 180.0) // 6.0) + 1
    return Trajectories(made, str(path), f"EPSG:{32600 + zone}", "levelxd")


def _beside(path: Path, end: str, needed: tuple[str, ...]) -> pd.DataFrame:
    other = path.with_name(path.name.removesuffix(_END) + end)
    try:
        table = pd.read_csv(other)
    except FileNotFoundError:
        raise RecordingError(f"{other}: no such file; the layout of inD has it beside {path.name}") from None
    except (OSError, ValueError) as error:
        raise RecordingError(f"{other}: cannot be read ({error})") from None
    require(other, table.columns, needed, "inD, rounD, uniD")
    table["row"] = np.arange(2, len(table) + 2)
    return table
