"""The trajectory file of a run, read back."""

from __future__ import annotations

import csv
import struct
from pathlib import Path

import pytest

from analysis.errors import AnalysisError
from analysis.recording.ssam import export_ssam, read_trajectories
from tests.analysis.recorded import Ego, Person, Vehicle, line, write_run


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return write_run(
        tmp_path,
        [Ego(line(-21.2, 0, 10, 0))],
        [Person(line(32.5, -4, 0, 1.25), start=0.5)],
        [Vehicle(line(60, 3.2, 5, 0))],
        duration=3.0,
    )


def test_a_recording_of_nobody_is_exported_too(tmp_path: Path) -> None:
    trajectories, ids = export_ssam(write_run(tmp_path, [], record="everybody"))
    assert list(read_trajectories(trajectories)) == []
    assert len(ids.read_text().splitlines()) == 1


def test_every_instant_holds_every_body_with_both_ends(folder: Path) -> None:
    trajectories, ids = export_ssam(folder)
    with ids.open(newline="") as file:
        names = {int(row["ssam_id"]): (row["sumo_id"], row["type"]) for row in csv.DictReader(file)}
    assert sorted(names.values()) == [("car", "vehicle"), ("ego", "ego"), ("ped", "pedestrian")]
    instants = list(read_trajectories(trajectories))
    assert [round(time, 3) for time, _ in instants] == [round(0.1 * k, 3) for k in range(31)]
    assert [len(bodies) for _, bodies in instants] == [2] * 5 + [3] * 26
    found = {names[body.number][0]: body for body in instants[10][1]}
    ego = found["ego"]
    assert (ego.front_x, ego.rear_x) == pytest.approx((-8.95, -13.45), abs=1e-5)
    assert (ego.length, ego.width, ego.speed) == pytest.approx((4.5, 1.8, 10.0), abs=1e-5)
    person = found["ped"]
    assert (person.front_x + person.rear_x) / 2 == pytest.approx(32.5, abs=1e-5)
    assert person.length == pytest.approx(0.5)
    assert (found["car"].front_x, found["car"].front_y) == pytest.approx((67.25, 3.2), abs=1e-5)


def test_the_bytes_are_those_of_format_1_04(folder: Path) -> None:
    data = export_ssam(folder)[0].read_bytes()
    assert struct.unpack_from("<Bcf", data)[:2] == (0, b"L")
    assert struct.unpack_from("<Bcf", data)[2] == pytest.approx(1.04)
    kind, units, scale, min_x, min_y, max_x, max_y = struct.unpack_from("<BBfiiii", data, 6)
    assert (kind, units, scale) == (1, 1, 1.0)
    assert min_x < -26
    assert max_x > 77
    assert min_y < max_y
    assert data[28] == 2
    records = 31 * 5 + (5 * 2 + 26 * 3) * struct.calcsize("<BiiBffffffff")
    assert len(data) == 28 + records


def test_a_truncated_file_is_named(folder: Path) -> None:
    path = export_ssam(folder)[0]
    path.write_bytes(path.read_bytes()[:-3])
    with pytest.raises(AnalysisError, match="truncated"):
        list(read_trajectories(path))
