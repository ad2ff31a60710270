"""The CSV files of a run: columns that describe the encounter or the run, and the columns of all metrics."""

from __future__ import annotations

from analysis.results import column_order, encounter_description, run_description
from analysis.results.column_order import in_order
from analysis.results.metric_catalog import find_metrics
from analysis.results.overlap_rows import VEHICLE_OVERLAPS
from analysis.results.vehicle_conflict_rows import VEHICLE_CONFLICTS
from analysis.tables.column import Table

ENCOUNTERS = Table(
    "encounters",
    "One row for each encounter of an ego and a pedestrian",
    in_order(
        (*encounter_description.COLUMNS, *(one for metric in find_metrics() for one in metric.columns)),
        column_order.ENCOUNTERS,
    ),
    ("run_id", "encounter_id"),
)

RUNS = Table(
    "runs",
    "One row for each run",
    in_order(
        (*run_description.COLUMNS, *(one for metric in find_metrics() for one in metric.run_columns)),
        column_order.RUNS,
    ),
    ("run_id",),
)

RUN_TABLES = (ENCOUNTERS, RUNS, VEHICLE_OVERLAPS, VEHICLE_CONFLICTS)
