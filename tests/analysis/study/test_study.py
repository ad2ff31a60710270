"""The tables of a study, from run folders whose numbers can be added up by hand."""

from __future__ import annotations

import csv
import json
import shutil
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.errors import StudyError
from analysis.results.analyse import analyse_run
from analysis.results.measures import TALLIES, encounter_measures, run_measures
from analysis.results.metric_catalog import find_metrics
from analysis.study.design import read_study
from analysis.study.runs import find_run_folders, read_runs
from analysis.study.tables import COMPARISONS, CONFIGS, STUDY_TABLES
from analysis.study.writing import write_tables
from tests.analysis.recorded import Ego, Person, line, write_run
from tests.analysis.study.study_folders import write_study_run

FILES = ("runs.csv", "encounters.csv", "configs.csv", "comparisons.csv", "datapackage.json")
Cells = dict[str, str]


def read(path: Path) -> list[Cells]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def tables(out: Path, folders: list[Path], baseline: str | None = None) -> tuple[list[Cells], list[Cells]]:
    """Write the tables and return the rows of configs.csv and comparisons.csv."""
    write_tables(out, folders, baseline)
    return read(out / "configs.csv"), read(out / "comparisons.csv")


def only(rows: list[Cells], **cells: str) -> Cells:
    (row,) = [row for row in rows if all(row[name] == value for name, value in cells.items())]
    return row


def met(ttc: float | None = None, **cells: Any) -> dict[str, Any]:
    return {"min_ttc_s": ttc, **cells}


def two_controllers(folder: Path) -> list[Path]:
    """Write three seeds of `slow` and `sumo`: delays 10, 20, 30 and 13, 22, 34; some TTC below 1.5 s."""
    found = []
    for seed, (delay, more) in enumerate(((10.0, 3.0), (20.0, 2.0), (30.0, 4.0)), start=1):
        for name, value, low in (("sumo", delay, 2), ("slow", delay + more, 0)):
            encounters = [met(1.0)] * low + [met(4.0)] * (4 - low) + [met(0.5, entered=False)]
            numbers = {"ego_delay_mean_s": value, "n_conflicts": low, "ego_dist_km": 2.0}
            run = folder / f"{name}-{seed}"
            found.append(write_study_run(run, name, seed, numbers=numbers, encounters=encounters))
    return found


@pytest.fixture
def folders(tmp_path: Path) -> list[Path]:
    return two_controllers(tmp_path / "runs")


# the numbers


def test_a_mean_over_runs_has_its_interval_and_the_runs_it_still_needs(
    folders: list[Path], tmp_path: Path
) -> None:
    configs, _ = tables(tmp_path / "out", folders)
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


def test_a_share_counts_encounters_that_entered_over_all_runs(folders: list[Path], tmp_path: Path) -> None:
    configs, _ = tables(tmp_path / "out", folders)
    row = only(configs, controller="sumo", metric="ttc_lt_1p5_share")
    # Two of four in each of three runs; the one who only waited is not counted.
    assert (row["numerator"], row["denominator"], row["denominator_unit"]) == ("6", "12", "encounter")
    assert float(row["mean"]) == 0.5
    assert (row["exact_method"], row["status"]) == ("clopper_pearson", "all_equal")
    assert float(row["exact95_lo"]) == pytest.approx(0.210945, abs=1e-6)
    assert float(row["exact95_hi"]) == pytest.approx(1.0 - 0.210945, abs=1e-6)
    assert (row["ci95_lo"], row["ci_method"], row["n_required_e10pct"]) == ("", "none", "")


def test_no_event_at_all_is_reported_with_its_upper_bound(folders: list[Path], tmp_path: Path) -> None:
    configs, _ = tables(tmp_path / "out", folders)
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


def test_a_difference_is_that_of_the_pairs(folders: list[Path], tmp_path: Path) -> None:
    _, comparisons = tables(tmp_path / "out", folders)
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
    folders: list[Path], tmp_path: Path
) -> None:
    _, comparisons = tables(tmp_path / "out", folders)
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


# runs that do not count


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


# what was varied


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


# the files


def test_the_same_runs_give_the_same_bytes_in_any_order(folders: list[Path], tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    write_tables(one, folders, "sumo")
    write_tables(other, [folders[i] for i in (4, 1, 5, 0, 3, 2)], "sumo")
    for name in FILES:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name
    write_tables(one, folders, "sumo")
    for name in FILES:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name
    assert sorted(path.name for path in one.iterdir()) == sorted(FILES)


def test_wall_clock_times_are_in_no_table_but_that_of_the_runs(folders: list[Path], tmp_path: Path) -> None:
    write_tables(tmp_path / "one", folders, None)
    for seed, folder in enumerate(folders):
        with (folder / "runs.csv").open(encoding="utf-8", newline="") as file:
            (row,) = csv.DictReader(file)
        row.update(wall_s=str(seed + 0.5), compute_p95_ms=str(seed))
        with (folder / "runs.csv").open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, row, lineterminator="\n")
            writer.writeheader()
            writer.writerow(row)
    write_tables(tmp_path / "two", folders, None)
    same = [name for name in FILES if name != "runs.csv"]
    assert [(tmp_path / "one" / n).read_bytes() for n in same] == [
        (tmp_path / "two" / n).read_bytes() for n in same
    ]
    assert read(tmp_path / "two/runs.csv")[3]["wall_s"] != ""


