"""Runs that are there, judged without simulating any."""

from __future__ import annotations

import csv
from pathlib import Path
from xml.etree import ElementTree

import pytest

from analysis.criteria.culprit import culprit
from analysis.files import write_json
from analysis.page.names import PAGE
from cosim.batches.job import Configuration, Job
from cosim.batches.ledger import FAILED, Ledger
from cosim.batches.outcome import NOTE, RUN, Outcome
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
STUDY = 'scenarios = ["road"]\ncontrollers = ["sumo"]\nseeds = "1-2"\nvary = { gap_s = [0.5, 1.5] }\n'
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


def test_all_runs_below_a_folder_are_judged_and_those_that_were_never_made_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A batch in a folder below another one, a run beside it, and a batch that was interrupted."""
    numbers = {"n_ttc_lt_1p5": 0, "ego_delay_mean_s": 8.0}
    write_study_run(tmp_path / "all" / "deep" / "batch" / "runs" / "one", "sumo", 1, numbers=numbers)
    (tmp_path / "all" / "deep" / "batch" / "study.toml").write_text(STUDY)
    (tmp_path / "all" / "criteria.toml").write_text(CRITERIA)
    assert judged(tmp_path / "all", "--junit", str(tmp_path / "junit.xml")) == 3
    missing = [row for row in rows(tmp_path / "all") if row["status"] == "invalid" and row["scope"] == "run"]
    assert {(row["seed"], row["note"]) for row in missing} == {("2", "was not made")}
    (tmp_path / "all" / "deep" / "batch" / "study.toml").write_text(STUDY.replace("1-2", "1"))
    assert judged(tmp_path / "all") == 0
    write_study_run(tmp_path / "all" / "loose", "aeb", 3, invalid="SUMO crashed")
    assert judged(tmp_path / "all") == 3
    assert "SUMO crashed" in capsys.readouterr().err


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


@pytest.mark.long
def test_the_report_of_a_judged_folder_shows_who_failed(tmp_path: Path) -> None:
    folder = study(tmp_path / "study")
    assert judged(folder) == 1
    assert main(["report", str(folder)]) == 0
    assert "ego 12 and pedestrian p3, 341.2 s, at crossing :B1_c0" in (folder / PAGE).read_text("utf-8")
    assert judged(folder) == 1  # and the report is in nobody's way


def test_an_invalid_run_ends_with_3(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert judged(study(tmp_path / "study", invalid="12 was teleported")) == 3
    assert "12 was teleported" in capsys.readouterr().err


@pytest.fixture
def varied(tmp_path: Path) -> Path:
    """Return a study that varies a parameter of its controller; seed 2 of 0.5 failed on its way."""
    folder = tmp_path / "study"
    folder.mkdir()
    (folder / "study.toml").write_text(STUDY)
    (folder / "criteria.toml").write_text(CRITERIA)
    ledger = Ledger(folder)
    for gap, seed in (("0.5", 1), ("0.5", 2), ("1.5", 1), ("1.5", 2)):
        settings = {"gap_s": gap}
        pairs = tuple(settings.items())
        job = Job(Configuration("road", "road", "road", "sumo", (), pairs, pairs), seed)
        failed = (gap, seed) == ("0.5", 2)
        attempt = ledger.work_folder(job, 1)
        made = write_study_run(
            attempt / RUN if failed else ledger.run_folder(job.name),
            "sumo",
            seed,
            parameters=settings,
            invalid="the run did not end" if failed else "",
            numbers={"ego_delay_mean_s": 9.0},
        )
        if failed:
            (folder / FAILED).mkdir()
            ledger.keep_failure(Outcome(job, attempt, "still running after 10 s"), 2)
        else:
            write_json(made / NOTE, {"varied": settings})
    return folder


def test_a_failed_run_counts_once_and_for_its_own_configuration(varied: Path) -> None:
    assert judged(varied) == 3
    found = [row for row in rows(varied) if row["criterion_id"] == "valid"]
    assert [(row["configuration"], row["seed"], row["status"]) for row in found] == [
        ("sumo gap_s=0.5", "1", "pass"),
        ("sumo gap_s=0.5", "2", "invalid"),
        ("sumo gap_s=1.5", "1", "pass"),
        ("sumo gap_s=1.5", "2", "pass"),
    ]
    assert found[1]["note"] == "still running after 10 s"
    means = [row for row in rows(varied) if row["scope"] == "configuration"]
    assert [row["status"] for row in means] == ["invalid", "pass"]


def test_configurations_of_which_no_run_was_begun_are_told(varied: Path) -> None:
    """Values that were never reached, a controller and a scenario without any run."""
    text = STUDY.replace("[0.5, 1.5]", "[0.5, 1.5, 2.0]").replace('["sumo"]', '["sumo", "aeb"]')
    (varied / "study.toml").write_text(text.replace('["road"]', '["road", "far/lane.sumocfg"]'))
    assert judged(varied) == 3
    found = [row for row in rows(varied) if row["criterion_id"] == "valid" and row["note"] == "was not made"]
    assert sorted({(row["scenario_id"], row["configuration"]) for row in found}) == [
        ("lane", "aeb"),
        ("lane", "sumo"),
        ("road", "aeb"),
        ("road", "sumo gap_s=2.0"),
    ]
    assert [row["seed"] for row in found] == ["1", "2"] * 4
    assert {row["status"] for row in found} == {"invalid"}
    means = [row for row in rows(varied) if row["scope"] == "configuration"]
    assert [row["status"] for row in means].count("invalid") == 5


@pytest.mark.parametrize("content", ['{"run": ', '{"run": "a", "reason": "b"}'])
def test_a_failed_run_that_cannot_be_read_is_told_in_one_line(
    varied: Path, capsys: pytest.CaptureFixture[str], content: str
) -> None:
    (path,) = (varied / "failed").glob("*/failure.json")
    path.write_text(content)
    assert judged(varied) == 3
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "failure.json: cannot be read" in line


def test_a_folder_for_the_findings_has_to_be_free(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = study(tmp_path / "study")
    foreign = tmp_path / "foreign"
    foreign.mkdir()
    for name in ("notes.txt", "criteria.csv"):
        (foreign / name).write_text("mine")
    for out, told in (
        (foreign, "this one has notes.txt in it"),
        (foreign / "notes.txt", "expected a folder, this is a file"),
        (foreign / "notes.txt" / "deeper", "Not a directory"),
    ):
        assert judged(folder, "--out", str(out)) == 2
        (line,) = capsys.readouterr().err.strip().splitlines()
        assert line.startswith(f"cosim: --out {out}: ")
        assert told in line
    assert (foreign / "criteria.csv").read_text() == "mine"
    for out in (tmp_path / "new", tmp_path / "new", folder):
        assert judged(folder, "--out", str(out)) == 1
        assert (out / "criteria.csv").is_file()


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


def test_a_contact_with_the_standing_ego_is_told_of_one_who_had_it() -> None:
    struck = encounter(min_dist_m=0.0, contact_standing=0)
    leant = encounter(min_dist_m=0.0, contact_standing=1)
    assert named("n_contacts_standing", struck, leant) == 2
    assert named("n_contacts_standing", struck) is None


@pytest.mark.parametrize(("encounters", "blamed"), [((2.0, 7.5), "2"), ((2.0, 3.0), "")])
def test_braking_outside_every_encounter_is_nobody_s_fault(
    tmp_path: Path, encounters: tuple[float, float], blamed: str
) -> None:
    write_study_run(
        tmp_path / "runs" / "one",
        "sumo",
        1,
        encounters=[{**FAR, "ego_max_decel_mps2": one} for one in encounters],
        numbers={"max_decel_mps2": 7.5},
    )
    criterion = CRITERIA.partition('[[criteria]]\nscope = "configuration"')[0]
    (tmp_path / "criteria.toml").write_text(
        criterion.replace("n_ttc_lt_1p5", "max_decel_mps2").replace('"=="', '"<="')
    )
    assert judged(tmp_path) == 1
    (row,) = [row for row in rows(tmp_path) if row["status"] == "fail"]
    assert (row["value"], row["encounter_id"]) == ("7.5", blamed)


def test_a_severity_is_told_of_an_encounter_that_has_it() -> None:
    severe, slight, none = (encounter(severity=level) for level in ("severe", "slight", "none"))
    assert named("n_severity_slight", severe, slight, slight) == 2
    assert named("n_severity_severe", slight, severe) == 2
    assert named("n_severity_serious", slight, severe) is None
    assert named("n_severity_none", slight, none) is None, "it is nobody's fault"


@pytest.mark.parametrize(
    ("metric", "column", "good", "bad"),
    [
        ("min_pet_s", "pet_area_s", 3.0, 0.4),
        ("min_dist_m", "min_dist_m", 2.0, 0.1),
        ("clearance_p05_m", "clearance_min_m", 2.0, 0.1),
        ("n_close_passes", "close_pass_speed_mps", 2.0, 9.0),
        ("tit_1p5_s2", "min_ttc_s", 3.0, 0.4),
        ("max_decel_mps2", "ego_max_decel_mps2", 1.0, 7.5),
        ("ped_delay_p95_s", "ped_delay_s", 1.0, 20.0),
        ("sum_p_fatal_rosen2009", "impact_speed_kmh", 5.0, 40.0),
    ],
)
def test_the_worst_of_two_is_told_by_the_number_that_is_counted(
    metric: str, column: str, good: float, bad: float
) -> None:
    better, worse, unknown = encounter(**{column: good}), encounter(**{column: bad}), encounter()
    assert named(metric, unknown, better, worse) == 3
    assert named(metric, worse, better, unknown) == 1


def test_hidden_pedestrians_are_told_of_those_who_were_hidden() -> None:
    seen = encounter(severity="severe", hidden_before_conflict=0)
    assert (
        named("n_hidden_before_conflict", seen, encounter(severity="serious", hidden_before_conflict=1)) == 2
    )
