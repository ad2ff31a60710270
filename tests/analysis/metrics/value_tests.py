"""Finds the columns whose values tests compare with values worked out by hand."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from pathlib import Path

from analysis.results.metric_catalog import Metric

ROOMS = ("tests/analysis/metrics", "tests/analysis/encounters", "tests/analysis/recording")
"""Where recordings are made by hand; tests of studies write the columns themselves."""


def compared(source: str) -> set[str]:
    """Return the texts, column names among them, that the assertions of a module find equal to something.

    >>> sorted(compared("assert row['gap_m'] == approx(2.0)"))
    ['gap_m']
    >>> compared("assert row['gap_m'] > 0") | compared("gap = row['gap_m']")
    set()
    """
    equalities = [
        one
        for asserted in ast.walk(ast.parse(source))
        if isinstance(asserted, ast.Assert)
        for one in ast.walk(asserted.test)
        if isinstance(one, ast.Compare) and all(isinstance(op, ast.Eq | ast.Is) for op in one.ops)
    ]
    return set(_texts(equalities))


def _texts(nodes: Iterable[ast.AST]) -> Iterator[str]:
    for node in nodes:
        for one in ast.walk(node):
            if isinstance(one, ast.Constant) and isinstance(one.value, str):
                yield one.value


def complaint(metric: Metric, known: set[str]) -> str:
    """Return what is missing of a metric's tests; empty where a value is compared."""
    names = [column.name for column in (*metric.columns, *metric.run_columns)]
    if known & set(names):
        return ""
    return (
        f"no test compares a value of the metric {metric.name}: in {ROOMS[0]}, record a ride whose value can "
        f'be worked out by hand and assert row["{names[0]}"] == that value'
    )


def compared_in_rooms(root: Path) -> set[str]:
    """Return what the tests of all rooms compare."""
    files = [path for room in ROOMS for path in sorted((root / room).glob("test_*.py"))]
    return set().union(*(compared(path.read_text("utf-8")) for path in files))
