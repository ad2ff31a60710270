"""What a recording of all traffic holds, found out row group by row group: who was there, and when."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Set
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from analysis.arrays import FloatArray
from analysis.errors import RecordingError
from analysis.recording.reading import Columns

VEHICLE, PEDESTRIAN = "vehicle", "pedestrian"


class Seen(NamedTuple):
    """First and last row group in which somebody is, and since and until when."""

    first: int
    last: int
    since_s: float
    until_s: float


@dataclass(slots=True)
class Index:
    """Who is in which row groups of a recording."""

    pedestrians: dict[str, Seen] = field(default_factory=dict)
    vehicles: dict[str, Seen] = field(default_factory=dict)
    """Those that are no egos."""
    classes: dict[str, str] = field(default_factory=dict)
    """SUMO's class of each vehicle, egos included."""
    begins: list[float] = field(default_factory=list)
    """First instant of each row group [s]."""
    rows: list[int] = field(default_factory=list)
    """Number of rows of each row group."""
    times: FloatArray = field(default_factory=lambda: np.zeros(0))
    """All recorded instants [s]."""
    largest: tuple[float, float] = (0.0, 0.0)
    """Half the longest diagonal of a vehicle that is no ego; half the greatest width of a pedestrian [m]."""


def index_of(path: Path, groups: Iterable[Columns], egos: Set[str]) -> Index:
    """Return the index of a recording's row groups.

    Raises
    ------
    RecordingError
        Where time goes backwards from one to the next.
    """
    index, times = Index(), []
    last = -np.inf
    for number, rows in enumerate(groups):
        index.rows.append(len(rows))
        if not len(rows):
            index.begins.append(last)
            continue
        time = rows.numbers["time_s"]
        if time[0] < last:
            raise RecordingError(
                f"{path}: column 'time_s', row {sum(index.rows[:-1]) + 1}: time goes backwards "
                f"from {last:g} s to {time[0]:g} s"
            )
        last = float(time[-1])
        index.begins.append(float(np.round(time[0], 6)))
        times.append(np.unique(np.round(time, 6)))
        _add(index, number, rows, egos)
    if times:
        index.times = np.unique(np.concatenate(times))
    return index


def _add(index: Index, number: int, rows: Columns, egos: Set[str]) -> None:
    kinds, names = rows.texts["object_kind"], rows.texts["object_id"]
    time, length, width = (rows.numbers[name] for name in ("time_s", "length_m", "width_m"))
    vehicles, people = np.flatnonzero(kinds.equal(VEHICLE)), np.flatnonzero(kinds.equal(PEDESTRIAN))
    firsts = vehicles[np.unique(names.codes[vehicles], return_index=True)[1]]
    for row in firsts.tolist():
        index.classes.setdefault(names.at(row), rows.texts["vehicle_class"].at(row))
    own = np.array([name in egos for name in names.names], dtype=np.bool_)
    others = vehicles[~own[names.codes[vehicles]]]
    for known, chosen in ((index.vehicles, others), (index.pedestrians, people)):
        codes, first = np.unique(names.codes[chosen], return_index=True)
        last = len(chosen) - 1 - np.unique(names.codes[chosen][::-1], return_index=True)[1]
        since, until = time[chosen[first]].tolist(), time[chosen[last]].tolist()
        for code, one, other in zip(codes.tolist(), since, until, strict=True):
            name = names.names[code]
            before = known.get(name)
            known[name] = Seen(
                number if before is None else before.first,
                number,
                one if before is None else before.since_s,
                other,
            )
    index.largest = (
        max(index.largest[0], float((0.5 * np.hypot(length[others], width[others])).max(initial=0.0))),
        max(index.largest[1], float((0.5 * width[people]).max(initial=0.0))),
    )


def around(vehicles: Mapping[str, Seen], people: Iterable[Seen]) -> set[str]:
    """Return the vehicles that were there between the first and the last of some pedestrians."""
    spans = list(people)
    if not spans:
        return set()
    since, until = min(one.since_s for one in spans), max(one.until_s for one in spans)
    return {name for name, seen in vehicles.items() if seen.since_s <= until and since <= seen.until_s}
