"""Writes a recorded run as a trajectory file of FHWA's SSAM, with a map of its numeric ids.

Format 1.04, little-endian without padding: a FORMAT record, a DIMENSIONS record, then for each instant a
TIMESTEP record and one VEHICLE record for each body. Pedestrians are vehicles of length and width equal
to their disc's diameter. Links and lanes are 0: conflicts are found from geometry.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from analysis.arrays import FloatArray
from analysis.errors import AnalysisError
from analysis.files import completing, write_csv
from analysis.recording.reading import Columns, RecordedRun, read_run
from analysis.sealing import seal

TRAJECTORY_FILE = "run.trj"
ID_FILE = "ssam_id_map.csv"

_FORMAT = struct.Struct("<Bcf")
_DIMENSIONS = struct.Struct("<BBfiiii")
_TIMESTEP = struct.Struct("<Bf")
_VEHICLE = struct.Struct("<BiiBffffffff")
_VERSION = 1.04
_METRIC = 1
_MARGIN_M = 10.0


@dataclass(frozen=True, slots=True)
class SsamBody:
    """One VEHICLE record [m, m/s, m/s^2]."""

    number: int
    front_x: float
    front_y: float
    rear_x: float
    rear_y: float
    length: float
    width: float
    speed: float
    acceleration: float


@dataclass(frozen=True, slots=True)
class _Rows:
    """Bodies of one table in file order."""

    time: FloatArray
    names: list[str]
    kinds: list[str]
    front_x: FloatArray
    front_y: FloatArray
    rear_x: FloatArray
    rear_y: FloatArray
    length: FloatArray
    width: FloatArray
    speed: FloatArray
    acceleration: FloatArray


def export_ssam(folder: Path) -> tuple[Path, Path]:
    """Write ``run.trj`` and ``ssam_id_map.csv`` into a run folder and return their paths.

    Raises
    ------
    RecordingError
        When the run cannot be read.
    """
    run = read_run(folder)
    tables = [_egos(run), _objects(run)]
    bodies = {body for table in tables for body in zip(table.names, table.kinds, strict=True)}
    numbers = {body: number for number, body in enumerate(sorted(bodies), start=1)}
    trajectories, ids = folder / TRAJECTORY_FILE, folder / ID_FILE
    with completing(trajectories) as part, part.open("wb") as file:
        file.writelines(_records(run, tables, numbers))
    rows = [(number, name, kind) for (name, kind), number in numbers.items()]
    write_csv(ids, ("ssam_id", "sumo_id", "type"), rows)
    seal(folder, (trajectories, ids))
    return trajectories, ids


def read_trajectories(path: Path) -> Iterator[tuple[float, list[SsamBody]]]:
    """Yield each instant [s] with its bodies, in metres.

    Raises
    ------
    AnalysisError
        When the file is truncated, of another version or in other units.
    """
    data = path.read_bytes()
    try:
        kind, order, version = _FORMAT.unpack_from(data, 0)
        if (kind, order) != (0, b"L") or abs(version - _VERSION) > 1e-3:
            raise AnalysisError(f"{path}: expected SSAM format {_VERSION}, found {order!r} {version:g}")
        kind, units, scale, *_ = _DIMENSIONS.unpack_from(data, _FORMAT.size)
        if (kind, units) != (1, _METRIC):
            raise AnalysisError(f"{path}: expected metric units, found {units}")
        yield from _instants(path, data, _FORMAT.size + _DIMENSIONS.size, scale)
    except struct.error:
        raise AnalysisError(f"{path}: truncated") from None


def _instants(path: Path, data: bytes, offset: int, scale: float) -> Iterator[tuple[float, list[SsamBody]]]:
    time: float | None = None
    bodies: list[SsamBody] = []
    while offset < len(data):
        if data[offset] == 2:
            if time is not None:
                yield time, bodies
            _, time = _TIMESTEP.unpack_from(data, offset)
            bodies = []
            offset += _TIMESTEP.size
        elif data[offset] == 3:
            _, number, _, _, *values = _VEHICLE.unpack_from(data, offset)
            bodies.append(SsamBody(number, *(value * scale for value in values[:4]), *values[4:]))
            offset += _VEHICLE.size
        else:
            raise AnalysisError(f"{path}: unknown record {data[offset]} at byte {offset}")
    if time is not None:
        yield time, bodies


def _records(
    run: RecordedRun, tables: list[_Rows], numbers: Mapping[tuple[str, str], int]
) -> Iterator[bytes]:
    yield _FORMAT.pack(0, b"L", _VERSION)
    x = np.concatenate([np.concatenate([table.front_x, table.rear_x]) for table in tables])
    y = np.concatenate([np.concatenate([table.front_y, table.rear_y]) for table in tables])
    if not len(x):  # nobody was recorded
        x = y = np.zeros(1)
    low = [int(np.floor(values.min() - _MARGIN_M)) for values in (x, y)]
    high = [int(np.ceil(values.max() + _MARGIN_M)) for values in (x, y)]
    yield _DIMENSIONS.pack(1, _METRIC, 1.0, *low, *high)
    bounds = [np.searchsorted(np.round(table.time, 6), [run.times, run.times + 1e-7]) for table in tables]
    for k, time in enumerate(run.times.tolist()):
        yield _TIMESTEP.pack(2, time)
        for table, (starts, ends) in zip(tables, bounds, strict=True):
            for i in range(int(starts[k]), int(ends[k])):
                yield _VEHICLE.pack(
                    3,
                    numbers[table.names[i], table.kinds[i]],
                    0,
                    0,
                    table.front_x[i],
                    table.front_y[i],
                    table.rear_x[i],
                    table.rear_y[i],
                    table.length[i],
                    table.width[i],
                    table.speed[i],
                    table.acceleration[i],
                )


def _names(columns: Columns, key: str) -> list[str]:
    texts = columns.texts[key]
    return [texts.names[code] if code >= 0 else "" for code in texts.codes.tolist()]


def _egos(run: RecordedRun) -> _Rows:
    number = run.egos.numbers
    cos, sin = np.cos(number["heading_rad"]), np.sin(number["heading_rad"])
    return _Rows(
        time=number["time_s"],
        names=_names(run.egos, "ego_id"),
        kinds=["ego"] * len(run.egos),
        front_x=number["front_x_m"],
        front_y=number["front_y_m"],
        rear_x=number["front_x_m"] - number["length_m"] * cos,
        rear_y=number["front_y_m"] - number["length_m"] * sin,
        length=number["length_m"],
        width=number["width_m"],
        speed=number["speed_mps"],
        acceleration=number["acceleration_mps2"],
    )


def _objects(run: RecordedRun) -> _Rows:
    """Return pedestrians and vehicles; a pedestrian is recorded by centre, a vehicle by front bumper.

    Egos are also recorded among the vehicles while another ego is near. These rows are left out, because egos
    have a table of their own.
    """
    number = run.neighbours.numbers
    person = run.neighbours.texts["object_kind"].equal("pedestrian")
    heading = np.nan_to_num(number["heading_rad"])
    cos, sin = np.cos(heading), np.sin(heading)
    ahead = np.where(person, 0.5 * number["length_m"], 0.0)
    behind = number["length_m"] - ahead
    kinds = _names(run.neighbours, "object_kind")
    names = _names(run.neighbours, "object_id")
    egos = set(_names(run.egos, "ego_id"))
    kept = np.array(
        [bool(one) or name not in egos for name, one in zip(names, person, strict=True)], np.bool_
    )
    return _Rows(
        time=number["time_s"][kept],
        names=[name for name, keep in zip(names, kept, strict=True) if keep],
        kinds=[kind for kind, keep in zip(kinds, kept, strict=True) if keep],
        front_x=(number["x_m"] + ahead * cos)[kept],
        front_y=(number["y_m"] + ahead * sin)[kept],
        rear_x=(number["x_m"] - behind * cos)[kept],
        rear_y=(number["y_m"] - behind * sin)[kept],
        length=number["length_m"][kept],
        width=number["width_m"][kept],
        speed=np.hypot(number["x_speed_mps"], number["y_speed_mps"])[kept],
        acceleration=_acceleration(run)[kept],
    )


def _acceleration(run: RecordedRun) -> FloatArray:
    """Return the acceleration of each object since its previous row; 0 at its first row [m/s^2]."""
    number = run.neighbours.numbers
    codes = np.array([run.neighbours.texts[name].codes for name in ("object_kind", "object_id")])
    order = np.lexsort((number["time_s"], *codes))
    speed = np.hypot(number["x_speed_mps"], number["y_speed_mps"])[order]
    time = number["time_s"][order]
    change = np.zeros(len(order))
    if len(order) > 1:
        same = (np.diff(codes[:, order]) == 0).all(axis=0)
        step = np.where(same, np.diff(time), 1.0)
        change[1:] = np.where(same, np.diff(speed) / step, 0.0)
    back = np.empty_like(change)
    back[order] = change
    return back
