"""The data of a replay against runs whose numbers can be derived by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from analysis.errors import RecordingError
from analysis.page.recorded import has_recording, read_recording
from analysis.page.replay import replay_of, write_replay
from tests.analysis.recorded import Ego, Person, Vehicle, line, write_run

ZEBRA = {
    "name": "zebra",
    "kind": "crossing",
    "crossing_kind": "zebra",
    "width_m": 4.0,
    "shape_m": [[32.5, -5.0], [32.5, 5.0]],
}


def lane(name: str, *shape: tuple[float, float]) -> dict[str, Any]:
    return {"name": name, "kind": "lane", "crossing_kind": "", "width_m": 3.2, "shape_m": shape}


def head_on(folder: Path, **options: Any) -> dict[str, Any]:
    """Return the replay of an ego at 10 m/s towards a person who stands on the crossing, 40 m ahead."""
    write_run(
        folder,
        [Ego(line(-10.0, 0.0, 10.0, 0.0))],
        [Person(line(32.5, 0.0, 0.0, 0.01))],
        [Vehicle(line(-30.0, 3.2, 12.0, 0.0), start=1.0), Vehicle(line(500.0, 3.2, 0.0, 0.0), "far")],
        duration=3.0,
        **options,
    )
    return replay_of(read_recording(folder), 1)


def test_a_frame_holds_the_recorded_row_and_the_ttc_and_distance_of_the_analysis(tmp_path: Path) -> None:
    found = head_on(tmp_path)
    at = found["time_s"].index(1.0)
    assert found["ego"]["front_x_m"][at] == 2.25  # centre at 0, half of 4.5 m ahead
    assert found["ego"]["speed_mps"][at] == pytest.approx(10.0, abs=1e-4)
    # From the front at 2.25 to the disc of 0.25 m radius at 32.5: 30.0 m, at 10 m/s 3 s.
    assert found["distance_m"][at] == pytest.approx(30.0, abs=0.002)
    assert found["ttc_s"][at] == pytest.approx(3.0, abs=0.002)
    assert found["ego"]["plan_status"]["texts"] == ["ok"]
    assert found["ego"]["rule"] == {"texts": [], "codes": [-1] * len(found["time_s"])}


def test_others_start_at_the_frame_in_which_they_appear_and_those_far_away_are_left_out(
    tmp_path: Path,
) -> None:
    found = head_on(tmp_path)
    objects = {one["id"]: one for one in found["objects"]}
    assert set(objects) == {"ped", "car"}
    assert found["time_s"][objects["car"]["first"]] == 1.0
    assert objects["car"]["x_m"][0] == pytest.approx(-18.0 + 2.25)
    assert len(objects["car"]["x_m"]) == len(found["time_s"]) - objects["car"]["first"]
    assert objects["ped"]["met"] == 1
    assert objects["ped"]["length_m"] == 0.5


def test_the_ground_of_a_junction_is_the_outline_of_its_lanes(tmp_path: Path) -> None:
    corners = lane(":J_0_0", (0.0, 0.0), (10.0, 0.0)), lane(":J_1_0", (10.0, 10.0), (5.0, 5.0), (0.0, 10.0))
    straight = lane(":K_0_0", (20.0, 0.0), (30.0, 0.0))
    found = head_on(tmp_path, areas=[ZEBRA, *corners, straight, lane("e_0", (0.0, 0.0), (90.0, 0.0))])
    kinds = [area["kind"] for area in found["map"]]
    assert kinds == ["junction", "crossing", "inner_lane", "inner_lane", "inner_lane", "lane"]
    ground = found["map"][0]["at"]
    assert sorted(zip(ground[::2], ground[1::2], strict=True)) == [(0, 0), (0, 10), (10, 0), (10, 10)]


def test_the_file_is_a_call_with_the_data_and_the_same_each_time(tmp_path: Path) -> None:
    found = head_on(tmp_path / "run")
    recording = read_recording(tmp_path / "run")
    path = write_replay("abc-1", replay_of(recording, 1), tmp_path / "replays")
    text = path.read_text("ascii")
    assert text.startswith('cosimReplayData("abc-1",{')
    assert json.loads(text.removeprefix('cosimReplayData("abc-1",').removesuffix(");\n")) == json.loads(
        json.dumps(found)
    )
    before = path.read_bytes()
    write_replay("abc-1", replay_of(recording, 1), tmp_path / "replays")
    assert path.read_bytes() == before
    assert list((tmp_path / "replays").iterdir()) == [path]


def test_an_encounter_that_is_not_in_the_recording_is_an_error_that_says_how_many_are(tmp_path: Path) -> None:
    head_on(tmp_path)
    recording = read_recording(tmp_path)
    for number in (0, 2):
        with pytest.raises(RecordingError, match=f"has 1 encounters, number {number}"):
            replay_of(recording, number)


def test_a_run_has_a_recording_while_all_its_files_are_there(tmp_path: Path) -> None:
    head_on(tmp_path)
    assert has_recording(tmp_path)
    (tmp_path / "plans.parquet").unlink()
    assert not has_recording(tmp_path)


def test_plans_that_cannot_be_read_are_an_error_in_one_line(tmp_path: Path) -> None:
    head_on(tmp_path)
    (tmp_path / "plans.parquet").write_bytes(b"PAR1 cut off")
    with pytest.raises(RecordingError, match=r"plans\.parquet: cannot be read"):
        read_recording(tmp_path)
