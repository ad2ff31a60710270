"""Runs that are there, judged without simulating any."""

from __future__ import annotations

import csv
from pathlib import Path
from xml.etree import ElementTree

import pytest

from analysis.criteria.culprit import culprit
from analysis.page.names import PAGE
from cosim.cli import main
from tests.analysis.rows_of_runs import encounter
from tests.analysis.study.study_folders import write_study_run

CRITERIA = """
[[criteria]]
scope = "run"
metric = "n_ttc_lt_1p5"
operator = "=="
threshold = 0

[[criteria]]
scope = "configuration"
metric = "ego_delay_mean_s"
statistic = "mean"
operator = "<="
threshold = 10.0
"""
NEAR = {"min_ttc_s": 0.8, "t_min_ttc_s": 341.2, "ego_id": "12", "ped_id": "p3", "crossing_id": ":B1_c0"}
FAR = {"min_ttc_s": 4.0, "t_min_ttc_s": 20.0, "ego_id": "11", "ped_id": "p2"}


def study(folder: Path, invalid: str = "") -> Path:
    for seed, encounters in ((1, [FAR]), (2, [FAR, NEAR])):
        write_study_run(
            folder / "runs" / f"sumo-{seed}",
            "sumo",
            seed,
            encounters=encounters,
            numbers={"n_ttc_lt_1p5": len(encounters) - 1, "ego_delay_mean_s": 8.0 + seed},
            invalid=invalid if seed == 2 else "",
        )
    (folder / "criteria.toml").write_text(CRITERIA)
    return folder


def judged(folder: Path, *more: str) -> int:
    return main(["check", "--results", str(folder), "--criteria", str(folder / "criteria.toml"), *more])


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "criteria.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_failed_criterion_names_ego_time_and_place_and_leads_to_the_row(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = study(tmp_path / "study")
    assert judged(folder, "--junit", str(tmp_path / "junit.xml")) == 1
    told = capsys.readouterr()
    assert (
        "n_ttc_lt_1p5 = 1, expected == 0 (ego 12 and pedestrian p3, 341.2 s, at crossing :B1_c0)" in told.err
    )
    found = rows(folder)
    assert [(row["criterion_id"], row["status"]) for row in found] == [
        ("valid", "pass"),
        ("valid", "pass"),
        ("n_ttc_lt_1p5 == 0", "pass"),
        ("n_ttc_lt_1p5 == 0", "fail"),
        ("mean of ego_delay_mean_s <= 10", "pass"),
    ]
    failed = found[3]
    assert (failed["run"], failed["encounter_id"], failed["moment_s"]) == ("runs/sumo-2", "2", "341.2")
    assert found[4]["value"] == "9.5"
    assert ElementTree.parse(tmp_path / "junit.xml").getroot().get("failures") == "1"


def test_the_report_of_a_judged_folder_shows_who_failed(tmp_path: Path) -> None:
    folder = study(tmp_path / "study")
    assert judged(folder) == 1
    assert main(["report", str(folder)]) == 0
    assert "ego 12 and pedestrian p3, 341.2 s, at crossing :B1_c0" in (folder / PAGE).read_text("utf-8")
    assert judged(folder) == 1  # and the report is in nobody's way


def test_an_invalid_run_ends_with_3(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert judged(study(tmp_path / "study", invalid="12 was teleported")) == 3
    assert "12 was teleported" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--results", "nowhere"], "no such folder"),
        (["--results", "empty"], "contains no runs"),
        (["--results", "study"], "no criterion in its study file or in the scenarios"),
        (["--results", "study", "--seeds", "1-3"], "only --criteria, --junit and --out go with it"),
        (["--results", "study", "midblock_zebra"], "only --criteria, --junit and --out go with it"),
        ([], "expected a TARGET, or --results DIR"),
    ],
)
def test_bad_input_is_told_in_one_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    told: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    study(tmp_path / "study")
    (tmp_path / "empty").mkdir()
    assert main(["check", *arguments]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert told in line


def test_the_worst_encounter_is_told_by_what_the_metric_counts() -> None:
    names = """min_ttc_s t_min_ttc_s min_dist_m t_min_dist_s impact_speed_kmh t_collision_s pet_area_s
    preventable_r157 crossing_id ego_id ped_id"""
    empty = dict.fromkeys(names.split(), "")
    first = {**empty, "encounter_id": "1", "t_start_s": "5", "severity": "none", "min_ttc_s": "2.0"}
    second = {
        **empty,
        **{"encounter_id": "2", "t_start_s": "9", "severity": "collision", "impact_speed_kmh": "20"},
        **{"t_collision_s": "12.5", "preventable_r157": "0"},
    }
    for metric, expected in (("min_ttc_s", 1), ("n_collisions", 2), ("n_conflicts", 2)):
        found = culprit(metric, [first, second])
        assert found is not None
        assert found.encounter_id == expected
    found = culprit("n_collisions", [first, second])
    assert found is not None
    assert (found.moment_s, found.place) == (12.5, "off any crossing")
    assert culprit("n_collisions_preventable", [first, second]) is None
    assert culprit("ego_delay_mean_s", [first, second]) is None


def named(metric: str, *rows: dict[str, str]) -> int | None:
    """Return the number of the encounter that a metric is about, counted from 1."""
    numbered = [{**row, "encounter_id": str(i), "t_start_s": "0"} for i, row in enumerate(rows, 1)]
    found = culprit(metric, numbered)
    return None if found is None else found.encounter_id


def test_the_worst_deceleration_is_one_that_no_number_is_large_enough_for() -> None:
    large = encounter(drac_max_mps2=9.0, drac_status="ok", mdrac_max_mps2=9.0, mdrac_status="ok")
    never = encounter(drac_status="unbounded", mdrac_status="unavoidable_at_PRT")
    struck = encounter(drac_status="collision", mdrac_status="collision")
    for metric in ("n_drac_gt_3p4", "n_mdrac_gt_3p4"):
        assert named(metric, large, never, struck, never) == 3
        assert named(metric, large, never) == 2
        assert named(metric, large) == 1


def test_contacts_of_a_kind_are_about_one_of_that_kind() -> None:
    crossing = {"contact_place": "crossing", "contact_moved_by": "ego", "contact_class": "ego"}
    slow = encounter(impact_speed_kmh=5.0, **crossing)
    fast = encounter(impact_speed_kmh=50.0, contact_place="carriageway", contact_class="appeared")
    for metric in ("n_collisions_crossing", "n_collisions_moved_by_ego", "n_collisions_class_ego"):
        assert named(metric, fast, slow) == 2
    assert named("n_collisions", slow, fast) == 2
    assert named("n_collisions_moved_by_both", slow, fast) is None


def test_hidden_pedestrians_are_told_of_those_who_were_hidden() -> None:
    seen = encounter(severity="severe", hidden_before_conflict=0)
    assert (
        named("n_hidden_before_conflict", seen, encounter(severity="serious", hidden_before_conflict=1)) == 2
    )
