"""Interface of the test protocols to the rest of the tool: suites, cases, and verdicts on recorded runs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from analysis.protocols.impact import measure
from analysis.protocols.verdict import Demand, Verdict, compared, decide
from cosim.errors import InputError
from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.suites import case as references
from sumo_scenarios.suites import tables
from sumo_scenarios.suites.case import Case

__all__ = ["Case", "Verdict", "cases", "judge", "label", "names", "settled"]


def names() -> tuple[str, ...]:
    """Return the names of the suites."""
    return tables.names()


def label(name: str) -> str:
    """Return the label of a suite's results."""
    return tables.read_suite(name).label


def cases(name: str) -> Sequence[Case]:
    """Return the cases of a suite; each has a ``reference`` that every command takes as a scenario.

    Parameters
    ----------
    name : name of the suite, with or without ``suite:``; ``NAME/CASE`` selects one case

    Raises
    ------
    InputError
        If there is no such suite or case.
    """
    suite, _, case = name.removeprefix(references.PREFIX).partition("/")
    try:
        every = references.cases(suite)
        if case:
            every = (references.find(f"{references.PREFIX}{suite}/{case}"),)
    except ScenarioError as error:
        raise InputError(str(error)) from error
    return every


def judge(folder: Path, case: Case) -> Verdict:
    """Return the verdict on a recorded run of a case.

    Raises
    ------
    RecordingError
        If the run cannot be read.
    """
    demand = Demand(
        case.group.rule,
        case.ego_speed_kmh,
        case.highest_impact_kmh,
        case.avoidance_only,
        case.group.motion in ("along", "standing"),
    )
    return decide(measure(folder), demand)


def settled(judged: Iterable[tuple[Case, Verdict]]) -> list[tuple[Case, Verdict]]:
    """Return the verdicts; cases that must not be worse than their standard case are compared with it."""
    pairs = list(judged)
    by_name = {(one.suite, one.group.name, one.ego_speed_kmh): verdict for one, verdict in pairs}
    found = []
    for one, verdict in pairs:
        standard = by_name.get((one.suite, one.group.standard, one.ego_speed_kmh))
        found.append((one, verdict if standard is None else compared(verdict, standard)))
    return found
