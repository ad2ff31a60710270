"""Reads a recorded run and refuses one that cannot be judged, naming file, column and row."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Set
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.errors import DamageError, RecordingError
from analysis.files import read_json
from analysis.recording.columns import (
    EGOS,
    NEIGHBOURS,
    SCHEMA_VERSION,
    SENSING,
    TIMING,
    RecordedTable,
)
from analysis.recording.extent import EVERYBODY
from analysis.recording.levels import Levels, levels_of
from analysis.recording.opening import opened_table

_NEEDED_META = ("run_id", "scenario_id", "config_id", "controller", "seed", "step_s")
_FACTS = ("on_foot", "lanes", "speed_limit_mps", "refuge", "longitude_deg", "latitude_deg")
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

    def picked(self, rows: IntArray) -> Texts:
        """Return some of the rows, with only the names that occur in them."""
        codes = self.codes[rows]
        left = np.unique(codes[codes >= 0])
        anew = np.full(len(self.names) + 1, -1, dtype=np.int64)  # the last one is for -1
        anew[left] = np.arange(len(left))
        return Texts(anew[codes], tuple(self.names[code] for code in left.tolist()))


@dataclass(frozen=True, slots=True)
class Columns:
    """Some rows of a recorded table in file order; undefined numbers are nan, undefined flags False."""

    numbers: Mapping[str, FloatArray]
    flags: Mapping[str, BoolArray]
    texts: Mapping[str, Texts]

    def __len__(self) -> int:
        return len(self.numbers["time_s"])

    def picked(self, rows: IntArray) -> Columns:
        """Return some of the rows."""
        return Columns(
            {name: values[rows] for name, values in self.numbers.items()},
            {name: values[rows] for name, values in self.flags.items()},
            {name: values.picked(rows) for name, values in self.texts.items()},
        )


@dataclass(frozen=True, slots=True)
class Area:
    """A lane, crossing or walking area of map.json."""

    name: str
    kind: str
    crossing_kind: str
    width_m: float
    shape: FloatArray
    crossed: tuple[str, ...] = ()
    """Edges that lead over or under it."""
    facts: Mapping[str, Any] = field(default_factory=dict)
    """Further values of a crossing, by their names in map.json; older recordings have none."""


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
    levels: Levels
    """Which edges of the map lead over or under each other."""
    sensing: Columns | None = None
    """What egos knew of pedestrians; ``None`` where they knew the truth."""
    largest: tuple[float, float] = (0.0, 0.0)
    """In a part of a recording, the largest values of the whole recording: half the diagonal of a vehicle and
    half the width of a pedestrian [m]."""
    places: Set[str] = frozenset()
    """In a part of a recording, the edges and lanes on which a road user was in the whole recording."""
    bystanders: Columns | None = None
    """In a part of a recording, the egos of other parts that were recorded at the same time."""
    left_out: IntArray | None = None
    """In a part of a recording, the number of rows left out before each row of ``neighbours``, because they
    repeat the row before of the same vehicle."""

    def crossings(self) -> tuple[Area, ...]:
        """Return the crossings of the map."""
        return tuple(area for area in self.areas if area.kind == "crossing")


def _edge_of(area: Area) -> str:
    return area.name.rpartition("_")[0] if area.kind == "lane" else area.name


def read_run(folder: Path) -> RecordedRun:
    """Read and check a run folder.

    Raises
    ------
    RecordingError
        When a file is missing, truncated, of another schema version, lacks a column, has no rows, an
        undefined number where one is needed, or time going backwards.
    """
    run = read_rides(folder)
    neighbours = read_table(folder, NEIGHBOURS)
    sensing = read_table(folder, SENSING) if senses(run) else None
    times = all_times(run.times, neighbours.numbers["time_s"])
    return replace(run, times=times, neighbours=neighbours, sensing=sensing)


def read_rides(folder: Path) -> RecordedRun:
    """Read and check a run folder, except for what was near its egos and what they knew of it.

    Raises
    ------
    RecordingError
        As `read_run`.
    """
    if not folder.is_dir():
        raise RecordingError(f"{folder}: no such run folder")
    meta = _read_json(folder / "run.json")
    version = meta.get("recording_schema_version")
    if str(version) != SCHEMA_VERSION:
        raise RecordingError(
            f"{folder / 'run.json'}: recording_schema_version is {version!r}, "
            f"this version reads {SCHEMA_VERSION!r}"
        )
    for key in _NEEDED_META:
        if meta.get(key) is None:
            raise RecordingError(f"{folder / 'run.json'}: no value for {key!r}")
    step_s = meta["step_s"]
    if not isinstance(step_s, int | float) or not math.isfinite(step_s) or step_s <= 0.0:
        raise RecordingError(f"{folder / 'run.json'}: step_s must be a positive number, is {step_s!r}")
    egos = read_table(folder, EGOS)
    if len(egos) == 0 and meta.get("record") != EVERYBODY:
        raise RecordingError(f"{folder / EGOS.file}: no rows")
    timing = read_table(folder, TIMING)
    areas = read_map(folder)
    levels = levels_of({_edge_of(area): area.crossed for area in areas if area.crossed})
    times = all_times(egos.numbers["time_s"])
    nobody = declared_columns(NEIGHBOURS, 0, Columns({}, {}, {}))
    return RecordedRun(folder, meta, float(step_s), times, egos, nobody, timing, areas, levels)


def all_times(*times: FloatArray) -> FloatArray:
    """Return recorded instants, ascending, each once [s]."""
    return np.unique(np.round(np.concatenate(times), 6))


def senses(run: RecordedRun) -> bool:
    """Return whether the egos' knowledge of pedestrians is recorded: their sensing was not perfect."""
    return str(run.meta.get("sensing") or _PERFECT) != _PERFECT


