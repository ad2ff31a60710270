"""Reads a recorded run and refuses one that cannot be judged, naming file, column and row."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from analysis import recording
from analysis.errors import RecordingError
from analysis.geometry import BoolArray, FloatArray

IntArray = NDArray[np.int64]

_NEEDED_META = ("run_id", "scenario_id", "config_id", "controller", "seed", "step_s")
_EGO_NUMBERS = (
    "time_s",
    "length_m",
    "width_m",
    "front_x_m",
    "front_y_m",
    "heading_rad",
    "speed_mps",
    "acceleration_mps2",
)
_EGO_OPTIONAL = ("speed_limit_mps", "route_position_m", "lane_number", "gap_ahead_m", "slack_m")
_EGO_FLAGS = ("intervention", "handed_back", "planned", "solved")
_EGO_TEXTS = ("ego_id", "lane", "rule", "plan_status", "passing", "intervention_cause")
_OBJECT_NUMBERS = ("time_s", "x_m", "y_m", "x_speed_mps", "y_speed_mps", "length_m", "width_m")
_OBJECT_TEXTS = ("object_id", "object_kind", "object_type", "edge_or_lane", "crossing_id", "phase")
_PERFECT = "perfect"
_CROSSING_KINDS = ("zebra", "unmarked", "signal", "")


@dataclass(frozen=True, slots=True)
class Texts:
    """A column of texts as codes; −1 where the recorded value is null."""

    codes: IntArray
    names: tuple[str, ...]

    def equal(self, text: str, rows: IntArray | None = None) -> BoolArray:
        """Return where the column, or the given rows of it, holds that text."""
        codes = self.codes if rows is None else self.codes[rows]
        if text not in self.names:
            return np.zeros(len(codes), dtype=np.bool_)
        return np.asarray(codes == self.names.index(text))

    def at(self, row: int) -> str:
        """Return the text of a row, empty for null."""
        code = int(self.codes[row])
        return self.names[code] if code >= 0 else ""


@dataclass(frozen=True, slots=True)
class Columns:
    """Some rows of a recorded table in file order; undefined numbers are nan, undefined flags False."""

    numbers: Mapping[str, FloatArray]
    flags: Mapping[str, BoolArray]
    texts: Mapping[str, Texts]

    def __len__(self) -> int:
        return len(self.numbers["time_s"])


@dataclass(frozen=True, slots=True)
class Area:
    """A lane, crossing or walking area of map.json."""

    name: str
    kind: str
    crossing_kind: str
    width_m: float
    shape: FloatArray


@dataclass(frozen=True, slots=True)
class RecordedRun:
    """One recorded run, as it was written."""

    folder: Path
    meta: Mapping[str, Any]
    step_s: float
    times: FloatArray
    """All recorded instants, ascending [s]."""
    egos: Columns
    neighbours: Columns
    timing: Columns
    areas: tuple[Area, ...]
    sensing: Columns | None = None
    """What egos knew of pedestrians; ``None`` where they knew the truth."""

    def crossings(self) -> tuple[Area, ...]:
        """Return the crossings of the map."""
        return tuple(area for area in self.areas if area.kind == "crossing")


def read_run(folder: Path) -> RecordedRun:
    """Read and check a run folder.

    Raises
    ------
    RecordingError
        When a file is missing, truncated, of another schema version, lacks a column, has no rows, an
        undefined number where one is needed, or time going backwards.
    """
    if not folder.is_dir():
        raise RecordingError(f"{folder}: no such run folder")
    meta = _read_json(folder / "run.json")
    version = meta.get("recording_schema_version")
    if str(version) != recording.SCHEMA_VERSION:
        raise RecordingError(
            f"{folder / 'run.json'}: recording_schema_version is {version!r}, "
            f"this version reads {recording.SCHEMA_VERSION!r}"
        )
    for key in _NEEDED_META:
        if meta.get(key) is None:
            raise RecordingError(f"{folder / 'run.json'}: no value for {key!r}")
    step_s = meta["step_s"]
    if not isinstance(step_s, int | float) or not math.isfinite(step_s) or step_s <= 0.0:
        raise RecordingError(f"{folder / 'run.json'}: step_s must be a positive number, is {step_s!r}")
    egos = _read_table(
        folder / "egos.parquet", recording.EGOS, _EGO_NUMBERS, _EGO_OPTIONAL, _EGO_FLAGS, _EGO_TEXTS, "ego_id"
    )
    if len(egos) == 0:
        raise RecordingError(f"{folder / 'egos.parquet'}: no rows")
    neighbours = _read_table(
        folder / "neighbours.parquet",
        recording.NEIGHBOURS,
        _OBJECT_NUMBERS,
        ("heading_rad",),
        (),
        _OBJECT_TEXTS,
        "object_kind",  # SUMO lets a vehicle and a person share an id
        "object_id",
    )
    timing = _read_table(
        folder / "timing.parquet", recording.TIMING, ("time_s", "compute_ms"), (), (), ("ego_id",), "ego_id"
    )
    times = np.unique(np.round(np.concatenate([egos.numbers["time_s"], neighbours.numbers["time_s"]]), 6))
    areas = _read_areas(folder / "map.json")
    sensing = _read_sensing(folder / "sensing.parquet", str(meta.get("sensing") or _PERFECT))
    return RecordedRun(folder, meta, float(step_s), times, egos, neighbours, timing, areas, sensing)


def _read_sensing(path: Path, model: str) -> Columns | None:
    if model == _PERFECT:
        return None
    return _read_table(
        path, recording.SENSING, ("time_s",), (), ("told",), ("ego_id", "object_id"), "ego_id", "object_id"
    )


def _read_json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text("utf-8"))
    except FileNotFoundError:
        raise RecordingError(f"{path}: no such file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"{path}: cannot be read ({error})") from None
    except json.JSONDecodeError as error:
        raise RecordingError(
            f"{path}: truncated or not JSON (line {error.lineno}, column {error.colno}: {error.msg})"
        ) from None
    if not isinstance(content, dict):
        raise RecordingError(f"{path}: expected an object, found {type(content).__name__}")
    return content


def _read_table(
    path: Path,
    schema: pa.Schema,
    numbers: tuple[str, ...],
    optional: tuple[str, ...],
    flags: tuple[str, ...],
    texts: tuple[str, ...],
    *keys: str,
) -> Columns:
    """Return the rows of a table; there is one for each time and value of the key columns."""
    table = _load(path, schema)
    found = {name: _numbers(path, table, name, needed=name in numbers) for name in (*numbers, *optional)}
    coded = {name: _texts(table, name) for name in texts}
    _require_forward_time(path, found["time_s"], *(coded[key] for key in keys))
    return Columns(
        numbers=found,
        flags={name: table[name].fill_null(False).to_numpy().astype(np.bool_) for name in flags},
        texts=coded,
    )


def _load(path: Path, schema: pa.Schema) -> pa.Table:
    if not path.is_file():
        cut = path.with_name(path.name + ".part")
        hint = f" (the run was cut off: {cut.name} is there)" if cut.exists() else ""
        raise RecordingError(f"{path}: no such file{hint}")
    try:
        with pq.ParquetFile(path) as file:
            present = file.schema_arrow
            for field in schema:
                if field.name in recording.ADDED - set(present.names):
                    continue
                if field.name not in present.names:
                    raise RecordingError(f"{path}: no column {field.name!r}")
                kind = present.field(field.name).type
                if kind != field.type:
                    raise RecordingError(f"{path}: column {field.name!r} is {kind}, expected {field.type}")
            table = file.read()
    except (pa.ArrowException, OSError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise RecordingError(f"{path}: truncated or not Parquet ({reason})") from None
    for field in schema:
        if field.name not in table.column_names:
            table = table.append_column(field, pa.nulls(len(table), field.type))
    return table


def _numbers(path: Path, table: pa.Table, name: str, needed: bool) -> FloatArray:
    values: FloatArray = table[name].cast(pa.float64()).to_numpy().astype(np.float64)
    if needed and not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values)))
        raise RecordingError(f"{path}: column {name!r}, row {row + 1}: expected a number, found none")
    return values


def _texts(table: pa.Table, name: str) -> Texts:
    encoded = table[name].combine_chunks().dictionary_encode()
    codes = encoded.indices.fill_null(-1).to_numpy(zero_copy_only=False).astype(np.int64)
    return Texts(codes, tuple(encoded.dictionary.to_pylist()))


def _require_forward_time(path: Path, time: FloatArray, *keys: Texts) -> None:
    steps = np.diff(time)
    if (steps < 0.0).any():
        row = int(np.argmax(steps < 0.0)) + 1
        raise RecordingError(
            f"{path}: column 'time_s', row {row + 1}: time goes backwards "
            f"from {time[row - 1]:g} s to {time[row]:g} s"
        )
    codes = np.array([key.codes for key in keys])
    if (codes < 0).any():
        raise RecordingError(f"{path}: row {int(np.argmax((codes < 0).any(axis=0))) + 1}: no name")
    order = np.lexsort((np.arange(len(time)), *codes))
    same = (np.diff(codes[:, order]) == 0).all(axis=0) & (np.diff(time[order]) <= 1e-9)
    if same.any():
        row = int(order[int(np.argmax(same)) + 1])
        names = ", ".join(repr(key.at(row)) for key in keys)
        raise RecordingError(
            f"{path}: column 'time_s', row {row + 1}: {names} has a second row at {time[row]:g} s"
        )


def _read_areas(path: Path) -> tuple[Area, ...]:
    listed = _read_json(path).get("areas")
    if not isinstance(listed, list):
        raise RecordingError(f"{path}: no list 'areas'")
    return tuple(_area(path, number, entry) for number, entry in enumerate(listed, start=1))


def _area(path: Path, number: int, entry: Any) -> Area:
    try:
        shape = np.asarray(entry["shape_m"], dtype=np.float64)
        area = Area(
            str(entry["name"]),
            str(entry["kind"]),
            str(entry.get("crossing_kind") or ""),
            float(entry["width_m"]),
            shape,
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise RecordingError(f"{path}: area {number}: {error!r}") from None
    if shape.ndim != 2 or shape.shape[1] != 2 or not np.isfinite(shape).all():
        raise RecordingError(f"{path}: area {number} ({area.name}): shape_m must be a list of [x, y]")
    if area.crossing_kind not in _CROSSING_KINDS:
        raise RecordingError(f"{path}: area {number} ({area.name}): crossing_kind {area.crossing_kind!r}")
    return area
