"""Criteria: borders, undefined values, statistics, and mistakes in a table."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from analysis.criteria.criterion import (
    OPERATORS,
    STATISTICS,
    Criterion,
    chosen_rows,
    judge,
    margin,
    row_value,
    statistic_value,
)
from analysis.criteria.reading import CriterionError, read_criteria
from analysis.criteria.table import CRITERIA
from analysis.results.measures import encounter_measures, run_measures
from analysis.study.tables import CONFIGS

RUN = {"scope": "run", "metric": "n_collisions", "operator": "==", "threshold": 0}
SHARE = {
    "scope": "configuration",
    "metric": "collision_share",
    "statistic": "upper_95",
    "operator": "<",
    "threshold": 0.01,
}


def criterion(sign: str, threshold: float) -> Criterion:
    return Criterion("one", "run", "min_dist_m", sign, threshold)


def refused(**changes: Any) -> str:
    """Return why a criterion on runs with these changes cannot be read; ``None`` removes a key."""
    table = {key: value for key, value in {**RUN, **changes}.items() if value is not None}
    with pytest.raises(CriterionError) as caught:
        read_criteria([table])
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("sign", "below", "at", "above"),
    [
        ("<", "pass", "fail", "fail"),
        ("<=", "pass", "pass", "fail"),
        (">", "fail", "fail", "pass"),
        (">=", "fail", "pass", "pass"),
        ("==", "fail", "pass", "fail"),
    ],
)
def test_the_threshold_itself_passes_where_the_operator_says_so(
    sign: str, below: str, at: str, above: str
) -> None:
    found = [judge(criterion(sign, 1.5), value).status for value in (1.25, 1.5, 1.75)]
    assert found == [below, at, above]


@given(st.sampled_from(sorted(OPERATORS)), st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
def test_the_sign_of_the_margin_agrees_with_the_status(sign: str, threshold: float, value: float) -> None:
    found = judge(criterion(sign, threshold), value)
    assert found.margin is not None
    if found.margin > 0.0:
        assert found.status == "pass"
    if found.margin < 0.0:
        assert found.status == "fail"
    assert abs(found.margin) == abs(value - threshold)


def test_margins_are_positive_on_the_side_that_passes() -> None:
    assert margin("<", 2.0, 0.5) == 1.5
    assert margin(">=", 2.0, 0.5) == -1.5
    assert margin("==", 2.0, 0.5) == -1.5
    assert margin("==", 2.0, 2.0) == 0.0


def test_an_undefined_value_neither_passes_nor_has_a_margin() -> None:
    one = criterion("<", 1.0)
    found = judge(one, row_value(one, {"min_dist_m": ""}))
    assert (found.status, found.value, found.margin) == ("undefined", None, None)


def test_rows_are_chosen_by_number_text_and_truth_and_an_empty_cell_is_equal_to_nothing() -> None:
    rows = [
        {"preventable_r157": "1", "severity": "collision"},
        {"preventable_r157": "0", "severity": "collision"},
        {"preventable_r157": "", "severity": "none"},
    ]

    def chosen(**where: bool | float | str) -> list[int]:
        one = Criterion("one", "encounter", "collision", "==", 0.0, where=where)
        return [rows.index(dict(row)) for row in chosen_rows(one, rows)]

    assert chosen() == [0, 1, 2]
    assert chosen(preventable_r157=1) == [0]
    assert chosen(preventable_r157=False) == [1]
    assert chosen(severity="collision") == [0, 1]
    assert chosen(severity="collision", preventable_r157=0) == [1]


def test_statistics_are_columns_of_the_configurations_and_each_kind_of_measure_has_some() -> None:
    names = set(CONFIGS.names())
    assert {column for column, _ in STATISTICS.values() if column} <= names
    for measure in (*run_measures(), *encounter_measures()):
        assert any(measure.kind in kinds for _, kinds in STATISTICS.values())


@pytest.mark.parametrize(
    ("statistic", "kind", "value"),
    [
        ("mean", "share", 0.1),
        ("share", "share", 0.1),
        ("total", "share", 1.0),
        ("upper_95", "share", 0.394),
        ("exact95_lo", "share", 0.003),
        ("exact95_hi", "share", 0.445),
        ("ci95_lo", "mean", 2.0),
        ("ci95_hi", "mean", 4.0),
        ("p95", "mean", 5.0),
        ("tail95_hi", "encounter", 6.0),
    ],
)
def test_a_statistic_is_what_its_name_says_of_a_configuration(
    statistic: str, kind: str, value: float
) -> None:
    """Of one event in ten trials, and of other numbers that are all different."""
    row = configuration_row(kind, "1", "10") | {
        **{"mean": "0.1", "upper95": "0.394", "exact95_lo": "0.003", "exact95_hi": "0.445"},
        **{"ci95_lo": "2", "ci95_hi": "4", "p95": "5", "tail95_lo": "5.5", "tail95_hi": "6", "max": "7"},
    }
    one = Criterion("one", "configuration", row["metric"], "<", 0.0, statistic=statistic, kind=kind)
    assert statistic_value(one, row) == value


def configuration_row(kind: str, numerator: str, denominator: str) -> dict[str, str]:
    empty = dict.fromkeys(CONFIGS.names(), "")
    metric = "collision_share" if kind == "share" else "collisions_per_veh_km"
    return {**empty, "metric": metric, "kind": kind, "numerator": numerator, "denominator": denominator}


def bound(kind: str, numerator: str, denominator: str) -> float | None:
    row = configuration_row(kind, numerator, denominator)
    one = Criterion("one", "configuration", row["metric"], ">", 0.0, statistic="lower_95", kind=kind)
    return statistic_value(one, row)


def test_the_lower_bound_of_a_share_is_where_so_many_events_have_five_per_cent() -> None:
    found = bound("share", "7", "20")
    assert found is not None
    assert stats.binom.sf(6, 20, found) == pytest.approx(0.05, abs=1e-9)


def test_the_lower_bound_of_a_rate_is_where_so_many_events_have_five_per_cent() -> None:
    found = bound("rate", "4", "2.5")
    assert found is not None
    assert stats.poisson.sf(3, 2.5 * found) == pytest.approx(0.05, abs=1e-9)


def test_a_bound_without_exposure_is_undefined() -> None:
    assert bound("share", "", "") is None
    assert bound("share", "0", "0") is None


def test_a_row_of_another_measure_is_not_judged() -> None:
    one = Criterion("one", "configuration", "yield_rate", ">", 0.0, statistic="mean", kind="share")
    with pytest.raises(ValueError, match="yield_rate"):
        statistic_value(one, configuration_row("share", "1", "2"))


def test_a_criterion_has_the_unit_of_its_column_and_a_name_that_says_what_it_is() -> None:
    (run,) = read_criteria([RUN])
    assert (run.id, run.unit, run.threshold) == ("n_collisions == 0", "1", 0.0)
    (share,) = read_criteria([SHARE])
    assert (share.id, share.kind) == ("upper_95 of collision_share < 0.01", "share")
    (speed,) = read_criteria([{**RUN, "scope": "encounter", "metric": "impact_speed_kmh"}])
    assert speed.unit == "km/h"


def test_contacts_are_chosen_by_place_class_and_what_a_careful_driver_prevents() -> None:
    where = {"contact_place": "carriageway", "contact_class": "ego", "preventable_r157": 1}
    (one,) = read_criteria([{**RUN, "scope": "encounter", "metric": "collision", "where": where}])
    assert one.where == where
    assert "expected crossing, carriageway, walking_area_or_kerb" in refused(
        scope="encounter", metric="collision", where={"contact_place": "road"}
    )
    (count,) = read_criteria([{**RUN, "metric": "n_collisions_preventable"}])
    assert count.id == "n_collisions_preventable == 0"


def test_filters_choose_scenarios_and_controllers() -> None:
    (one,) = read_criteria([{**RUN, "controllers": ["aeb"], "scenarios": ["town"]}])
    assert one.applies_to("town", "aeb")
    assert not one.applies_to("town", "sumo")
    assert not one.applies_to("village", "aeb")
    (all_of_them,) = read_criteria([RUN])
    assert all_of_them.applies_to("village", "sumo")


def test_a_truth_value_is_a_threshold_of_a_truth_value_only() -> None:
    (one,) = read_criteria([{**RUN, "scope": "encounter", "metric": "collision", "threshold": False}])
    assert one.threshold == 0.0
    assert "expected a number, got false" in refused(threshold=False)


@pytest.mark.parametrize(
    ("changes", "part"),
    [
        ({"metric": "n_colisions"}, "did you mean 'n_collisions'?"),
        ({"metric": "collision"}, "it exists with scope = 'encounter'"),
        ({"metric": "collision_share"}, "it exists with scope = 'configuration'"),
        ({"metric": "controller"}, "'controller' is no metric of runs.csv"),
        ({"threshold": "0"}, "threshold: expected a number, got '0'"),
        ({"threshold": None}, "threshold is missing; expected a number"),
        ({"threshold": float("nan")}, "threshold: expected a number, got nan"),
        ({"operator": "=<"}, "expected one of < <= > >= =="),
        ({"operator": None}, "'operator' is missing"),
        ({"scope": "runs"}, "did you mean 'run'?"),
        ({"statistic": "mean"}, 'statistic belongs to scope = "configuration"'),
        ({"treshold": 1}, "unknown key 'treshold'; did you mean 'threshold'?"),
        ({"where": {"n_collision": 1}}, "did you mean 'n_collisions'?"),
        ({"where": {"actuation": 1}}, "where: actuation: expected a text, got 1"),
        ({"where": {"seed": "one"}}, "where: seed: expected a number, got 'one'"),
        ({"where": 3}, "where: expected a table of columns and values"),
        ({"controllers": "aeb"}, "controllers: expected a list of names"),
        ({"controllers": []}, "controllers: expected at least one name"),
        ({"allow_undefined": 1}, "allow_undefined: expected true or false"),
        ({"id": ""}, "id: expected a text"),
        ({**SHARE, "statistic": None}, "needs a statistic; one of mean, sd"),
        ({**SHARE, "statistic": "p59"}, "did you mean 'p95'?"),
        ({**SHARE, "statistic": "tail95_hi"}, "does not exist for collision_share, which is of kind share"),
        ({**SHARE, "metric": "min_ttc_s", "statistic": "mean"}, 'kind = "mean" or kind = "encounter"'),
        ({**SHARE, "kind": "mean"}, "kind 'mean': collision_share is of kind share"),
        ({**SHARE, "where": {"seed": 1}}, "where chooses encounters or runs"),
        ({**SHARE, "metric": "colision_share"}, "did you mean 'collision_share'?"),
    ],
)
def test_a_mistake_is_one_line_that_says_what_exists(changes: dict[str, Any], part: str) -> None:
    said = refused(**changes)
    assert said.startswith("criteria: number 1")
    assert part in said


def test_the_kind_tells_a_measure_of_runs_from_one_of_encounters() -> None:
    table = {**SHARE, "metric": "min_ttc_s", "statistic": "p05", "operator": ">"}
    kinds = [read_criteria([{**table, "kind": kind}])[0].kind for kind in ("mean", "encounter")]
    assert kinds == ["mean", "encounter"]


def test_two_criteria_of_one_name_are_refused_and_two_for_different_scenarios_are_not() -> None:
    with pytest.raises(CriterionError, match="another one called 'n_collisions == 0'"):
        read_criteria([RUN, dict(RUN)])
    assert len(read_criteria([{**RUN, "scenarios": ["a"]}, {**RUN, "scenarios": ["b"]}])) == 2


def test_every_number_in_the_table_of_criteria_says_its_unit() -> None:
    for column in CRITERIA.columns:
        assert column.description
        if column.kind in ("number", "integer"):
            assert column.unit
