"""The rows of configs.csv, from run folders whose numbers can be added up by hand."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.analysis.study.study_folders import write_study_run
from tests.analysis.study.study_tables import Cells, met, only, read, tables


def test_a_mean_over_runs_has_its_interval_and_the_runs_it_still_needs(
    two_controllers_tables: tuple[list[Cells], list[Cells]],
) -> None:
    configs, _ = two_controllers_tables
    row = only(configs, controller="sumo", metric="ego_delay_mean_s")
    # 10, 20, 30: mean 20, deviation 10, t(0.975, 2) = 4.3027.
    assert (row["n_runs"], row["n_valid"], row["n_defined"], row["kind"]) == ("3", "3", "3", "mean")
    assert (float(row["mean"]), float(row["sd"])) == (20.0, 10.0)
    assert float(row["sem"]) == pytest.approx(10.0 / np.sqrt(3.0), rel=1e-5)
    assert float(row["ci95_lo"]) == pytest.approx(20.0 - 4.302653 * 10.0 / np.sqrt(3.0), rel=1e-5)
    assert (row["ci_method"], row["exact_method"], row["exact95_lo"]) == ("t", "none", "")
    assert [float(row[name]) for name in ("min", "p05", "median", "p95", "max")] == [10, 11, 20, 29, 30]
    # A coefficient of variation of 0.5 needs 99 runs for 10 %.
    assert (row["n_required_e10pct"], row["n_more_e10pct"], row["enough_runs"]) == ("99", "96", "0")
    assert row["status"] == "ok"


def test_a_share_counts_encounters_that_entered_over_all_runs(
    two_controllers_tables: tuple[list[Cells], list[Cells]],
) -> None:
    configs, _ = two_controllers_tables
    row = only(configs, controller="sumo", metric="ttc_lt_1p5_share")
    # Two of four in each of three runs; the one who only waited is not counted.
    assert (row["numerator"], row["denominator"], row["denominator_unit"]) == ("6", "12", "entered encounter")
    assert float(row["mean"]) == 0.5
    assert (row["exact_method"], row["status"]) == ("clopper_pearson", "all_equal")
    assert float(row["exact95_lo"]) == pytest.approx(0.210945, abs=1e-6)
    assert float(row["exact95_hi"]) == pytest.approx(1.0 - 0.210945, abs=1e-6)
    assert (row["ci95_lo"], row["ci_method"], row["n_required_e10pct"]) == ("", "none", "")


def test_no_event_at_all_is_reported_with_its_upper_bound(
    two_controllers_tables: tuple[list[Cells], list[Cells]],
) -> None:
    configs, _ = two_controllers_tables
    share = only(configs, controller="sumo", metric="collision_share")
    assert (share["mean"], share["numerator"], share["denominator"]) == ("0", "0", "12")
    assert float(share["upper95"]) == pytest.approx(1.0 - 0.05 ** (1.0 / 12.0), rel=1e-5)
    assert float(share["ci95_hi"]) == pytest.approx(1.0 - 0.025 ** (1.0 / 12.0), rel=1e-5)
    assert share["ci_method"] == "clopper_pearson"
    rate = only(configs, controller="slow", metric="conflicts_per_veh_km")
    assert (rate["denominator"], rate["denominator_unit"], rate["unit"]) == ("6", "km", "1/km")
    assert float(rate["upper95"]) == pytest.approx(np.log(20.0) / 6.0, rel=1e-5)
    runs = only(configs, controller="sumo", metric="runs_with_collision")
    assert float(runs["upper95"]) == pytest.approx(1.0 - 0.05 ** (1.0 / 3.0), rel=1e-5)


def test_an_interval_of_a_share_of_plans_ends_at_1(tmp_path: Path) -> None:
    folders = [
        write_study_run(
            tmp_path / f"{seed}",
            "sumo",
            seed,
            numbers={"slack_share": share, "method_acts_share": share},
            encounters=[{"slack_share": share}],
        )
        for seed, share in enumerate((0.7, 1.0, 1.0), start=1)
    ]
    configs, _ = tables(tmp_path / "out", folders)
    rows = [row for row in configs if row["metric"] in ("slack_share", "method_acts_share")]
    # 0.9 ± 4.302653 · 0.1, cut where no share can be.
    assert [(row["kind"], row["mean"], row["ci95_hi"]) for row in rows] == [
        *[("mean", "0.9", "1")] * 2,
        ("encounter", "0.9", "1"),
    ]
    assert {row["ci95_lo"] for row in rows} == {"0.469735"}


def test_a_rate_is_all_events_over_all_exposure(tmp_path: Path) -> None:
    folders = [
        write_study_run(tmp_path / f"{seed}", "sumo", seed, numbers={"n_conflicts": n, "ego_dist_km": km})
        for seed, (n, km) in enumerate(((1, 1.0), (0, 2.0), (5, 3.0)), start=1)
    ]
    configs, comparisons = tables(tmp_path / "out", folders)
    row = only(configs, metric="conflicts_per_veh_km")
    assert (row["numerator"], row["denominator"], float(row["mean"])) == ("6", "6", 1.0)
    # Contributions 1 + (y − x) / 2: 1, 0, 2.
    assert float(row["sd"]) == pytest.approx(1.0)
    assert float(row["ci95_lo"]) == 0.0
    assert float(row["ci95_hi"]) == pytest.approx(1.0 + 4.302653 / np.sqrt(3.0), rel=1e-5)
    assert float(row["exact95_hi"]) == pytest.approx(13.05947 / 6.0, rel=1e-5)
    assert comparisons == []


def test_encounters_are_summed_up_by_percentiles_and_by_a_mean_where_all_have_a_value(
    tmp_path: Path,
) -> None:
    runs: list[list[tuple[float | None, float]]] = [
        [(1.0, 1.0), (None, 2.0)],
        [(2.0, 3.0), (3.0, 4.0), (None, 5.0)],
        [(None, 9.0)],
    ]
    folders = [
        write_study_run(
            tmp_path / f"{seed}", "sumo", seed, encounters=[met(ttc, min_dist_m=dist) for ttc, dist in values]
        )
        for seed, values in enumerate(runs, start=1)
    ]
    configs, _ = tables(tmp_path / "out", folders)
    ttc = only(configs, metric="min_ttc_s", kind="encounter")
    assert (ttc["numerator"], ttc["denominator"], ttc["n_defined"]) == ("3", "6", "2")
    assert (ttc["mean"], ttc["ci95_lo"], ttc["status"]) == ("", "", "partly_defined")
    assert (ttc["median"], ttc["min"], ttc["max"], ttc["tail"]) == ("2", "1", "3", "p05")
    # Two runs with a TTC: a resample has 1, 1 or 1, 2, 3 or 2, 2, 3, 3.
    assert (float(ttc["tail95_lo"]), float(ttc["tail95_hi"])) == (1.0, 2.0)
    distance = only(configs, metric="min_dist_m", kind="encounter")
    assert (float(distance["mean"]), distance["status"], distance["tail"]) == (4.0, "ok", "p05")
    # Σ y / Σ x = 24 / 6; contributions 4 + (y − 4 x) / 2 with y, x = 3, 2; 12, 3; 9, 1.
    assert float(distance["sd"]) == pytest.approx(np.std([1.5, 4.0, 6.5], ddof=1), rel=1e-5)


def test_a_run_that_is_not_valid_is_counted_and_in_no_mean(folders: list[Path], tmp_path: Path) -> None:
    wild = {"ego_delay_mean_s": 1e6}
    folders += [
        write_study_run(tmp_path / "runs/sumo-4", "sumo", 4, numbers=wild, invalid="teleported"),
        write_study_run(tmp_path / "runs/slow-4", "slow", 4, numbers=wild),
        write_study_run(tmp_path / "runs/sumo-5", "sumo", 5, invalid="has not ended", analysed=False),
    ]
    configs, comparisons = tables(tmp_path / "out", folders)
    row = only(configs, controller="sumo", metric="ego_delay_mean_s")
    assert (row["n_runs"], row["n_valid"], row["n_defined"], row["mean"]) == ("5", "3", "3", "20")
    pair = only(comparisons, metric="ego_delay_mean_s")
    assert (pair["n_pairs"], pair["n_invalid"], pair["n_unpaired"]) == ("3", "1", "1")
    assert float(pair["diff_mean"]) == 3.0
    assert [run["valid"] for run in read(tmp_path / "out/runs.csv")].count("0") == 1


@pytest.mark.parametrize(
    ("values", "status", "n_defined"),
    [
        ([5.0], "one_run", "1"),
        ([5.0, 5.0, 5.0], "all_equal", "3"),
        ([None, None], "undefined", "0"),
        ([None, 5.0], "one_run", "1"),
    ],
)
def test_what_cannot_be_said_is_empty_and_says_why(
    tmp_path: Path, values: list[float | None], status: str, n_defined: str
) -> None:
    folders = []
    for name in ("sumo", "slow"):
        for seed, value in enumerate(values, start=1):
            run = tmp_path / "runs" / f"{name}-{seed}"
            folders.append(write_study_run(run, name, seed, numbers={"ego_delay_mean_s": value}))
    configs, comparisons = tables(tmp_path / "out", folders)
    row = only(configs, controller="slow", metric="ego_delay_mean_s")
    assert (row["status"], row["n_defined"]) == (status, n_defined)
    assert row["ci95_lo"] == row["ci95_hi"] == row["n_required_e10pct"] == row["enough_runs"] == ""
    assert (row["mean"] == "") == (status == "undefined")
    pair = only(comparisons, metric="ego_delay_mean_s")
    expected = {"one_run": "one_pair", "all_equal": "no_difference", "undefined": "no_pairs"}
    assert (pair["status"], pair["test"]) == (expected[status], "none")
    assert pair["p_value"] == pair["p_holm"] == pair["significant_05"] == ""
    assert pair["verdict"] == "no_difference_shown"


def test_a_configuration_whose_runs_all_failed_has_rows_without_numbers(
    folders: list[Path], tmp_path: Path
) -> None:
    folders.append(write_study_run(tmp_path / "runs/broken-1", "broken", 1, invalid="crashed"))
    configs, comparisons = tables(tmp_path / "out", folders)
    rows = [row for row in configs if row["controller"] == "broken"]
    assert {(row["n_runs"], row["n_valid"], row["status"]) for row in rows} == {("1", "0", "no_valid_run")}
    pair = only(comparisons, alt="broken", metric="n_conflicts")
    assert (pair["n_pairs"], pair["n_invalid"], pair["n_unpaired"]) == ("0", "1", "2")


def test_two_versions_of_ones_own_controller_are_told_apart(tmp_path: Path) -> None:
    for version, delay in (("a1b2c3d4e5", 10.0), ("f6a7b8c9d0", 20.0)):
        folder = write_study_run(tmp_path / version, "mine", 1, numbers={"ego_delay_mean_s": delay})
        path = folder / "run.json"
        described = json.loads(path.read_text())
        changed = {
            "controller_files": {"mine.py": version},
            "config_id": f"mine-{version}",
            "run_id": version,
        }
        path.write_text(json.dumps(described | changed))
    configs, comparisons = tables(tmp_path / "tables", [tmp_path / "a1b2c3d4e5", tmp_path / "f6a7b8c9d0"])
    rows = [row for row in configs if row["metric"] == "ego_delay_mean_s"]
    assert [(row["configuration"], float(row["mean"])) for row in rows] == [
        ("mine file=a1b2c3d4", 10.0),
        ("mine file=f6a7b8c9", 20.0),
    ]
    assert float(only(comparisons, metric="ego_delay_mean_s")["diff_mean"]) == 10.0


def test_parameters_that_the_study_varies_tell_configurations_and_conditions_apart(tmp_path: Path) -> None:
    folders = []
    for demand in (300, 600):
        for seed in (1, 2, 3):
            for name, parameters in (
                ("sumo", {}),
                ("mpc", {"horizon": 10, "solver": "osqp"}),
                ("mpc", {"horizon": 20, "solver": "osqp"}),
            ):
                value = demand / 100 + seed + 0.5 * seed * parameters.get("horizon", 0)  # type: ignore[operator]
                folders.append(
                    write_study_run(
                        tmp_path / "runs" / f"{demand}-{name}-{parameters.get('horizon')}-{seed}",
                        name,
                        seed,
                        parameters=parameters,
                        setting={"pedestrians_per_hour": demand, "lanes": 3},
                        numbers={"ego_delay_mean_s": value},
                    )
                )
    configs, comparisons = tables(tmp_path / "out", folders)
    delay = [row for row in configs if row["metric"] == "ego_delay_mean_s"]
    assert {row["configuration"] for row in delay} == {"sumo", "mpc horizon=10", "mpc horizon=20"}
    assert {row["condition"] for row in delay} == {"pedestrians_per_hour=300", "pedestrians_per_hour=600"}
    assert len(delay) == len({row["config_id"] for row in delay}) == 6
    rows = [row for row in comparisons if row["metric"] == "ego_delay_mean_s"]
    assert [row["condition"] for row in rows] == [
        *["pedestrians_per_hour=300"] * 2,
        *["pedestrians_per_hour=600"] * 2,
        *["all 2 conditions"] * 2,
    ]
    # Over all conditions a seed counts once, with its mean.
    pooled = only(rows, condition_id="all", alt="mpc horizon=20")
    assert (pooled["n_pairs"], float(pooled["base_mean"]), float(pooled["diff_mean"])) == ("3", 6.5, 20.0)
    # One family has the tests of both alternatives.
    key = [row for row in comparisons if row["condition_id"] == "all" and row["key"] == "1"]
    assert {row["n_family"] for row in key} == {str(sum(bool(row["p_value"]) for row in key))}
    assert {row["alt"] for row in key} == {"mpc horizon=10", "mpc horizon=20"}
