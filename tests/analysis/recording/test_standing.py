"""What stands for long is read and judged as if it stood briefly, and nothing is lost."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

import analysis.encounters.case
import analysis.recording.rides
import analysis.recording.standing
from analysis.encounters.case import prepare_in_parts
from analysis.recording.columns import NEIGHBOURS
from analysis.recording.fine_grid import make_grid
from analysis.recording.object_tracks import Tracks
from analysis.recording.reading import RecordedRun, read_rides, read_run
from analysis.recording.rides import Rides
from analysis.results.analyse import analyse_run
from analysis.thresholds import Thresholds
from tests.analysis.recorded import Ego, Motion, Person, Vehicle, line, write_run
from tests.analysis.results.test_files import FILES, read

GROUP = 60


def halting(x: float, y: float, heading: float, halts: float, goes_on: float, speed: float = 6.0) -> Motion:
    """Return motion along a heading that halts at (x, y) from one time to another [s]."""

    def motion(t: float) -> tuple[float, float]:
        way = speed * (min(t - halts, 0.0) + max(t - goes_on, 0.0))
        return x + way * np.cos(heading), y + way * np.sin(heading)

    return motion


def jammed_run(folder: Path, duration: float, walks: bool = True) -> None:
    """Write a run in which a van stands throughout, and others halt, vanish and go on, as egos come and go."""
    starts = np.arange(0.0, duration - 6.0, 8.0).tolist()
    egos = [
        Ego(line(-10.0 * at, 0, 10.0, 0), name=f"ego{n}", start=at, end=at + 6.0)
        for n, at in enumerate(starts)
    ]
    persons = [
        Person(line(33.0, -4.0 - 1.25 * at, 0, 1.25), name=f"ped{n}", start=at, end=at + 6.0)
        for n, at in enumerate(starts)
    ]
    north = 0.5 * np.pi
    vehicles = [
        Vehicle(line(26.0, -3.0, 0, 0), name="van", length=6.0, width=2.2),
        Vehicle(line(10.0, 9.0, 0, 0), name="again", end=duration / 3.0),
        # Halts on an ego's way and goes on within 3 s of another one's coming; the second leaves its lane late.
        Vehicle(halting(40.0, -1.5, north, 5.0, 26.5), name="across", heading=north),
        Vehicle(halting(14.0, -6.0, north, 3.0, duration - 12.0), name="late", heading=north),
    ]
    write_run(folder, egos, persons if walks else [], vehicles, duration=duration)
    path = folder / NEIGHBOURS.file
    table = pq.read_table(path)
    time, names = table["time_s"].to_numpy(), np.array(table["object_id"].to_pylist())
    gone = (names == "late") & (time > 14.95) & (time < 16.05)  # it is out of the recording while it stands
    pq.write_table(table.filter(~gone), path, row_group_size=GROUP)


def parts_of(folder: Path, monkeypatch: pytest.MonkeyPatch, at_once: int = 400) -> list[RecordedRun]:
    monkeypatch.setattr(analysis.recording.rides, "SAMPLES_AT_ONCE", at_once)
    return [part.run for part in Rides(read_rides(folder), Thresholds()).parts()]


@pytest.mark.long
def test_of_who_stands_a_part_holds_no_more_rows_the_longer_it_stood(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    most = []
    for duration in (40.0, 160.0):
        jammed_run(tmp_path / f"{duration}", duration)
        parts = parts_of(tmp_path / f"{duration}", monkeypatch)
        assert len(parts) > 3
        names = [part.neighbours.texts["object_id"] for part in parts]
        most.append(max(int(np.count_nonzero(one.equal("van"))) for one in names))
    assert most == [2, 2]


def test_tracks_without_repeated_rows_are_those_of_all_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    jammed_run(tmp_path, 48.0)
    run = read_run(tmp_path)
    grid = make_grid(run, Thresholds())
    whole = {(one.name, one.first): one for one in Tracks(run, grid, "vehicle")}
    assert [name for name, _ in whole].count("late") == 2
    seen = set()
    for part in parts_of(tmp_path, monkeypatch):
        tracks = Tracks(part, grid, "vehicle")
        for number, track in enumerate(tracks):
            full, way = whole[track.name, track.first], tracks.way(number)
            seen.add((track.name, track.first))
            at = way.fine - track.first
            for name in ("x", "y", "heading", "speed", "path", "level"):
                assert getattr(track, name).tobytes() == getattr(full, name).tobytes()
                assert getattr(way, name).tobytes() == getattr(full, name)[at].tobytes()
            left = np.setdiff1d(np.arange(len(full.x)), at)
            assert not full.speed[left].any()
    assert seen == set(whole)


@pytest.mark.long
def test_a_jammed_run_judged_in_parts_gives_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    jammed_run(tmp_path, 64.0)
    found = []
    for at_once, kept in ((1_000_000, 1_000_000), (400, 1_000_000), (1, 1)):
        monkeypatch.setattr(analysis.recording.rides, "SAMPLES_AT_ONCE", at_once)
        monkeypatch.setattr(analysis.encounters.case, "SAMPLES_AT_ONCE", at_once)
        monkeypatch.setattr(analysis.recording.standing, "ROWS_KEPT", kept)
        analyse_run(tmp_path)
        found.append({name: (tmp_path / name).read_bytes() for name in FILES})
    assert found[0] == found[1] == found[2]
    conflicts = read(tmp_path / "vehicle_conflicts.csv")
    assert {"across", "late"} <= {row["vehicle_id"] for row in conflicts}
    assert any(row["kind"] == "crossing" and row["pet_s"] for row in conflicts)


@pytest.mark.long
def test_row_groups_are_read_once_for_all_who_stand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    jammed_run(tmp_path, 160.0, walks=False)
    groups = pq.ParquetFile(tmp_path / NEIGHBOURS.file).num_row_groups
    read_groups: list[int] = []
    whole = pq.ParquetFile.read_row_group

    def counted(file: pq.ParquetFile, number: int, *args: object) -> object:
        read_groups.append(number)
        return whole(file, number, *args)

    monkeypatch.setattr(pq.ParquetFile, "read_row_group", counted)
    parts = parts_of(tmp_path, monkeypatch)
    assert len(parts) > 10
    assert sorted(read_groups) == sorted(2 * list(range(groups))), (
        "once to find out who is there, once for all parts"
    )


def test_an_ego_of_another_part_is_made_no_longer_than_it_is_looked_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    duration = 160.0
    egos = [Ego(line(-10.0 * at, 0, 10.0, 0), name=f"ego{at}", start=at, end=at + 6.0) for at in (0.0, 80.0)]
    egos.append(Ego(line(60.0, 0, 0, 0), name="stuck"))
    write_run(tmp_path, egos, [Person(line(33.0, -4.0, 0, 0.05))], duration=duration)
    path = tmp_path / NEIGHBOURS.file
    pq.write_table(pq.read_table(path), path, row_group_size=GROUP)
    parts = parts_of(tmp_path, monkeypatch)
    (case,) = [
        case
        for part in parts
        if "ego80.0" in part.egos.texts["ego_id"].names
        for case in prepare_in_parts(part, Thresholds())
    ]
    (stuck,) = case.bystanders.during(1700, 1710)
    assert (stuck.name, stuck.first <= 1700, stuck.last >= 1710) == ("stuck", True, True)
    assert len(stuck.x) <= 15
