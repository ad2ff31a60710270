"""Finds the metrics: every file of ``analysis.metrics`` is one, none is listed anywhere."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from analysis import metrics
from analysis.case import Case, Values


@dataclass(frozen=True, slots=True)
class Metric:
    """One metric, as its file describes it.

    An encounter metric's ``compute`` returns column -> one value per encounter; its ``summarise``, where
    there is one, takes these columns and returns run column -> value. A run metric's ``compute`` returns
    run column -> value.
    """

    name: str
    scope: str
    """``encounter`` or ``run``."""
    unit: str
    worse: str
    """``higher``, ``lower`` or ``neither``."""
    source: str
    text: str
    columns: tuple[str, ...]
    """In encounters.csv."""
    run_columns: tuple[str, ...]
    """In runs.csv."""
    compute: Callable[[Case], Values]
    summarise: Callable[[Case, Values], Values] | None


@cache
def find_metrics() -> tuple[Metric, ...]:
    """Return all metrics in alphabetical order."""
    found = []
    for module_info in pkgutil.iter_modules(metrics.__path__):
        module = importlib.import_module(f"{metrics.__name__}.{module_info.name}")
        found.append(
            Metric(
                name=module_info.name,
                scope=module.SCOPE,
                unit=module.UNIT,
                worse=module.WORSE,
                source=module.SOURCE,
                text=(module.__doc__ or "").strip(),
                columns=module.COLUMNS,
                run_columns=module.RUN_COLUMNS,
                compute=module.compute,
                summarise=getattr(module, "summarise", None),
            )
        )
    return tuple(sorted(found, key=lambda metric: metric.name))
