"""One case of a test protocol, and references to it: ``suite:NAME/CASE``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sumo_scenarios.errors import ScenarioError, did_you_mean
from sumo_scenarios.suites.tables import GroupTable, read_suite
from sumo_scenarios.suites.tables import names as suite_names

PREFIX = "suite:"
"""Prefix of a reference."""


@dataclass(frozen=True, slots=True)
class Case:
    """An ego at a test speed, a pedestrian, and what the protocol requires of the ego."""

    suite: str
    group: GroupTable
    ego_speed_kmh: float
    highest_impact_kmh: float | None = None
    """Highest impact speed that rule ``impact_speed`` allows [km/h]."""

    @property
    def name(self) -> str:
        """Name of the case within its suite."""
        return f"{self.group.name}_{self.ego_speed_kmh:g}kmh"

    @property
    def avoidance_only(self) -> bool:
        """Whether every contact is red, as for turning egos, which are slow."""
        return self.group.motion == "turning"

    @property
    def reference(self) -> str:
        """Reference to the case, accepted in place of a scenario's name."""
        return f"{PREFIX}{self.suite}/{self.name}"

    @property
    def scenario_name(self) -> str:
        """Name of the case's scenario in files and folders."""
        return f"{self.suite}.{self.name}"

    @property
    def description(self) -> str:
        """One-line description for a list."""
        return f"{self.group.description}; ego {self.ego_speed_kmh:g} km/h"


def is_reference(text: str) -> bool:
    """Return whether a text refers to a suite or one of its cases."""
    return text.startswith(PREFIX)


def reference_of(scenario_name: str) -> str:
    """Return the reference to the case with this name in files and folders; return other names unchanged."""
    suite, _, name = scenario_name.partition(".")
    return f"{PREFIX}{suite}/{name}" if name and suite in suite_names() else scenario_name


def cases(suite: str) -> tuple[Case, ...]:
    """Return all cases of a suite, in the order of its table.

    Raises
    ------
    ScenarioError
        If there is no such suite.
    """
    found: list[Case] = []
    for group in read_suite(suite).groups:
        limits: Sequence[float | None] = group.highest_impact_kmh or [None] * len(group.speeds_kmh)
        found += [
            Case(suite, group, speed, limit) for speed, limit in zip(group.speeds_kmh, limits, strict=True)
        ]
    return tuple(found)


def find(reference: str) -> Case:
    """Return the case that ``suite:NAME/CASE`` refers to.

    Raises
    ------
    ScenarioError
        If there is no such suite or case, or the reference names no case.
    """
    suite, _, name = reference.removeprefix(PREFIX).partition("/")
    every = cases(suite)
    for case in every:
        if case.name == name:
            return case
    if not name:
        raise ScenarioError(
            f"{reference}: expected one case of the suite, for instance {every[0].reference}; "
            f"cosim list {PREFIX}{suite} shows all {len(every)}"
        )
    hint = did_you_mean(name, [case.name for case in every])
    raise ScenarioError(f"{reference}: no such case; {hint}cosim list {PREFIX}{suite} shows all {len(every)}")
