"""Finds the metrics: every file of ``analysis.metrics`` is one complete metric."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from analysis import metrics
from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import WholeRun
from analysis.errors import MetricError
from analysis.tables.column import Column

_NEEDED = ("UNIT", "WORSE", "SOURCE")


@dataclass(frozen=True, slots=True)
class Metric:
    """One metric, as its file describes it.

    A metric with columns in encounters.csv is a metric of encounters: its ``compute`` returns column -> one
    value per encounter. ``summarise``, of this or of a metric of runs, takes these columns of the whole run
    and returns run column -> value. A long run is judged in parts. If ``summarise`` needs more, two other
    functions return it as name -> list, and their lists are joined: ``collect_encounters``, called with each
    case for its encounters, and ``collect_rides``, called once for each ego.
    """

    name: str
    unit: str
    worse: str
    """``higher``, ``lower`` or ``neither``."""
    source: str
    text: str
    curve: str
    """Formula that config.json repeats; empty for most."""
    columns: tuple[Column, ...]
    """Its columns in encounters.csv."""
    run_columns: tuple[Column, ...]
    """Its columns in runs.csv."""
    compute: Callable[[Case], Values] | None
    collect_encounters: Callable[[Case], Values] | None
    collect_rides: Callable[[Case], Values] | None
    summarise: Callable[[WholeRun, Values], Values] | None
    of_controller: bool = False
    """Whether it is about the controller's plans, so that vehicles without recorded plans have no value."""

    @property
    def scope(self) -> str:
        """``encounter`` or ``run``."""
        return "encounter" if self.columns else "run"


@cache
def find_metrics() -> tuple[Metric, ...]:
    """Return all metrics in alphabetical order.

    Raises
    ------
    MetricError
        If a file lacks something, or two files declare the same column.
    """
    names = sorted(found.name for found in pkgutil.iter_modules(metrics.__path__))
    listed = tuple(read_metric(name, importlib.import_module(f"{metrics.__name__}.{name}")) for name in names)
    for kind in ("columns", "run_columns"):
        declared: dict[str, str] = {}
        for metric in listed:
            for column in getattr(metric, kind):
                if (other := declared.setdefault(column.name, metric.name)) != metric.name:
                    raise MetricError(f"metrics {other} and {metric.name} both declare {column.name}")
    return listed


def read_metric(name: str, file: Any) -> Metric:
    """Return the metric that a module describes.

    Raises
    ------
    MetricError
        If the module lacks something.
    """
    missing = [one for one in _NEEDED if not hasattr(file, one)]
    columns, run_columns = getattr(file, "COLUMNS", ()), getattr(file, "RUN_COLUMNS", ())
    if not columns and not run_columns:
        missing.append("COLUMNS or RUN_COLUMNS")
    if columns and not hasattr(file, "compute"):
        missing.append("compute, from a case to COLUMNS")
    if run_columns and not hasattr(file, "summarise"):
        missing.append("summarise, from the values of encounters to RUN_COLUMNS")
    if missing:
        raise MetricError(f"metric {name}: its file has no {', no '.join(missing)}")
    return Metric(
        name=name,
        unit=file.UNIT,
        worse=file.WORSE,
        source=file.SOURCE,
        text=(file.__doc__ or "").strip(),
        curve=getattr(file, "CURVE", ""),
        columns=columns,
        run_columns=run_columns,
        compute=getattr(file, "compute", None),
        collect_encounters=getattr(file, "collect_encounters", None),
        collect_rides=getattr(file, "collect_rides", None),
        summarise=getattr(file, "summarise", None),
        of_controller=getattr(file, "OF_CONTROLLER", False),
    )
