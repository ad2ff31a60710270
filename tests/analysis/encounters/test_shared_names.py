"""SUMO lets a vehicle and a person have the same id, and randomTrips' default names make it so."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from analysis.encounters.case import prepare
from analysis.errors import RecordingError
from analysis.page.recorded import read_recording
from analysis.page.replay import replay_of
from analysis.plots.scene import choose
from analysis.recording.columns import SENSING
from analysis.recording.reading import read_run
from analysis.recording.ssam import export_ssam, read_trajectories
from analysis.results.analyse import analyse_run
from tests.analysis.recorded import Ego, Person, Vehicle, line, write_run


def write(folder: Path, vehicle: str, person: str, ego: str = "ego") -> Path:
    """Write an ego that touches a pedestrian and then runs into the vehicle ahead."""
    return write_run(
        folder,
        [Ego(line(0, 0, 10, 0), ego)],
        [Person(line(32.5, -5, 0, 1.25), person)],
        [Vehicle(line(60, 0, 4, 0), vehicle)],
    )


@pytest.mark.parametrize(
    ("ego", "vehicle", "person"),
    [("ego", "23", "23"), ("23", "car", "23"), ("23", "23.1", "23")],
)
def test_shared_ids_change_no_number(tmp_path: Path, ego: str, vehicle: str, person: str) -> None:
    def rows(report: Any) -> list[Any]:
        names = ("ego_id", "ped_id", "vehicle_id", "passage_id")
        tables = (*report.encounters, *report.overlaps, report.run)
        return [{name: value for name, value in row.items() if name not in names} for row in tables]

    apart = analyse_run(write(tmp_path / "apart", "car", "ped"))
    shared = analyse_run(write(tmp_path / "shared", vehicle, person, ego))
    assert rows(shared) == rows(apart)
    assert shared.encounters[0]["collision"] is True
    assert (shared.encounters[0]["ego_id"], shared.encounters[0]["ped_id"]) == (ego, person)
    assert [row["vehicle_id"] for row in shared.overlaps] == [vehicle]


def test_an_ego_recorded_among_the_vehicles_with_the_id_of_a_person_overlaps_nobody(tmp_path: Path) -> None:
    folder = write_run(
        tmp_path,
        [Ego(line(0, 0, 10, 0), "7")],
        [Person(line(32.5, -5, 0, 1.25), "7")],
        [Vehicle(line(0, 0, 10, 0), "7")],
    )
    report = analyse_run(folder)
    assert report.overlaps == []
    assert report.encounters[0]["collision"] is True
    assert report.encounters[0]["preventable_r157"] is True, (
        "the ego does not hide the pedestrian from its driver"
    )


def test_the_replay_shows_both(tmp_path: Path) -> None:
    found = replay_of(read_recording(write(tmp_path, "23", "23")), 1)
    assert [(one["id"], one["kind"], one.get("met")) for one in found["objects"]] == [
        ("23", "pedestrian", 1),
        ("23", "vehicle", None),
    ]
    person, vehicle = found["objects"]
    assert person["x_m"][0] == 32.5
    assert vehicle["x_m"][0] == 62.25


def test_the_replay_does_not_show_the_ego_as_a_vehicle_of_its_own(tmp_path: Path) -> None:
    folder = write_run(
        tmp_path,
        [Ego(line(0, 0, 10, 0), "7"), Ego(line(0, 3.2, 10, 0), "8")],
        [Person(line(32.5, -5, 0, 1.25), "7")],
        [Vehicle(line(0, 0, 10, 0), "7"), Vehicle(line(0, 3.2, 10, 0), "8")],
    )
    found = replay_of(read_recording(folder), 1)
    assert (found["ego_id"], found["ped_id"]) == ("7", "7")
    assert [(one["id"], one["kind"]) for one in found["objects"]] == [("7", "pedestrian"), ("8", "vehicle")]


def test_figures_draw_the_person_and_not_the_vehicle(tmp_path: Path) -> None:
    scene = choose(prepare(read_run(write(tmp_path, "23", "23"))), None, 1)
    (piece,) = scene.persons()
    assert piece.track.width == 0.5


def test_a_trajectory_file_numbers_them_apart(tmp_path: Path) -> None:
    trajectories, ids = export_ssam(write(tmp_path, "23", "23", "23"))
    with ids.open(newline="") as file:
        names = {int(row["ssam_id"]): (row["sumo_id"], row["type"]) for row in csv.DictReader(file)}
    assert sorted(names.values()) == [("23", "ego"), ("23", "pedestrian")], "the ego is one vehicle"
    for _, bodies in read_trajectories(trajectories):
        assert len({body.number for body in bodies}) == len(bodies) == 2
        lengths = {names[body.number][1]: body.length for body in bodies}
        assert lengths == {"ego": pytest.approx(4.5), "pedestrian": pytest.approx(0.5)}


def test_what_was_sensed_of_a_person_with_the_egos_id_is_found(tmp_path: Path) -> None:
    folder = write_run(
        tmp_path,
        [Ego(line(0, 0, 10, 0), "7")],
        [Person(line(32.5, -5, 0, 1.25), "7")],
        [Vehicle(line(60, 3.2, 4, 0), "7.1")],
        sensing="onboard",
    )
    rows = [
        {"time_s": 0.1 * k, "ego_id": "7", "object_id": "7", "told": True, "state": "visible"}
        for k in range(101)
    ]
    pq.write_table(pa.Table.from_pylist(rows, schema=SENSING.schema), folder / "sensing.parquet")
    (row,) = analyse_run(folder).encounters
    assert row["visible_before_conflict_s"] == pytest.approx(row["t_collision_s"])


def test_two_rows_of_one_person_and_instant_are_still_refused(tmp_path: Path) -> None:
    folder = write(tmp_path, "23", "23")
    table = pq.read_table(folder / "neighbours.parquet")
    pq.write_table(pa.concat_tables([table.slice(0, 1), table]), folder / "neighbours.parquet")
    with pytest.raises(RecordingError, match="'pedestrian', '23' has a second row at 0 s"):
        read_run(folder)
