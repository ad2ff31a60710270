"""All traffic near crossings of a recorded run, read so that every vehicle takes the place of an ego.

Egos themselves are left out: they are judged from their own recording.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from analysis.arrays import FloatArray, IntArray
from analysis.recording.columns import EGOS, TRAFFIC, RecordedTable
from analysis.recording.reading import Columns, RecordedRun, Texts, read_table


def has_traffic(folder: Path) -> bool:
    """Return whether a run's folder holds the traffic near crossings."""
    return (folder / TRAFFIC.file).is_file()


@dataclass(frozen=True, slots=True)
class Traffic:
    """All traffic near crossings of a run."""

    run: RecordedRun
    """The run with all other vehicles for egos."""
    classes: Mapping[str, str]
    """SUMO's class of each vehicle, egos included."""


def read_traffic(run: RecordedRun) -> Traffic:
    """Return the traffic near the crossings of a run.

    Raises
    ------
    RecordingError
        As :func:`analysis.recording.reading.read_run`.
    """
    table = read_table(run.folder, TRAFFIC)
    kinds, egos = table.texts["object_kind"], set(run.egos.texts["ego_id"].names)
    names = table.texts["object_id"]
    own = np.array([name in egos for name in names.names], dtype=np.bool_)
    vehicles = np.flatnonzero(kinds.equal("vehicle") & ~own[names.codes])
    pedestrians = np.flatnonzero(kinds.equal("pedestrian"))
    everything = np.flatnonzero(kinds.equal("vehicle"))
    firsts = everything[np.unique(names.codes[everything], return_index=True)[1]]
    classes = {names.at(int(row)): table.texts["vehicle_class"].at(int(row)) for row in firsts}
    others = replace(
        run,
        times=np.unique(np.round(table.numbers["time_s"], 6)),
        egos=_as_egos(table, vehicles),
        neighbours=_columns(TRAFFIC, len(pedestrians), _picked(table, pedestrians)),
        sensing=None,
    )
    return Traffic(others, classes)


def _as_egos(table: Columns, rows: IntArray) -> Columns:
    picked = _picked(table, rows)
    numbers = picked.numbers
    speed = np.hypot(numbers["x_speed_mps"], numbers["y_speed_mps"])
    as_ego = {
        "front_x_m": numbers["x_m"],
        "front_y_m": numbers["y_m"],
        "speed_mps": speed,
    }
    texts = {"ego_id": picked.texts["object_id"], "lane": picked.texts["edge_or_lane"]}
    return _columns(EGOS, len(rows), Columns({**numbers, **as_ego}, picked.flags, {**picked.texts, **texts}))


def _picked(table: Columns, rows: IntArray) -> Columns:
    return Columns(
        {name: values[rows] for name, values in table.numbers.items()},
        {name: values[rows] for name, values in table.flags.items()},
        {name: Texts(values.codes[rows], values.names) for name, values in table.texts.items()},
    )


def _columns(declared: RecordedTable, count: int, given: Columns) -> Columns:
    """Return the judged columns of a table; those that are not given are undefined."""
    judged = [column for column in declared.columns if column.judged]
    numbers: dict[str, FloatArray] = {}
    for column in judged:
        if column.kind in ("number", "integer"):
            numbers[column.name] = given.numbers.get(column.name, np.full(count, np.nan))
    nothing = Texts(np.full(count, -1, dtype=np.int64), ())
    return Columns(
        numbers,
        {
            one.name: given.flags.get(one.name, np.zeros(count, dtype=np.bool_))
            for one in judged
            if one.kind == "boolean"
        },
        {one.name: given.texts.get(one.name, nothing) for one in judged if one.kind == "string"},
    )
