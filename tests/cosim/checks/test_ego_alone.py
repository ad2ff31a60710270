"""Verdicts on an ego that met nobody: who, when and where, and their replays."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import pytest

from analysis.criteria.culprit_alone import of_ego
from analysis.criteria.culprit_vehicle import CLOSE, of_conflict
from analysis.metrics import followers, vehicle_conflicts
from analysis.results.analyse import analyse_run
from cosim.cli import main
from tests.analysis.recorded import ZEBRA, Ego, Person, Vehicle, line, write_run

CRITERIA = """
[[criteria]]
scope = "run"
metric = "deadlock"
operator = "=="
threshold = 0

[[criteria]]
scope = "run"
metric = "n_vehicle_overlaps_ego_closed"
operator = "=="
threshold = 0

[[criteria]]
scope = "run"
metric = "n_follower_ttc_lt_1p5"
operator = "=="
threshold = 0
"""


def judged(folder: Path) -> list[dict[str, str]]:
    """Return the failed rows of criteria.csv of the runs in a folder."""
    (folder / "criteria.toml").write_text(CRITERIA)
    assert main(["check", "--results", str(folder), "--criteria", str(folder / "criteria.toml")]) == 1
    with (folder / "criteria.csv").open(newline="", encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if row["status"] == "fail"]


def replay(folder: Path) -> dict[str, object]:
    """Return the data of the replay that the verdict of the report leads to."""
    assert main(["report", str(folder)]) == 0
    page = (folder / "report.html").read_text("utf-8")
    (key,) = re.findall(r'<a class="open-moment" href="#replay=([^"]*)"', page)
    text = (folder / "report_data" / "replays" / f"{key}.js").read_text("utf-8")
    found: dict[str, object] = json.loads(text[text.index(",") + 1 : text.rindex(")")])
    return found


@pytest.mark.long
def test_a_deadlock_names_ego_time_and_place_and_has_a_replay(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stuck = Ego(
        lambda t: (10.0 * min(t, 2.5) + 10.0 * max(t - 70.0, 0.0), 0.0),
        columns={"gap_ahead_m": lambda t: None},
    )
    analyse_run(write_run(tmp_path / "runs" / "one", [stuck], duration=80.0, step=0.5, areas=[ZEBRA]))
    (row,) = judged(tmp_path)
    assert (row["metric"], row["ego_id"], row["ped_id"]) == ("deadlock", "ego", "")
    assert float(row["moment_s"]) == pytest.approx(3.0, abs=0.5)
    assert row["place"] == f"at crossing {ZEBRA['name']}"
    assert re.fullmatch(r"stood until (69\.5|70\.0) s", row["note"]), row["note"]
    where = f"ego ego, {float(row['moment_s']):.1f} s, at crossing {ZEBRA['name']}"
    assert where in capsys.readouterr().err
    found = replay(tmp_path)
    assert (found["ego_id"], found["encounter_id"], found["ped_id"]) == ("ego", None, None)
    times = found["time_s"]
    assert isinstance(times, list)
    assert (times[0], times[-1]) == (0.0, float(row["moment_s"]) + 30.0)
    assert set(found["distance_m"]) == {None}  # type: ignore[call-overload]  # a list of the JSON


@pytest.mark.long
def test_an_overlap_names_the_vehicle_and_has_a_replay(tmp_path: Path) -> None:
    folder = write_run(tmp_path / "one", [Ego(line(0, 0, 10, 0))], [], [Vehicle(line(60, 0, 4, 0), "van")])
    analyse_run(folder)
    (row,) = judged(tmp_path)
    assert (row["metric"], row["ego_id"], row["ped_id"]) == ("n_vehicle_overlaps_ego_closed", "ego", "")
    assert re.fullmatch(r"\d\.\d\d m into vehicle van", row["place"])
    # From the front at 2.25 m to a rear at 60 m - 4.5 m in front of which it drives, at 6 m/s.
    found = replay(tmp_path)
    assert found["ego_id"] == "ego"
    assert float(row["moment_s"]) in found["time_s"]  # type: ignore[operator]  # a list of the JSON


def test_a_follower_is_named_though_a_pedestrian_was_met(tmp_path: Path) -> None:
    # 25.5 m between the bumpers at first, 6 m/s of closing speed: after 3 s there are 7.5 m left.
    walks, van = Person(line(50, -5, 0, 1.4)), Vehicle(line(0, 0, 10, 0), "van")
    folder = write_run(tmp_path / "one", [Ego(line(30, 0, 4, 0))], [walks], [van], duration=3.0)
    report = analyse_run(folder)
    assert len(report.encounters) == 1
    (row,) = judged(tmp_path)
    assert (row["metric"], row["ego_id"], row["ped_id"]) == ("n_follower_ttc_lt_1p5", "ego", "")
    assert (row["moment_s"], row["place"]) == ("3", "1.25 s TTC, vehicle van behind")


def test_the_worst_conflict_with_a_vehicle_is_told_for_every_metric_of_them() -> None:
    declared = {*followers.RUN_COLUMNS, *vehicle_conflicts.RUN_COLUMNS}
    assert {column.name for column in declared} == set(CLOSE)
    empty = {"min_ttc_s": "", "pet_s": "", "drac_max_mps2": "", "t_min_ttc_s": "3"}
    near = {**empty, "kind": "followed", "ego_id": "a", "vehicle_id": "x", "min_ttc_s": "1"}
    brakes = {**empty, "kind": "followed", "ego_id": "b", "vehicle_id": "y", "drac_max_mps2": "4.5"}
    late = {**empty, "kind": "crossing", "ego_id": "c", "vehicle_id": "z", "min_ttc_s": "2", "pet_s": "0.5"}
    told = {metric: of_conflict(metric, [brakes, near, late]) for metric in CLOSE}
    places = {metric: one.place for metric, one in told.items() if one is not None}
    assert places == {
        **dict.fromkeys(
            ("n_follower_conflicts", "n_follower_ttc_lt_1p5", "follower_min_ttc_s"),
            "1.00 s TTC, vehicle x behind",
        ),
        **dict.fromkeys(
            ("n_follower_drac_gt_3p4", "follower_max_drac_mps2"), "4.50 m/s² DRAC, vehicle y behind"
        ),
        **dict.fromkeys(
            ("n_vehicle_conflicts_crossing", "min_vehicle_pet_s"), "0.50 s PET, vehicle z crossing"
        ),
    }


def test_the_deepest_overlap_is_told_and_only_those_that_count() -> None:
    shallow = {"ego_id": "a", "vehicle_id": "x", "depth_m": "0.1", "t_start_s": "4", "closed_by": "ego"}
    deep = {"ego_id": "b", "vehicle_id": "y", "depth_m": "1.25", "t_start_s": "9", "closed_by": "other"}
    every = of_ego("n_vehicle_overlaps", {}, [shallow, deep])
    own = of_ego("n_vehicle_overlaps_ego_closed", {}, [shallow, deep])
    assert every is not None
    assert own is not None
    assert (every.ego_id, every.moment_s, every.place) == ("b", 9.0, "1.25 m into vehicle y")
    assert own.ego_id == "a"
    assert of_ego("n_vehicle_overlaps", {}, []) is None


def test_of_several_deadlocks_the_first_is_told_and_the_others_are_noted() -> None:
    told = "ego a, 1.0 to 90.0 s, on lane in_0; ego b, 2.0 to 95.0 s, at crossing c"
    found = of_ego("deadlock", {"deadlock_where": told}, [])
    assert found is not None
    assert (found.ego_id, found.moment_s, found.place) == ("a", 1.0, "on lane in_0")
    assert found.note == f"stood until 90.0 s; all 2: {told}"
