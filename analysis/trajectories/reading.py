"""Reads trajectories of any known layout, which is recognised by the content of the file."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import IO, Any

import numpy as np
import pandas as pd

from analysis.errors import RecordingError
from analysis.trajectories import dlr, fcd, levelxd, plain_csv
from analysis.trajectories.checks import sorted_and_checked
from analysis.trajectories.table import DEGREES, Trajectories, with_motion

_GZIP, _ZIP, _PARQUET = b"\x1f\x8b", b"PK", b"PAR1"


def read_trajectories(source: Path | str, crs: str | None = None) -> Trajectories:
    """Return the trajectories in a file.

    Parameters
    ----------
    source : a plain CSV, the DLR Urban Traffic dataset (CSV or archive; ``tasi`` for that of the package),
        ``NN_tracks.csv`` of inD, rounD or uniD, or SUMO's floating car data
    crs : coordinate system of the positions, as pyproj takes it; replaces that of the layout

    Raises
    ------
    RecordingError
        For a file that cannot be used; the message is one line with the file, the row and what was expected.
    """
    path = dlr.packaged() if str(source) == dlr.PACKAGED else Path(source)
    found = _read(path)
    if crs is not None:
        found = replace(found, crs=crs)
    degrees = found.crs == DEGREES
    frame = found.frame
    if degrees:
        # Positions in degrees are checked once they are converted to metres: jumps cannot be told in degrees.
        return found
    return found.with_frame(with_motion(sorted_and_checked(frame, found.source)), found.crs)


def _read(path: Path) -> Trajectories:
    try:
        with path.open("rb") as file:
            start = file.read(512)
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read ({error.strerror})") from None
    with ExitStack() as stack:
        source: Path | IO[bytes] = path
        if start.startswith(_ZIP):
            archive, member = dlr.open_archive(path)
            stack.enter_context(archive)
            source = stack.enter_context(member)
        elif start.startswith(_GZIP) or start.lstrip().startswith(b"<"):
            return fcd.read_fcd(path)
        table = _parquet(path) if start.startswith(_PARQUET) else _table(path, source, start)
    if fcd.MARK in table.columns:
        return fcd.of_table(path, table)
    if dlr.MARK in table.columns:
        return dlr.of_table(path, table)
    if levelxd.MARK in table.columns:
        return levelxd.of_table(path, table)
    return plain_csv.of_table(path, table)


def _table(path: Path, source: Path | IO[bytes], start: bytes) -> pd.DataFrame:
    texts: dict[str, Any] = dict.fromkeys(("id", "trackId", "vehicle_id", "vehicle_lane"), str)
    separator = ";" if start.startswith(f"{fcd.MARK};".encode()) else ","
    try:
        table = pd.read_csv(source, dtype=texts, sep=separator)
    except (OSError, ValueError) as error:
        raise RecordingError(f"{path}: not a table of comma-separated values ({error})") from None
    table["row"] = np.arange(2, len(table) + 2)
    return table


def _parquet(path: Path) -> pd.DataFrame:
    try:
        table = pd.read_parquet(path)
    except (OSError, ValueError) as error:
        raise RecordingError(f"{path}: not a readable Parquet file ({error})") from None
    table["row"] = np.arange(1, len(table) + 1)
    return table
