"""Worse than a baseline: paired by seed, corrected together, in the direction that is worse."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from analysis.results.measures import Measure, run_measures
from analysis.study.regression import Pairing, regression_rows
from analysis.study.runs import StudyRun, read_runs
from tests.analysis.study.study_folders import write_study_run

MEASURES = {measure.name: measure for measure in run_measures()}
NOISE = (0.1, -0.2, 0.15, -0.05, 0.0, -0.1)


def runs(folder: Path, column: str, values: Sequence[float]) -> list[StudyRun]:
    return read_runs(
        [
            write_study_run(folder / str(seed), "driver", seed, numbers={column: value})
            for seed, value in enumerate(values, 1)
        ]
    )


def compared(folder: Path, column: str, then: Sequence[float], now: Sequence[float]) -> Pairing:
    return Pairing(runs(folder / "then", column, then), runs(folder / "now", column, now))


def chosen(*names: str) -> list[Measure]:
    return [MEASURES[name] for name in names]


def test_a_delay_that_grew_on_every_seed_is_worse_and_one_that_shrank_is_not(tmp_path: Path) -> None:
    then = [10.0 + noise for noise in NOISE]
    now = [value + 2.0 - noise / 3 for value, noise in zip(then, NOISE, strict=True)]
    pairings = [
        compared(tmp_path / "up", "ego_delay_mean_s", then, now),
        compared(tmp_path / "down", "ego_delay_mean_s", now, then),
    ]
    grown, shrunk = regression_rows(pairings, chosen("ego_delay_mean_s"), 0.05)
    assert grown[0]["worse_now"] is True
    assert grown[0]["diff_mean"] == pytest.approx(2.0 - sum(NOISE) / 18)
    assert shrunk[0]["worse_now"] is False
    assert grown[0]["p_holm"] == shrunk[0]["p_holm"] < 0.001


def test_ranks_that_moved_the_other_way_than_the_mean_show_nothing(tmp_path: Path) -> None:
    """27 of 30 seeds lose less time, 3 much more: the test of ranks is significant, for the better."""
    then = [10.0 + 0.01 * seed for seed in range(30)]
    now = [value + (8.0 if seed >= 27 else -0.5 - 0.01 * seed) for seed, value in enumerate(then)]
    (row,) = regression_rows(
        [compared(tmp_path, "ego_delay_mean_s", then, now)], chosen("ego_delay_mean_s"), 0.05
    )[0]
    assert row["test"] == "wilcoxon"
    assert row["p_holm"] < 0.05
    assert row["diff_mean"] > 0.0
    assert row["worse_now"] is False


def test_what_is_worse_when_lower_counts_in_that_direction(tmp_path: Path) -> None:
    then = [2.0 + noise for noise in NOISE]
    now = [value - 1.0 + noise / 4 for value, noise in zip(then, NOISE, strict=True)]
    ((row,),) = regression_rows([compared(tmp_path, "min_pet_s", then, now)], chosen("min_pet_s"), 0.05)
    assert row["worse"] == "lower"
    assert row["worse_now"] is True


def test_scatter_without_a_trend_is_not_worse(tmp_path: Path) -> None:
    then = [10.0, 12.0, 11.0, 9.0, 10.5, 11.5]
    now = [11.0, 11.5, 11.8, 9.9, 9.6, 11.4]
    ((row,),) = regression_rows(
        [compared(tmp_path, "ego_delay_mean_s", then, now)], chosen("ego_delay_mean_s"), 0.05
    )
    assert row["diff_mean"] > 0.0
    assert row["worse_now"] is False


def test_the_tests_of_all_configurations_are_corrected_together(tmp_path: Path) -> None:
    then = [10.0 + noise for noise in NOISE]
    now = [value + 0.15 - 0.4 * noise for value, noise in zip(then, NOISE, strict=True)]
    one = compared(tmp_path / "one", "ego_delay_mean_s", then, now)
    ((alone,),) = regression_rows([one], chosen("ego_delay_mean_s"), 0.05)
    together = regression_rows([one] * 12, chosen("ego_delay_mean_s"), 0.05)
    assert alone["worse_now"] is True
    assert together[0][0]["p_value"] == alone["p_value"]
    assert together[0][0]["p_holm"] == pytest.approx(min(1.0, 12 * alone["p_value"]))
    assert together[0][0]["n_family"] == 12


def test_the_level_decides(tmp_path: Path) -> None:
    then = [10.0 + noise for noise in NOISE]
    now = [value + 0.15 - 0.4 * noise for value, noise in zip(then, NOISE, strict=True)]
    one = compared(tmp_path, "ego_delay_mean_s", then, now)
    ((row,),) = regression_rows([one], chosen("ego_delay_mean_s"), 0.05)
    found = [
        regression_rows([one], chosen("ego_delay_mean_s"), level)[0][0]["worse_now"]
        for level in (row["p_holm"] * 0.99, row["p_holm"] * 1.01)
    ]
    assert found == [False, True]


def test_equal_runs_have_no_test_and_are_not_worse(tmp_path: Path) -> None:
    values = [10.0, 11.0, 12.0]
    ((row,),) = regression_rows(
        [compared(tmp_path, "ego_delay_mean_s", values, values)], chosen("ego_delay_mean_s"), 0.05
    )
    assert (row["p_holm"], row["worse_now"], row["status"]) == (None, False, "no_difference")


def test_a_measure_without_a_bad_direction_is_not_compared(tmp_path: Path) -> None:
    ((),) = regression_rows([compared(tmp_path, "n_plans", [1.0, 2.0], [5.0, 9.0])], chosen("n_plans"), 0.05)
