"""Reads a recorded run in the form that replays need."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from analysis.encounters.case import Case
from analysis.encounters.recorded_case import read_case
from analysis.errors import DamageError, RecordingError
from analysis.files import read_csv
from analysis.manifest import read_manifest, read_verified
from analysis.recording.columns import EGOS, NEIGHBOURS, PLANS, TRAFFIC, RecordedTable
from analysis.results.traffic_rows import TRAFFIC_ENCOUNTERS

RECORDING_FILES = ("egos.parquet", "neighbours.parquet", "plans.parquet", "timing.parquet", "map.json")


def has_recording(folder: Path) -> bool:
    """Return whether a run folder has, or should have, the files that a replay needs."""
    try:
        known = read_manifest(folder) or {}
    except DamageError:
        return True  # reading it will report what is wrong
    return all((folder / name).is_file() or name in known for name in RECORDING_FILES)


@dataclass(frozen=True, slots=True)
class Recording:
    """One recorded run in the form that its replays need."""

    case: Case
    egos: pd.DataFrame
    neighbours: pd.DataFrame
    plans: pd.DataFrame
    listed: Mapping[int, int]
    """Maps the number of an encounter in its table to its index in the case."""


def read_recording(folder: Path) -> Recording:
    """Read a run, analysed with the thresholds that its tables were made with.

    Raises
    ------
    RecordingError
        If the recording cannot be read.
    """
    case = read_case(folder)
    egos, neighbours, plans = (_rows(folder, table) for table in (EGOS, NEIGHBOURS, PLANS))
    return Recording(case, egos, neighbours, plans, {index + 1: index for index in range(len(case))})


def read_traffic_recording(folder: Path) -> Recording:
    """Read a run that recorded everybody as if every vehicle but the egos were an ego without plans.

    Raises
    ------
    RecordingError
        If the recording cannot be read.
    """
    case = read_case(folder, traffic=True)
    rows = _rows(folder, TRAFFIC)
    vehicles = rows[rows["object_kind"] == "vehicle"]
    driven = vehicles.rename(columns={"object_id": "ego_id", "x_m": "front_x_m", "y_m": "front_y_m"}).assign(
        speed_mps=np.hypot(vehicles["x_speed_mps"], vehicles["y_speed_mps"])
    )
    columns = [column.name for column in EGOS.columns]
    return Recording(
        case,
        driven.reindex(columns=columns).reset_index(drop=True),
        rows,
        pd.DataFrame({column.name: [] for column in PLANS.columns}),
        _listed(case, folder / TRAFFIC_ENCOUNTERS.file),
    )


def _listed(case: Case, path: Path) -> dict[int, int]:
    """Return the index of each encounter in a table, found by its participants and its start time."""
    start = case.grid.time
    index = {
        (one.ego.name, one.person.name, round(float(start[one.first]), 3)): number
        for number, one in enumerate(case.encounters)
    }
    found = {}
    for cells in read_csv(path):
        key = cells["vehicle_id"], cells["ped_id"], round(float(cells["t_start_s"]), 3)
        if key in index:
            found[int(cells["traffic_encounter_id"])] = index[key]
    return found


def _rows(folder: Path, table: RecordedTable) -> pd.DataFrame:
    path = folder / table.file
    try:
        content = pa.BufferReader(read_verified(path))
        read = pq.read_table(content, schema=table.schema, page_checksum_verification=True)
        return pd.DataFrame(read.to_pandas())
    except (OSError, pa.ArrowException) as error:
        raise RecordingError(f"{path}: cannot be read ({str(error).splitlines()[0]})") from None
