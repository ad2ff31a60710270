"""A long run is judged in parts, in bounded memory, and its results are those of the whole."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import analysis.encounters.case
import analysis.recording.rides
from analysis.encounters.case import Case
from analysis.errors import RecordingError
from analysis.recording.columns import EGOS, NEIGHBOURS, SENSING
from analysis.recording.fine_grid import make_grid
from analysis.recording.object_tracks import Tracks
from analysis.recording.reading import RecordedRun, read_rides, read_run
from analysis.recording.rides import Rides
from analysis.results import analyse
from analysis.results.analyse import analyse_run
from analysis.thresholds import Thresholds
from tests.analysis.recorded import Ego, Person, Vehicle, line, write_run
from tests.analysis.results.test_files import FILES, read


def long_run(folder: Path) -> None:
    """Write a run in which egos, cars and pedestrians come and go, in row groups of some ten steps.

    Every ego hits somebody or meets a pedestrian whom the parked van hides; one stands in a queue throughout.
    """
    starts = [4.0 * n for n in range(10)]
    egos = [
        Ego(line(-10.0 * at, 0, 10.0, 0), name=f"ego{9 - n}", start=at, end=at + 6.0)
        for n, at in enumerate(starts)
    ]
    egos.append(Ego(line(60.0, 0, 0, 0), name="stuck"))
    persons = [
        Person(line(33.0 - 0.2 * n, -4.0 - 1.25 * at, 0, 1.25), name=f"ped{n}", start=at, end=at + 6.0)
        for n, at in enumerate(starts)
    ]
    cars = [
        Vehicle(line(-14.0 - 10.5 * at, 0.1 * n, 10.5, 0), name=f"car{9 - n}", start=at, end=at + 6.0)
        for n, at in enumerate(starts)
    ]
    van = Vehicle(line(26.0, -3.0, 0, 0), name="van", length=6.0, width=2.2)
    write_run(folder, egos, persons, [*cars, van], duration=44.0)
    for table, group in ((EGOS, 40), (NEIGHBOURS, 60)):
        path = folder / table.file
        pq.write_table(pq.read_table(path), path, row_group_size=group)


def add_sensing(folder: Path) -> None:
    """Have every ego told of every pedestrian from a time of its own on."""
    egos = pq.read_table(folder / EGOS.file).to_pylist()
    near = pq.read_table(folder / NEIGHBOURS.file).to_pylist()
    rows = [
        dict.fromkeys(SENSING.names())
        | {
            "time_s": ego["time_s"],
            "ego_id": ego["ego_id"],
            "object_id": one["object_id"],
            "told": one["time_s"] > 3.0 + 0.1 * len(ego["ego_id"]),
        }
        for ego in egos
        for one in near
        if one["time_s"] == ego["time_s"] and one["object_kind"] == "pedestrian"
    ]
    table = pa.Table.from_pylist(rows, SENSING.schema)
    pq.write_table(table, folder / SENSING.file, row_group_size=100)
    meta = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps(meta | {"sensing": "onboard"}))


@pytest.mark.long
@pytest.mark.parametrize("sensing", [pytest.param(False, marks=pytest.mark.slow), True])
def test_a_run_judged_in_parts_gives_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sensing: bool
) -> None:
    long_run(tmp_path)
    if sensing:
        add_sensing(tmp_path)
    found = []
    for at_once, least_parts in ((1_000_000, 1), (800, 3), (1, 10)):
        monkeypatch.setattr(analysis.recording.rides, "SAMPLES_AT_ONCE", at_once)
        monkeypatch.setattr(analysis.encounters.case, "SAMPLES_AT_ONCE", at_once)
        parts = [len(part.run.neighbours) for part in Rides(read_rides(tmp_path), Thresholds()).parts()]
        assert len(parts) >= least_parts
        assert min(parts) < max(parts) or least_parts == 1
        analyse_run(tmp_path)
        found.append({name: (tmp_path / name).read_bytes() for name in FILES})
    assert found[0] == found[1] == found[2]
    rows = read(tmp_path / "encounters.csv")
    assert len(rows) >= 10
    assert {"0", "1"} == {row["collision"] for row in rows}
    assert any(row["visible_before_conflict_s"] for row in rows) == sensing
    assert len(read(tmp_path / "vehicle_conflicts.csv")) >= 10


def test_each_ego_is_in_one_part_with_everybody_there_meanwhile(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    long_run(tmp_path)
    monkeypatch.setattr(analysis.recording.rides, "SAMPLES_AT_ONCE", 800)
    whole = read_run(tmp_path)
    rides = Rides(read_rides(tmp_path), Thresholds())
    parts = list(rides.parts())
    assert sorted(np.concatenate([part.rows for part in parts]).tolist()) == list(range(len(whole.egos)))
    time, names = whole.neighbours.numbers["time_s"], whole.neighbours.texts["object_id"]
    for part in parts:
        own = part.run.egos.numbers["time_s"]
        there = {names.at(row) for row in np.flatnonzero((time >= own.min()) & (time <= own.max())).tolist()}
        assert there <= set(part.run.neighbours.texts["object_id"].names)


def test_what_lies_between_two_samples_is_what_the_whole_track_has_there(tmp_path: Path) -> None:
    long_run(tmp_path)
    run = read_run(tmp_path)
    tracks = Tracks(run, make_grid(run, Thresholds()), "vehicle")
    whole = {(track.name, track.first): track for track in tracks}
    for first, last in ((0, 0), (37, 41), (100, 190)):
        expected = {one.name for one in tracks if one.first <= last and first <= one.last}
        found = tracks.during(first, last)
        assert {one.name for one in found} == expected
        for one in found:
            (full,) = (track for (name, _), track in whole.items() if name == one.name)
            low, high = max(first, full.first), min(last, full.last)
            for name in ("x", "y", "heading", "speed", "x_speed", "y_speed", "level", "rows"):
                there = getattr(one, name)[low - one.first : high - one.first + 1]
                assert (
                    there.tolist() == getattr(full, name)[low - full.first : high - full.first + 1].tolist()
                )


@pytest.mark.parametrize(
    ("order", "says"),
    [
        ([*range(60, 120), *range(60), *range(120, 180)], "row 61: time goes backwards"),
        ([*range(60), 59, *range(60, 180)], "row 61: .* has a second row at"),
    ],
)
def test_an_error_between_two_row_groups_is_named_with_its_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, order: list[int], says: str
) -> None:
    long_run(tmp_path)
    path = tmp_path / NEIGHBOURS.file
    pq.write_table(pq.read_table(path).take(order), path, row_group_size=60)
    monkeypatch.setattr(analysis.recording.rides, "SAMPLES_AT_ONCE", 1)
    with pytest.raises(RecordingError, match=says):
        analyse_run(tmp_path)
    assert not (tmp_path / "encounters.csv").exists()


def test_too_little_memory_is_told_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    long_run(tmp_path)

    def no_room(run: RecordedRun, thresholds: Thresholds) -> Iterator[Case]:
        np.empty(1 << 58)
        yield from ()

    monkeypatch.setattr(analyse, "prepare_in_parts", no_room)
    with pytest.raises(RecordingError, match="there is not enough memory to judge it; the recording is kept"):
        analyse_run(tmp_path)
    assert not (tmp_path / "runs.csv").exists()
    assert (tmp_path / NEIGHBOURS.file).exists()
