"""Reads criteria from the ``[[criteria]]`` tables of a TOML file; every mistake is reported in one line."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from analysis.criteria.criterion import OPERATORS, SCOPES, STATISTICS, Criterion
from analysis.errors import AnalysisError, did_you_mean
from analysis.results.measures import Measure, encounter_measures, run_measures
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.tables.column import Column, Table

EXAMPLE = (
    '[[criteria]] scope = "run", metric = "n_collisions", operator = "==", threshold = 0 '
    "(each key on a line of its own)"
)
"""An example of a criterion, for messages."""

KEYS = (
    *("id", "scope", "metric", "statistic", "kind", "operator", "threshold"),
    *("where", "controllers", "scenarios", "allow_undefined"),
)
_TABLES = {"encounter": ENCOUNTERS, "run": RUNS}
_JUDGED = ("integer", "number", "boolean")


class CriterionError(AnalysisError):
    """A criterion that cannot be judged."""


def read_criteria(tables: Sequence[Mapping[str, Any]]) -> tuple[Criterion, ...]:
    """Return the checked criteria.

    Parameters
    ----------
    tables
        Content of ``[[criteria]]``.

    Raises
    ------
    CriterionError
        For the first mistake; the message names what exists.
    """
    found: list[Criterion] = []
    for number, table in enumerate(tables, 1):
        try:
            found.append(_criterion(table))
        except CriterionError as error:
            name = table.get("id") or table.get("metric") or ""
            raise CriterionError(
                f"criteria: number {number}{f' ({name})' if name else ''}: {error}"
            ) from None
    seen: set[tuple[str, tuple[str, ...], tuple[str, ...]]] = set()
    for number, one in enumerate(found, 1):
        mark = (one.id, one.scenarios, one.controllers)
        if mark in seen:
            raise CriterionError(
                f"criteria: number {number}: there is another one called {one.id!r}; give it an id of its own"
            )
        seen.add(mark)
    return tuple(found)


def _criterion(table: Mapping[str, Any]) -> Criterion:
    for key in table:
        if key not in KEYS:
            raise CriterionError(
                f"unknown key {key!r}; {did_you_mean(key, KEYS)}keys that exist: {', '.join(KEYS)}"
            )
    for key in ("scope", "metric", "operator"):
        _one_text(table, key)
    scope = _chosen("scope", table["scope"], SCOPES)
    sign = _chosen("operator", table["operator"], tuple(OPERATORS))
    metric, statistic = table["metric"], table.get("statistic", "")
    where = _where(scope, table.get("where", {}))
    kind = ""
    boolean = False
    if scope == "configuration":
        measure = _measure(metric, table.get("kind"))
        kind, unit = measure.kind, measure.unit
        statistic = _statistic(table, measure)
    else:
        for key in ("statistic", "kind"):
            if key in table:
                raise CriterionError(f'{key} belongs to scope = "configuration", this is {scope!r}')
        column = _column(scope, metric)
        unit, boolean = column.unit, column.kind == "boolean"
    threshold = _threshold(table, boolean)
    allow = table.get("allow_undefined", False)
    if not isinstance(allow, bool):
        raise CriterionError(f"allow_undefined: expected true or false, got {allow!r}")
    said = f"{statistic} of {metric}" if statistic else metric
    return Criterion(
        id=_one_text(table, "id") if "id" in table else f"{said} {sign} {threshold:g}",
        scope=scope,
        metric=metric,
        operator=sign,
        threshold=threshold,
        unit=unit,
        statistic=statistic,
        kind=kind,
        where=where,
        controllers=_names(table, "controllers"),
        scenarios=_names(table, "scenarios"),
        allow_undefined=allow,
    )


def _one_text(table: Mapping[str, Any], key: str) -> str:
    value = table.get(key)
    if value is None:
        raise CriterionError(f"{key!r} is missing; expected for instance {EXAMPLE}")
    if not isinstance(value, str) or not value.strip():
        raise CriterionError(f"{key}: expected a text, got {value!r}")
    return value


def _chosen(key: str, value: str, choices: Sequence[str]) -> str:
    if value not in choices:
        raise CriterionError(
            f"{key} {value!r}: {did_you_mean(value, choices)}expected one of {' '.join(choices)}"
        )
    return value


def _threshold(table: Mapping[str, Any], boolean: bool) -> float:
    if "threshold" not in table:
        raise CriterionError("threshold is missing; expected a number")
    value = table["threshold"]
    if isinstance(value, bool):
        if boolean:
            return float(value)
        raise CriterionError(f"threshold: expected a number, got {str(value).lower()}")
    if not isinstance(value, int | float) or not math.isfinite(value):
        raise CriterionError(f"threshold: expected a number, got {value!r}; its unit is that of the metric")
    return float(value)


def _names(table: Mapping[str, Any], key: str) -> tuple[str, ...]:
    value = table.get(key, [])
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
        raise CriterionError(f"{key}: expected a list of names, got {value!r}")
    if key in table and not value:
        raise CriterionError(f"{key}: expected at least one name; without the key all are judged")
    return tuple(value)


def _column(scope: str, metric: str) -> Column:
    table = _TABLES[scope]
    columns = {one.name: one for one in table.columns if one.kind in _JUDGED}
    if metric in columns:
        return columns[metric]
    raise CriterionError(_no_metric(metric, scope, columns))


def _measure(metric: str, kind: Any) -> Measure:
    measures = (*run_measures(), *encounter_measures())
    found = [one for one in measures if one.name == metric]
    if not found:
        raise CriterionError(_no_metric(metric, "configuration", [one.name for one in measures]))
    if kind is not None:
        fitting = [one for one in found if one.kind == kind]
        if not fitting:
            kinds = " or ".join(one.kind for one in found)
            raise CriterionError(f"kind {kind!r}: {metric} is of kind {kinds}")
        return fitting[0]
    if len(found) > 1:
        kinds = " or ".join(f'kind = "{one.kind}"' for one in found)
        raise CriterionError(f"{metric} is a number of each run and of each encounter; add {kinds}")
    return found[0]


def _statistic(table: Mapping[str, Any], measure: Measure) -> str:
    fitting = [name for name, (_, kinds) in STATISTICS.items() if measure.kind in kinds]
    value = table.get("statistic")
    if value is None:
        raise CriterionError(f'scope "configuration" needs a statistic; one of {", ".join(fitting)}')
    if value in fitting:
        return str(value)
    if value in STATISTICS:
        raise CriterionError(
            f"statistic {value!r} does not exist for {measure.name}, which is of kind {measure.kind}; "
            f"there are {', '.join(fitting)}"
        )
    raise CriterionError(
        f"statistic {value!r}: {did_you_mean(str(value), fitting)}expected one of {', '.join(fitting)}"
    )


def _where(scope: str, value: Any) -> Mapping[str, bool | float | str]:
    if not isinstance(value, Mapping):
        raise CriterionError(f"where: expected a table of columns and values, got {value!r}")
    if value and scope == "configuration":
        raise CriterionError('where chooses encounters or runs; scope = "configuration" takes all of them')
    if not value:
        return {}
    table: Table = _TABLES[scope]
    columns = {one.name: one for one in table.columns}
    for name, wanted in value.items():
        if name not in columns:
            raise CriterionError(f"where: {_no_metric(name, scope, columns)}")
        column = columns[name]
        if column.kind == "string":
            if not isinstance(wanted, str) or (column.choices and wanted not in column.choices):
                expected = ", ".join(column.choices) or "a text"
                raise CriterionError(f"where: {name}: expected {expected}, got {wanted!r}")
        elif not isinstance(wanted, bool | int | float):
            raise CriterionError(f"where: {name}: expected a number, got {wanted!r}")
    return dict(value)


def _no_metric(name: str, scope: str, known: Iterable[str]) -> str:
    names = list(known)
    near = did_you_mean(name, names)
    elsewhere = [other for other, table in _TABLES.items() if other != scope and name in table.names()]
    if scope != "configuration" and any(one.name == name for one in (*run_measures(), *encounter_measures())):
        elsewhere.append("configuration")
    if elsewhere:
        near = f"it exists with scope = {' or '.join(repr(one) for one in elsewhere)}; {near}"
    where = {"encounter": ENCOUNTERS.file, "run": RUNS.file, "configuration": "configs.csv"}[scope]
    return f"{name!r} is no metric of {where}; {near}docs/metrics.md lists them"
