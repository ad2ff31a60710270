"""Entries of the suites and their cases for ``cosim list``."""

from __future__ import annotations

from cosim.running.inventory import Entry
from cosim.suites import judging
from sumo_scenarios.suites.tables import read_suite


def suites() -> list[Entry]:
    """Return an entry for each suite."""
    return [_suite(name) for name in judging.names()]


def cases(reference: str) -> list[Entry]:
    """Return an entry for each case of ``suite:NAME``, by the reference that other commands take.

    Raises
    ------
    InputError
        If there is no such suite.
    """
    return [Entry(case.reference, case.description) for case in judging.cases(reference)]


def _suite(name: str) -> Entry:
    count = len(judging.cases(name))
    return Entry(f"suite:{name}", f"{read_suite(name).title}: {count} cases, {read_suite(name).label}")