def _read_json(path: Path) -> dict[str, Any]:
    try:
        return read_json(path)
    except DamageError:
        raise
    except FileNotFoundError:
        raise RecordingError(f"{path}: no such file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"{path}: cannot be read ({error})") from None
    except json.JSONDecodeError as error:
        raise RecordingError(
            f"{path}: truncated or not JSON (line {error.lineno}, column {error.colno}: {error.msg})"
        ) from None
    except ValueError as error:
        raise RecordingError(f"{path}: {error}") from None


def read_table(folder: Path, declared: RecordedTable) -> Columns:
    """Return the judged columns; there is one row for each time and value of the key columns.

    Raises
    ------
    RecordingError
        As `read_run`.
    """
    path = folder / declared.file
    with opened_table(path) as file:
        checked_schema(path, declared, file)
        return all_rows(path, declared, file)


def all_rows(path: Path, declared: RecordedTable, file: pq.ParquetFile) -> Columns:
    """Return the judged columns of an opened file, whose schema was checked.

    Raises
    ------
    RecordingError
        As `checked_rows`.
    """
    return checked_rows(path, declared, completed(declared, file.read(judged_names(declared, file))))


def judged_names(declared: RecordedTable, file: pq.ParquetFile) -> list[str]:
    """Return the names of the columns of a file that are judged."""
    present = set(file.schema_arrow.names)
    return [column.name for column in declared.columns if column.judged and column.name in present]


def declared_columns(declared: RecordedTable, count: int, given: Columns) -> Columns:
    """Return the judged columns of a table; columns that are not given are undefined."""
    judged = [column for column in declared.columns if column.judged]
    undefined, never = np.full(count, np.nan), np.zeros(count, dtype=np.bool_)  # shared, hence read-only
    undefined.flags.writeable = never.flags.writeable = False
    numbers: dict[str, FloatArray] = {}
    for column in judged:
        if column.kind in ("number", "integer"):
            numbers[column.name] = given.numbers.get(column.name, undefined)
    nothing = Texts(np.full(count, -1, dtype=np.int64), ())
    return Columns(
        numbers,
        {one.name: given.flags.get(one.name, never) for one in judged if one.kind == "boolean"},
        {one.name: given.texts.get(one.name, nothing) for one in judged if one.kind == "string"},
    )


def checked_schema(path: Path, declared: RecordedTable, file: pq.ParquetFile) -> None:
    """Refuse a file that lacks a column, or has one of another type.

    Raises
    ------
    RecordingError
        If the file does.
    """
    present = file.schema_arrow
    for column in declared.columns:
        if column.name not in present.names:
            if column.added:
                continue
            raise RecordingError(f"{path}: no column {column.name!r}")
        found = present.field(column.name).type
        if found != column.dtype:
            raise RecordingError(f"{path}: column {column.name!r} is {found}, expected {column.dtype}")


def completed(declared: RecordedTable, table: pa.Table) -> pa.Table:
    """Return a table with empty columns added for the judged columns that early recordings lack."""
    for column in declared.columns:
        if column.judged and column.name not in table.column_names:
            table = table.append_column(column.name, pa.nulls(len(table), column.dtype))
    return table


def checked_rows(path: Path, declared: RecordedTable, table: pa.Table, before: int = 0) -> Columns:
    """Return the judged columns of rows that follow after ``before`` others of a file.

    Raises
    ------
    RecordingError
        For an undefined number where one is needed, a missing name, time that goes backwards, and a second
        row of the same key at the same time.
    """
    judged = [column for column in declared.columns if column.judged]
    numbers = {
        column.name: _numbers(path, table, column.name, column.required, before)
        for column in judged
        if column.kind in ("number", "integer")
    }
    texts = {column.name: _texts(table, column.name) for column in judged if column.kind == "string"}
    flags = {
        column.name: table[column.name].fill_null(False).to_numpy().astype(np.bool_)
        for column in judged
        if column.kind == "boolean"
    }
    _require_forward_time(path, before, numbers["time_s"], *(texts[key] for key in declared.key))
    return Columns(numbers, flags, texts)


def _numbers(path: Path, table: pa.Table, name: str, needed: bool, before: int) -> FloatArray:
    values: FloatArray = table[name].cast(pa.float64()).to_numpy().astype(np.float64)
    if needed and not np.isfinite(values).all():
        row = before + int(np.argmin(np.isfinite(values)))
        raise RecordingError(f"{path}: column {name!r}, row {row + 1}: expected a number, found none")
    return values


def _texts(table: pa.Table, name: str) -> Texts:
    encoded = table[name].combine_chunks().dictionary_encode()
    codes = encoded.indices.fill_null(-1).to_numpy(zero_copy_only=False).astype(np.int64)
    return Texts(codes, tuple(encoded.dictionary.to_pylist()))


def _require_forward_time(path: Path, before: int, time: FloatArray, *keys: Texts) -> None:
    steps = np.diff(time)
    if (steps < 0.0).any():
        row = int(np.argmax(steps < 0.0)) + 1
        raise RecordingError(
            f"{path}: column 'time_s', row {before + row + 1}: time goes backwards "
            f"from {time[row - 1]:g} s to {time[row]:g} s"
        )
    codes = np.array([key.codes for key in keys])
    if (codes < 0).any():
        raise RecordingError(f"{path}: row {before + int(np.argmax((codes < 0).any(axis=0))) + 1}: no name")
    order = np.lexsort((np.arange(len(time)), *codes))
    same = (np.diff(codes[:, order]) == 0).all(axis=0) & (np.diff(time[order]) <= 1e-9)
    if same.any():
        row = int(order[int(np.argmax(same)) + 1])
        names = ", ".join(repr(key.at(row)) for key in keys)
        raise RecordingError(
            f"{path}: column 'time_s', row {before + row + 1}: {names} has a second row at {time[row]:g} s"
        )


def read_map(folder: Path) -> tuple[Area, ...]:
    """Return lanes, crossings and walking areas of a run's folder.

    Raises
    ------
    RecordingError
        When map.json is missing or not what it should be.
    """
    path = folder / "map.json"
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
            tuple(str(name) for name in entry.get("crossed") or ()),
            {name: entry[name] for name in _FACTS if entry.get(name) is not None},
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise RecordingError(f"{path}: area {number}: {error!r}") from None
    if shape.ndim != 2 or shape.shape[1] != 2 or not np.isfinite(shape).all():
        raise RecordingError(f"{path}: area {number} ({area.name}): shape_m must be a list of [x, y]")
    if area.crossing_kind not in _CROSSING_KINDS:
        raise RecordingError(f"{path}: area {number} ({area.name}): crossing_kind {area.crossing_kind!r}")
    return area
