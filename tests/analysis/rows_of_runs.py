"""Rows of encounters.csv and runs.csv with a few cells filled."""

from __future__ import annotations

from typing import Any

from analysis.results.run_tables import ENCOUNTERS, RUNS


def encounter(**cells: Any) -> dict[str, str]:
    """Return a row of encounters.csv; what is not given is empty, and there was no contact."""
    return {**dict.fromkeys(ENCOUNTERS.names(), ""), "collision": "0", **_texts(cells)}


def run(**cells: Any) -> dict[str, str]:
    """Return a row of runs.csv."""
    return {**dict.fromkeys(RUNS.names(), ""), **_texts(cells)}


def _texts(cells: dict[str, Any]) -> dict[str, str]:
    return {name: str(value) for name, value in cells.items()}