@pytest.mark.parametrize("table", STUDY_TABLES, ids=lambda table: table.name)
def test_a_file_has_the_columns_of_the_schema_and_its_rows_are_sorted(
    folders: list[Path], tmp_path: Path, table: Any
) -> None:
    write_tables(tmp_path / "out", folders, None)
    with (tmp_path / "out" / table.file).open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    assert tuple(header) == table.names()
    keys = [tuple(row[header.index(name)] for name in table.key) for row in rows]
    assert len(set(keys)) == len(keys)
    if table.name == "runs":
        assert keys == sorted(keys)
    assert all(cell not in ("nan", "inf", "None", "True") for row in rows for cell in row)


def test_frictionless_finds_the_tables_of_analysed_runs_valid(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folders = []
    for seed in (1, 2, 3):
        for name, speed in (("sumo", 10.0), ("slow", 6.0)):
            run = write_run(
                tmp_path / "runs" / f"{name}-{seed}",
                [Ego(line(-20.0 - seed, 0, speed, 0))],
                [Person(line(32.5, -4, 0, 1.25)), Person(line(32.5, -5 - 0.1 * seed, 0, 1.2), name="b")],
                controller=name,
                config_id=f"{name}-0",
                seed=seed,
                run_id=f"{name}-{seed}",
            )
            analyse_run(run)
            folders.append(run)
    configs, comparisons = tables(tmp_path / "out", folders)
    assert only(configs, controller="sumo", metric="n_encounters")["mean"] == "2"
    assert only(comparisons, metric="ego_mean_speed_mps")["alt_mean"] == "6"
    assert only(comparisons, metric="ego_mean_speed_mps")["test"] == "sign"
    encounters = [row for folder in sorted(folders) for row in read(folder / "encounters.csv")]
    assert read(tmp_path / "out/encounters.csv") == sorted(
        encounters, key=lambda row: (row["config_id"], int(row["seed"]), int(row["encounter_id"]))
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its own dependencies warn on import
        import frictionless

        monkeypatch.chdir(tmp_path / "out")
        result = frictionless.Package("datapackage.json").validate()
        (tmp_path / "out/configs.csv").write_text(
            (tmp_path / "out/configs.csv").read_text().replace("partly_defined", "perhaps")
        )
        spoilt = frictionless.Package("datapackage.json").validate()
    assert result.valid, result.flatten(["type", "rowNumber", "fieldName", "message"])
    assert not spoilt.valid


def test_a_dictionary_that_is_there_keeps_what_else_it_describes(folders: list[Path], tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "datapackage.json").write_text(json.dumps({"resources": [{"name": "criteria"}, {"name": "runs"}]}))
    write_tables(out, folders, None)
    names = [one["name"] for one in json.loads((out / "datapackage.json").read_text())["resources"]]
    assert names == ["runs", "encounters", "configs", "comparisons", "criteria"]


def test_what_goes_wrong_while_writing_leaves_the_files_of_before(
    folders: list[Path], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    write_tables(out, folders, None)
    before = {name: (out / name).read_bytes() for name in FILES}
    (out / "comparisons.csv.part").mkdir()  # a name that cannot be written to
    with pytest.raises(OSError, match="comparisons"):
        write_tables(out, folders, None)
    assert {name: (out / name).read_bytes() for name in FILES} == before


def test_a_run_that_cannot_be_read_is_left_out_and_named(folders: list[Path], tmp_path: Path) -> None:
    write_tables(tmp_path / "without", folders[1:], None)
    for damage in ("[]", '{"seed": "one"}', "{"):
        (folders[0] / "run.json").write_text(damage)
        unreadable = write_tables(tmp_path / "out", folders, None)
        assert list(unreadable) == [folders[0]]
        assert str(folders[0] / "run.json") in unreadable[folders[0]]
        for name in FILES:
            assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "without" / name).read_bytes()
    with pytest.raises(StudyError, match=r"run\.json"):
        write_tables(tmp_path / "out", folders[:1], None)


# what is refused


def test_the_same_run_twice_counts_once(folders: list[Path], tmp_path: Path) -> None:
    again = shutil.copytree(folders[0], tmp_path / "runs/again")
    assert len(read_runs([*folders, again])) == 6


def test_a_run_that_was_made_again_takes_the_place_of_the_failed_one(
    folders: list[Path], tmp_path: Path
) -> None:
    failed = write_study_run(tmp_path / "runs/attempt", "sumo", 1, invalid="killed", analysed=False)
    runs = read_runs([failed, *folders])
    assert len(runs) == 6
    assert all(run.valid for run in runs)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"numbers": {"ego_delay_mean_s": 11.0}}, "two runs of"),
        ({"run_id": "other-version"}, "two runs of"),
    ],
)
def test_two_runs_of_a_seed_that_differ_are_refused(
    folders: list[Path], tmp_path: Path, change: dict[str, Any], says: str
) -> None:
    other = write_study_run(tmp_path / "runs/other", "sumo", 1, **change)
    with pytest.raises(StudyError, match=says) as caught:
        read_runs([*folders, other])
    assert str(other) in str(caught.value)
    assert str(folders[0]) in str(caught.value)


