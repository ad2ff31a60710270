"""The rows of comparisons.csv, from run folders whose numbers can be added up by hand."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from analysis.study.design import read_study
from tests.analysis.study.study_folders import write_study_run
from tests.analysis.study.study_tables import Cells, met, only, tables


def test_a_difference_is_that_of_the_pairs(two_controllers_tables: tuple[list[Cells], list[Cells]]) -> None:
    _, comparisons = two_controllers_tables
    row = only(comparisons, metric="ego_delay_mean_s")
    # Differences 3, 2, 4: mean 3, deviation 1, t = 3 sqrt(3), p = 1 − t / sqrt(t² + 2).
    assert (row["base"], row["alt"], row["n_pairs"]) == ("sumo", "slow", "3")
    assert [float(row[name]) for name in ("base_mean", "alt_mean", "diff_mean")] == [20.0, 23.0, 3.0]
    assert (float(row["diff_pct"]), float(row["sd_diff"]), row["effect"]) == (15.0, 1.0, "cohen_dz")
    assert float(row["effect_size"]) == pytest.approx(3.0)
    half = 4.302653 / np.sqrt(3.0)
    assert float(row["ci95_lo"]) == pytest.approx(3.0 - half, rel=1e-5)
    t = 3.0 * np.sqrt(3.0)
    assert row["test"] == "paired_t"
    assert float(row["statistic"]) == pytest.approx(t, rel=1e-5)
    assert float(row["p_value"]) == pytest.approx(1.0 - t / np.sqrt(t**2 + 2.0), rel=1e-4)
    assert float(row["pair_corr"]) == pytest.approx(np.corrcoef([10, 20, 30], [13, 22, 34])[0, 1], rel=1e-5)


def test_the_key_measures_are_corrected_together_and_all_others_together(
    two_controllers_tables: tuple[list[Cells], list[Cells]],
) -> None:
    _, comparisons = two_controllers_tables
    for family, key in (("key", "1"), ("other", "0")):
        rows = [row for row in comparisons if row["key"] == key]
        assert {row["family"] for row in rows} == {family}
        tested = sorted(float(row["p_value"]) for row in rows if row["p_value"])
        assert {row["n_family"] for row in rows} == {str(len(tested))}
        smallest = min((row for row in rows if row["p_value"]), key=lambda row: float(row["p_value"]))
        assert float(smallest["p_holm"]) == pytest.approx(min(1.0, tested[0] * len(tested)), rel=1e-4)


def test_an_alternative_that_is_safer_and_slower_is_called_so(tmp_path: Path) -> None:
    folders = []
    for seed in range(1, 11):
        for name, low, delay in (("sumo", 2 + seed % 2, 10.0), ("careful", 0, 14.0 + seed % 3)):
            run = tmp_path / "runs" / f"{name}-{seed}"
            encounters = [met(1.0)] * low + [met(4.0)] * (8 - low)
            numbers = {"ego_delay_mean_s": delay, "ego_mean_speed_mps": 20.0 - delay}
            folders.append(write_study_run(run, name, seed, numbers=numbers, encounters=encounters))
    _, comparisons = tables(tmp_path / "out", folders)
    verdicts = {row["metric"]: row["verdict"] for row in comparisons}
    assert verdicts["ttc_lt_1p5_share"] == "better"
    assert verdicts["ego_delay_mean_s"] == "worse"
    assert verdicts["ego_mean_speed_mps"] == "lower"  # neither direction is worse
    assert verdicts["collision_share"] == "no_difference_shown"


def test_only_common_seeds_are_paired_and_the_rest_is_told(folders: list[Path], tmp_path: Path) -> None:
    folders += [write_study_run(tmp_path / f"runs/slow-{seed}", "slow", seed) for seed in (7, 8)]
    _, comparisons = tables(tmp_path / "out", folders)
    pair = only(comparisons, metric="n_conflicts")
    assert (pair["n_pairs"], pair["n_unpaired"], pair["n_undefined"]) == ("3", "2", "0")
    delay = only(comparisons, metric="ego_delay_mean_s")
    assert (delay["n_pairs"], delay["n_unpaired"]) == ("3", "2")


def test_a_seed_where_one_side_is_undefined_is_lost_for_that_measure_only(
    folders: list[Path], tmp_path: Path
) -> None:
    for name, delay in (("sumo", 5.0), ("slow", None)):
        run = tmp_path / f"runs/{name}-4"
        folders.append(write_study_run(run, name, 4, numbers={"ego_delay_mean_s": delay}))
    configs, comparisons = tables(tmp_path / "out", folders)
    row = only(configs, controller="slow", metric="ego_delay_mean_s")
    assert (row["n_valid"], row["n_defined"]) == ("4", "3")
    delay_row = only(comparisons, metric="ego_delay_mean_s")
    assert (delay_row["n_pairs"], delay_row["n_undefined"]) == ("3", "1")
    assert only(comparisons, metric="n_conflicts")["n_pairs"] == "4"


@pytest.mark.parametrize(
    ("baseline", "bases"),
    [
        (None, {"sumo"}),
        ("aeb", {"aeb"}),
        ("mpc", {"mpc horizon=10", "mpc horizon=20"}),
        ("mpc horizon=20", {"mpc horizon=20"}),
        ("nobody", set()),
    ],
)
def test_a_baseline_is_a_controller_or_one_of_its_variants(
    tmp_path: Path, baseline: str | None, bases: set[str]
) -> None:
    folders = [
        write_study_run(tmp_path / f"{name}{horizon}", name, 1, parameters={"horizon": horizon})
        for name, horizon in (("sumo", 0), ("aeb", 0), ("mpc", 10), ("mpc", 20))
    ]
    pairs = read_study(folders).pairs_of_labels(baseline)
    assert {base for base, _ in pairs} == bases
    assert all(alt not in bases for _, alt in pairs)


def test_variants_of_one_controller_are_compared_with_the_first_of_them(tmp_path: Path) -> None:
    folders = [
        write_study_run(tmp_path / f"{gain}", "mpc", 1, parameters={"gain": gain}) for gain in (1, 2, 3)
    ]
    for baseline in (None, "mpc"):
        pairs = read_study(folders).pairs_of_labels(baseline)
        assert pairs == [("mpc gain=1", "mpc gain=2"), ("mpc gain=1", "mpc gain=3")]


def test_runs_on_different_files_are_never_paired(tmp_path: Path) -> None:
    folders = [write_study_run(tmp_path / name, name, 1) for name in ("sumo", "aeb")]
    description = json.loads((folders[1] / "run.json").read_text())
    (folders[1] / "run.json").write_text(json.dumps({**description, "inputs": {"network": "other"}}))
    configs, comparisons = tables(tmp_path / "out", folders)
    assert comparisons == []
    assert len({row["condition"] for row in configs}) == 2
    assert all(row["condition"].startswith("inputs=") for row in configs)


def test_who_ran_under_one_of_two_conditions_is_not_compared_over_both(tmp_path: Path) -> None:
    ran = [("sumo", 300), ("aeb", 300), ("sumo", 600)]
    folders = [
        write_study_run(tmp_path / f"{name}-{demand}", name, 1, setting={"pedestrians_per_hour": demand})
        for name, demand in ran
    ]
    _, comparisons = tables(tmp_path / "out", folders)
    rows = [row for row in comparisons if row["metric"] == "ego_delay_mean_s"]
    assert [row["condition"] for row in rows] == ["pedestrians_per_hour=300"]


def test_runs_with_a_collision_are_compared_by_yes_and_no_and_over_conditions_by_their_share(
    tmp_path: Path,
) -> None:
    """Without signals, three seeds of four have collisions with the base and none with the alternative."""
    collisions = {("sumo", "none"): (1, 2, 1, 0)}
    folders = [
        write_study_run(
            tmp_path / f"{name}-{signals}-{seed}",
            name,
            seed,
            setting={"signals": signals},
            numbers={"n_collisions": collisions.get((name, signals), (0, 0, 0, 0))[seed - 1]},
        )
        for name in ("sumo", "slow")
        for signals in ("none", "all")
        for seed in (1, 2, 3, 4)
    ]
    _, comparisons = tables(tmp_path / "out", folders)
    rows = {row["condition"]: row for row in comparisons if row["metric"] == "runs_with_collision"}
    without, both = rows["signals=none"], rows["all 2 conditions"]
    assert (without["test"], float(without["diff_mean"]), float(without["p_value"])) == (
        "mcnemar",
        -0.75,
        0.25,
    )
    # 1 of 2 runs for three seeds; t is their mean over its error, 0.375 / (0.25 / 2).
    assert (both["test"], float(both["diff_mean"])) == ("paired_t", -0.375)
    assert float(both["statistic"]) == pytest.approx(-3.0)
