"""From a case to the rows of a run's CSV files."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from analysis.encounters.case import Case, Values
from analysis.errors import MetricError
from analysis.results import encounter_description, run_description
from analysis.results.encounter_description import ListedEncounter
from analysis.results.metric_catalog import Metric, find_metrics
from analysis.results.numbered_rows import numbered_rows
from analysis.results.origin import Origin
from analysis.results.overlap_rows import VEHICLE_OVERLAPS
from analysis.results.run_description import ListedRun
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.results.vehicle_conflict_rows import VEHICLE_CONFLICTS
from analysis.tables.cells import Row, plain
from analysis.tables.column import Column, row_of


def encounter_and_run_rows(case: Case) -> tuple[Sequence[Row], Row]:
    """Return the rows of encounters.csv and the row of runs.csv."""
    columns: dict[str, Any] = {}
    summary: dict[str, Any] = {}
    for metric in find_metrics():
        values, of_run = measure(metric, case)
        columns.update(values)
        summary.update(of_run)
    origin = Origin(case.run.meta)
    rows = [
        plain(
            ENCOUNTERS,
            {
                **row_of(encounter_description.COLUMNS, ListedEncounter(origin, case, index)),
                **{name: values[index] for name, values in columns.items()},
            },
        )
        for index in range(len(case))
    ]
    return rows, plain(RUNS, {**row_of(run_description.COLUMNS, ListedRun(origin, case)), **summary})


def measure(metric: Metric, case: Case) -> tuple[Values, Values]:
    """Return a metric's columns of all encounters, and its values for the run.

    Raises
    ------
    MetricError
        When it returns what it does not declare, or another number of values than there are encounters.
    """
    if not metric.columns:
        return {}, _declared(metric, "RUN_COLUMNS", metric.run_columns, metric.compute(case))
    values = of_encounters(metric, case)
    if metric.summarise is None:
        return values, {}
    return values, _declared(metric, "RUN_COLUMNS", metric.run_columns, metric.summarise(case, values))


def of_encounters(metric: Metric, case: Case) -> Values:
    """Return a metric's columns of all encounters; it has such columns.

    Raises
    ------
    MetricError
        As `measure`.
    """
    values = metric.compute(case)
    for name, column in _declared(metric, "COLUMNS", metric.columns, values).items():
        if len(column) != len(case):
            raise MetricError(
                f"metric {metric.name}: {len(column)} values of {name} for {len(case)} encounters"
            )
    return values


def _declared(metric: Metric, where: str, columns: Sequence[Column], values: Values) -> Values:
    if foreign := sorted(set(values) - {column.name for column in columns}):
        raise MetricError(f"metric {metric.name}: its {where} do not declare {', '.join(foreign)}")
    return values


def overlap_rows(case: Case) -> Sequence[Row]:
    """Return the rows of vehicle_overlaps.csv."""
    return numbered_rows(VEHICLE_OVERLAPS, case, case.overlaps)


def conflict_rows(case: Case) -> Sequence[Row]:
    """Return the rows of vehicle_conflicts.csv."""
    return numbered_rows(VEHICLE_CONFLICTS, case, case.vehicle_conflicts)