def test_runs_analysed_with_different_thresholds_are_refused(folders: list[Path], tmp_path: Path) -> None:
    other = write_study_run(tmp_path / "runs/other", "sumo", 9, thresholds={"hard_brake_mps2": 3.0})
    with pytest.raises(StudyError, match="different thresholds"):
        read_runs([*folders, other])


def test_a_valid_run_without_numbers_has_to_be_analysed(tmp_path: Path) -> None:
    folder = write_study_run(tmp_path, "sumo", 1, analysed=False)
    with pytest.raises(StudyError, match="cosim analyse"):
        read_runs([folder])


@pytest.mark.parametrize(
    ("file", "text", "says"),
    [
        ("run.json", "{", "not JSON"),
        ("run.json", "{}", "no value for 'run_id'"),
        ("run.json", "[]", "expected an object, found list"),
        ("runs.csv", "run_id\n1\n", "one row with the columns of schema"),
        ("runs.csv", "", "one row with the columns of schema"),
        ("encounters.csv", "run_id\n1\n", "expected the columns of schema"),
        ("encounters.csv", "", "expected the columns of schema"),
        ("config.json", "{", "cannot be read"),
    ],
)
def test_a_broken_file_is_named_in_one_line(tmp_path: Path, file: str, text: str, says: str) -> None:
    folder = write_study_run(tmp_path / "run", "sumo", 1)
    (folder / file).write_text(text)
    with pytest.raises(StudyError, match=says) as caught:
        read_runs([folder])
    assert str(folder / file) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_run_folders_are_found_at_any_depth_but_not_in_unfinished_ones(tmp_path: Path) -> None:
    wanted = [tmp_path / "b/run", tmp_path / "a/deep/er"]
    for folder in (*wanted, tmp_path / ".hidden/run", tmp_path / "half.part", tmp_path / "a/x.tmp/run"):
        write_study_run(folder, "sumo", 1)
    write_study_run(tmp_path / "b/run/inside", "sumo", 1)
    assert find_run_folders(tmp_path) == sorted(wanted)
    assert find_run_folders(wanted[0]) == wanted[:1]


# the measures


def test_every_number_of_a_run_is_a_measure_but_wall_clock_times() -> None:
    known = {measure.name for measure in run_measures()}
    for metric in find_metrics():
        for name in (column.name for column in metric.run_columns):
            assert (name in known) != (name.startswith("compute_") or name == "ped_los_hcm2010"), name


def test_every_measure_is_made_of_columns_and_tallies_that_exist() -> None:
    from analysis.results.run_tables import RUNS

    known = {*RUNS.names(), *TALLIES}
    for measure in run_measures():
        assert measure.numerator in known
        assert not measure.denominator or measure.denominator in known
    names = [measure.name for measure in run_measures()]
    assert len(names) == len(set(names))
    for table, of in ((CONFIGS, "kind"), (COMPARISONS, "kind"), (CONFIGS, "group"), (COMPARISONS, "worse")):
        (column,) = [column for column in table.columns if column.name == of]
        for measure in (*run_measures(), *encounter_measures()):
            assert getattr(measure, of) in column.choices


@pytest.mark.parametrize(
    ("name", "worse"),
    [
        ("n_pet_lt_1p0", "higher"),
        ("min_pet_s", "lower"),
        ("n_pet_defined", "neither"),
        ("n_ttc_lt_1p5", "higher"),
        ("clearance_p05_m", "lower"),
        ("yields", "lower"),
        ("yieldable", "neither"),
        ("n_severity_none", "neither"),
        ("n_severity_severe", "higher"),
        ("n_plans", "neither"),
        ("n_lane_changes", "neither"),
        ("ego_delay_mean_s", "higher"),
    ],
)
def test_a_measure_says_which_direction_is_worse(name: str, worse: str) -> None:
    (measure,) = [measure for measure in run_measures() if measure.name == name]
    assert measure.worse == worse


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
