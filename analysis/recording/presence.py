"""Which pedestrians and vehicles are in a recorded table, and when, found row group by row group."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Set
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.recording.reading import Columns

VEHICLE, PEDESTRIAN = "vehicle", "pedestrian"


class Seen(NamedTuple):
    """First and last row group in which a road user is recorded, and the first and last time."""

    first: int
    last: int
    since_s: float
    until_s: float


@dataclass(slots=True)
class Index:
    """Which road users are in which row groups of a recording."""

    pedestrians: dict[str, Seen] = field(default_factory=dict)
    vehicles: dict[str, Seen] = field(default_factory=dict)
    """Vehicles that are not egos, if the egos' names are known."""
    classes: dict[str, str] = field(default_factory=dict)
    """SUMO's class of each vehicle, egos included; empty where none is recorded."""
    places: set[str] = field(default_factory=set)
    """Edges and lanes on which a road user was."""
    begins: list[float] = field(default_factory=list)
    """First instant of each row group [s]."""
    rows: list[int] = field(default_factory=list)
    """Number of rows of each row group."""
    times: FloatArray = field(default_factory=lambda: np.zeros(0))
    """All recorded instants [s]."""
    at_once: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """Number of rows at each instant, without those of standing vehicles."""
    largest: tuple[float, float] = (0.0, 0.0)
    """Half the longest diagonal of a vehicle in ``vehicles``; half the greatest width of a pedestrian [m]."""


def index_of(groups: Iterable[Columns], egos: Set[str] = frozenset()) -> Index:
    """Return the index of a recording's row groups.

    Parameters
    ----------
    groups : Iterable
        Rows of each group.
    egos : Set
        Names of vehicles that are left out of ``vehicles``.
    """
    index, times = Index(), []
    last = -np.inf
    for number, rows in enumerate(groups):
        index.rows.append(len(rows))
        if not len(rows):
            index.begins.append(last)
            continue
        time = rows.numbers["time_s"]
        last = float(time[-1])
        index.begins.append(float(np.round(time[0], 6)))
        instants, which = np.unique(np.round(time, 6), return_inverse=True)
        times.append((instants, np.bincount(which, ~_stands(rows))))
        index.places.update(rows.texts["edge_or_lane"].names)
        _add(index, number, rows, egos)
    if times:
        index.times, which = np.unique(np.concatenate([one for one, _ in times]), return_inverse=True)
        counts = np.concatenate([count for _, count in times])
        index.at_once = np.bincount(which, counts).astype(np.int64)
    return index


def _add(index: Index, number: int, rows: Columns, egos: Set[str]) -> None:
    kinds, names = rows.texts["object_kind"], rows.texts["object_id"]
    time, length, width = (rows.numbers[name] for name in ("time_s", "length_m", "width_m"))
    vehicles, people = np.flatnonzero(kinds.equal(VEHICLE)), np.flatnonzero(kinds.equal(PEDESTRIAN))
    if (classes := rows.texts.get("vehicle_class")) is not None:
        firsts = vehicles[np.unique(names.codes[vehicles], return_index=True)[1]]
        for row in firsts.tolist():
            index.classes.setdefault(names.at(row), classes.at(row))
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


def _stands(rows: Columns) -> BoolArray:
    still = (rows.numbers["x_speed_mps"] == 0.0) & (rows.numbers["y_speed_mps"] == 0.0)
    return np.asarray(still & rows.texts["object_kind"].equal(VEHICLE))


def around(everybody: Mapping[str, Seen], spans: Iterable[Seen]) -> set[str]:
    """Return the road users recorded between the earliest beginning and the latest end of some spans."""
    some = list(spans)
    if not some:
        return set()
    since, until = min(one.since_s for one in some), max(one.until_s for one in some)
    return {name for name, seen in everybody.items() if seen.since_s <= until and since <= seen.until_s}


def span_of(some: Iterable[Seen]) -> range:
    """Return the row groups from the first to the last one of some road users."""
    listed = list(some)
    first = min((one.first for one in listed), default=0)
    return range(first, 1 + max((one.last for one in listed), default=first - 1))
