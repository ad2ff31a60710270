"""The measures of a study cover the numbers of its runs."""

from __future__ import annotations

import pytest

from analysis.results.measures import TALLIES, encounter_measures, run_measures
from analysis.results.metric_catalog import find_metrics
from analysis.study.tables import COMPARISONS, CONFIGS


def test_every_number_of_a_run_is_a_measure_but_wall_clock_times() -> None:
    known = {measure.name for measure in run_measures()}
    for metric in find_metrics():
        for name in (column.name for column in metric.run_columns):
            text = name in ("ped_los_hcm2010", "deadlock_where")
            assert (name in known) != (name.startswith("compute_") or text), name


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
        ("follower_min_ttc_s", "lower"),
        ("follower_max_drac_mps2", "higher"),
        ("min_vehicle_pet_s", "lower"),
        ("n_collisions_preventable", "higher"),
        ("n_collisions_crossing", "higher"),
        ("n_collisions_moved_by_pedestrian", "higher"),
        ("n_collisions_class_appeared", "higher"),
    ],
)
def test_a_measure_says_which_direction_is_worse(name: str, worse: str) -> None:
    (measure,) = [measure for measure in run_measures() if measure.name == name]
    assert measure.worse == worse
