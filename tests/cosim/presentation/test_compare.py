"""``cosim compare``: the answer in one line, the table under it, and every mistake in one line."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from cosim.cli import main
from tests.analysis.study.study_folders import write_study_run

SEEDS = range(1, 11)


def write(folder: Path, name: str, seed: int, low: int, delay: float, demand: int = 300) -> None:
    """Write a run with some of eight encounters below a TTC of 1.5 s."""
    encounters = [{"min_ttc_s": 1.0}] * low + [{"min_ttc_s": 4.0}] * (8 - low)
    write_study_run(
        folder / f"{name}-{demand}-{seed}",
        name,
        seed,
        numbers={"ego_delay_mean_s": delay, "n_conflicts": low, "n_ttc_lt_1p5": low, "ego_dist_km": 2.0},
        encounters=encounters,
        setting={"pedestrians_per_hour": demand},
    )


@pytest.fixture
def study(tmp_path: Path) -> Path:
    for seed in SEEDS:
        write(tmp_path / "study/runs", "sumo", seed, 2 + seed % 2, 10.0)
        write(tmp_path / "study/runs", "careful", seed, 0, 14.0 + seed % 3)
        write(tmp_path / "study/runs", "twin", seed, 2 + seed % 2, 10.0)
    return tmp_path / "study"


def shown(capsys: pytest.CaptureFixture[str], *arguments: str) -> list[str]:
    assert main(["compare", *arguments]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    return captured.out.splitlines()


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["compare", *arguments]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    return line


def test_the_first_line_says_safer_and_slower_and_by_how_much(
    study: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = shown(capsys, str(study), "--base", "sumo", "--alt", "careful")
    # Delays 14 + 1, 2, 0, 1, … − 10: mean 5.0 (ten seeds: 1 2 0 1 2 0 1 2 0 1), deviation 0.8165.
    assert lines[0] == (
        "careful against sumo on road, 10 seeds: safer (entered encounters with TTC < 1.5 s, conflicts "
        "per km), and slower (+5.0 s, 95 % alone +4.4 … +5.6; p < 0.001, corrected for 3 tests)."
    )
    (row,) = [line for line in lines if line.startswith("entered encounters with TTC < 1.5 s")]
    assert "31.2%" in row
    assert "-31.2%" in row
    assert row.rstrip().endswith("better")
    (row,) = [line for line in lines if line.startswith("mean delay of an ego")]
    assert row.split()[-2:] == ["10", "worse"]
    assert any("careful: 0 collisions in 80 entered encounters, at most 3.68%" in line for line in lines)
    assert len(lines) <= 24
    assert max(map(len, lines[2:-4])) <= 132


def test_contacts_are_told_apart_by_place_and_by_what_a_careful_driver_prevents(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for seed in (1, 2):
        write_study_run(tmp_path / f"sumo-{seed}", "sumo", seed, encounters=[{"min_ttc_s": 4.0}])
        write_study_run(
            tmp_path / f"bold-{seed}",
            "bold",
            seed,
            encounters=[{"collision": True, "n_collisions": 1, "severity": "collision"}] * 3,
            numbers={
                "n_collisions": 3,
                "n_collisions_preventable": seed,
                "n_collisions_carriageway": 2,
                "n_collisions_walking_area_or_kerb": 1,
                "n_collisions_class_appeared": seed - 1,
            },
        )
    lines = shown(capsys, str(tmp_path), "--alt", "bold")
    assert (
        "bold: 3 of the 6 contacts are preventable; 0 on a crossing, 4 on the carriageway, 2 on a "
        "walking area or at the kerb; in 1 the pedestrian appeared inside the stopping distance."
    ) in lines
    assert not any(line.startswith("sumo: 0 of") for line in lines)


def test_twins_show_no_difference(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = shown(capsys, str(study), "--alt", "twin")
    assert "no difference in safety shown, and no difference in delay shown" in lines[0]
    assert not any(line.rstrip().endswith((" better", " worse")) for line in lines)


def test_the_other_way_round_it_is_less_safe_and_faster(
    study: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first = shown(capsys, str(study), "--base", "careful", "--alt", "sumo")[0]
    assert "less safe (entered encounters with TTC < 1.5 s, conflicts per km), and faster (-5.0 s" in first


def test_beside_no_difference_shown_stands_how_many_seeds_would_tell(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # Differences of the delay 2, −2, 2, −2, …: mean 0, deviation 2.108 over ten seeds; 1 = 10 % of the base.
    # The smallest n with t(0.975, n − 1) · 2.108 / sqrt(n) <= 1 is 20 (t = 2.093; 19: 2.101 · 2.108 > 4.359).
    for seed in range(1, 11):
        write(tmp_path, "sumo", seed, 4, 10.0)
        write(tmp_path, "other", seed, 4, 10.0 + 2.0 * (-1) ** seed)
    lines = shown(capsys, str(tmp_path), "--alt", "other")
    assert (
        "no difference in delay shown (+0.0 s, 95 % -1.5 … +1.5) (seeds needed: 20; there are 10)" in lines[0]
    )
    (row,) = [line for line in lines if line.startswith("mean delay of an ego")]
    assert row.split()[-6:] == ["10", "/", "20", "no", "difference", "shown"]
    assert any('"Needed" is how many seeds' in line for line in lines)


def test_chosen_measures_are_one_family_and_are_written_when_asked(
    study: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names = ["--metric", "ego_delay_mean_s", "--metric", "n_ttc_lt_1p5", "--metric", "ego_delay_mean_s"]
    before = sorted(path.name for path in study.iterdir())
    lines = shown(capsys, str(study), "--alt", "careful", *names)
    assert any("2 tests of this table" in line for line in lines)
    assert sorted(path.name for path in study.iterdir()) == before
    shown(capsys, str(study), "--alt", "careful", *names, "--write")
    with (study / "comparison-sumo-careful.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["metric"], row["family"], row["n_family"]) for row in rows] == [
        ("ego_delay_mean_s", "chosen", "2"),
        ("n_ttc_lt_1p5", "chosen", "2"),
    ]
    assert main(["compare", str(study), "--alt", "careful"]) == 0  # the file in the study is in nobody's way


@pytest.mark.long
def test_several_settings_are_one_table_or_one_each(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for seed in SEEDS:
        write(study / "runs", "sumo", seed, 4, 20.0, demand=600)
        write(study / "runs", "careful", seed, 0, 30.0, demand=600)
    together = shown(capsys, str(study), "--alt", "careful")
    assert "on road (all 2 conditions), 10 seeds" in together[0]
    assert "slower (+7.5 s" in together[0]
    each = [line for line in shown(capsys, str(study), "--alt", "careful", "--each") if " against " in line]
    assert "(pedestrians_per_hour=300), 10 seeds" in each[0]
    assert "(pedestrians_per_hour=600), 10 seeds" in each[1]
    # The twin was never run at 600.
    assert "on road (pedestrians_per_hour=300), 10 seeds" in shown(capsys, str(study), "--alt", "twin")[0]
    assert sum("twin against" in line for line in shown(capsys, str(study), "--alt", "twin", "--each")) == 1


def test_seeds_that_are_left_out_are_told(study: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_study_run(
        study / "runs/broken", "sumo", 11, setting={"pedestrians_per_hour": 300}, invalid="has not ended"
    )
    write(study / "runs", "careful", 11, 0, 1e6)
    write(study / "runs", "careful", 12, 0, 1e6)
    lines = shown(capsys, str(study), "--alt", "careful")
    assert "10 seeds" in lines[0]
    assert any(
        line == "Seeds left out: 1 without a run of each under every condition, "
        "1 with an invalid or unfinished run."
        for line in lines
    )


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--alt", "carefull"], "--alt carefull: no run of it in"),
        (["--alt", "carefull"], "available: careful, sumo, twin"),
        (["--alt", "careful", "--base", "aeb"], "--base aeb: no run of it"),
        (["--alt", "sumo"], "are the same"),
        (["--alt", "careful", "--metric", "ego_delay"], "did you mean 'ego_delay_mean_s'?"),
        (["--alt", "careful", "--metric", "compute_p95_ms"], "no such measure"),
        (["--alt", "careful", "--scenario", "street"], "available: road"),
        ([], "--alt"),
    ],
)
def test_a_mistake_is_one_line_with_what_exists(
    study: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], says: str
) -> None:
    assert says in refused(capsys, str(study), *arguments)


def test_a_folder_without_runs_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "contains no runs" in refused(capsys, str(tmp_path), "--alt", "aeb")
    assert "no such folder" in refused(capsys, str(tmp_path / "gone"), "--alt", "aeb")
    (tmp_path / "run").mkdir()
    (tmp_path / "run/run.json").write_text("{")
    assert "run.json" in refused(capsys, str(tmp_path), "--alt", "aeb")


def test_without_a_seed_in_common_there_is_nothing_to_compare(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for seed in (1, 2):
        write(tmp_path, "sumo", seed, 1, 10.0)
        write(tmp_path, "aeb", seed + 2, 1, 10.0)
    line = refused(capsys, str(tmp_path), "--alt", "aeb")
    assert "no seed in common" in line
    assert "sumo has seeds 1, 2 on road" in line
    assert "aeb has seeds 3, 4 on road" in line
    # Each seed was run under one of two settings: nothing together, something one by one.
    write(tmp_path, "aeb", 1, 1, 10.0)
    write(tmp_path, "sumo", 5, 1, 10.0, demand=600)
    write(tmp_path, "aeb", 5, 1, 10.0, demand=600)
    assert "--each" in refused(capsys, str(tmp_path), "--alt", "aeb")
    assert main(["compare", str(tmp_path), "--alt", "aeb", "--each"]) == 0


def test_several_parameter_sets_of_a_controller_have_to_be_told_apart(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for seed in (1, 2, 3):
        write_study_run(tmp_path / f"sumo-{seed}", "sumo", seed)
        for gain in (1, 2):
            write_study_run(tmp_path / f"mpc-{gain}-{seed}", "mpc", seed, parameters={"gain": gain})
    assert "ambiguous: 'mpc gain=1', 'mpc gain=2'" in refused(capsys, str(tmp_path), "--alt", "mpc")
    lines = shown(capsys, str(tmp_path), "--base", "mpc gain=1", "--alt", "mpc gain=2")
    assert lines[0].startswith("mpc gain=2 against mpc gain=1 on road, 3 seeds")


@pytest.mark.sumo
@pytest.mark.slow
def test_real_runs_are_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for controller in ("sumo", "aeb"):
        for seed in (1, 2):
            code = main(
                [
                    *("run", "midblock_unmarked", "--controller", controller, "--seed", str(seed)),
                    *("--set", "warmup_s=20", "--duration-s", "40"),
                    *("--out", str(tmp_path / "runs" / f"{controller}-{seed}")),
                ]
            )
            assert code == 0
    capsys.readouterr()
    lines = shown(capsys, str(tmp_path), "--base", "sumo", "--alt", "aeb", "--metric", "ego_dist_km")
    assert lines[0].startswith("aeb against sumo on midblock_unmarked, 2 seeds: a difference in")
    with (tmp_path / "runs/aeb-1/runs.csv").open(encoding="utf-8", newline="") as file:
        first = float(next(csv.DictReader(file))["ego_dist_km"])
    with (tmp_path / "runs/aeb-2/runs.csv").open(encoding="utf-8", newline="") as file:
        second = float(next(csv.DictReader(file))["ego_dist_km"])
    shown(capsys, str(tmp_path), "--alt", "aeb", "--metric", "ego_dist_km", "--write")
    with (tmp_path / "comparison-sumo-aeb.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    assert float(row["alt_mean"]) == pytest.approx(0.5 * (first + second), rel=1e-5)
