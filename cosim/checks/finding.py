"""Findings of a check, each on one criterion and its subject."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

VALID = "valid"
"""Name of the criterion that every run has to meet."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A row of ``criteria.csv``; the columns are described in ``analysis.criteria.table``."""

    target: str
    scenario_id: str
    controller: str
    configuration: str
    scope: str
    criterion_id: str
    metric: str
    status: str
    """``pass``, ``fail``, ``undefined`` or ``invalid``."""
    statistic: str | None = None
    unit: str | None = None
    operator: str | None = None
    threshold: float | None = None
    value: float | None = None
    margin: float | None = None
    counts: bool = True
    """Whether the finding affects the exit code; true for all that passed."""
    seed: int | None = None
    run: str | None = None
    encounter_id: int | None = None
    ego_id: str | None = None
    ped_id: str | None = None
    t_start_s: float | None = None
    moment_s: float | None = None
    place: str | None = None
    n_runs: int | None = None
    p_holm: float | None = None
    colour: str | None = None
    points: float | None = None
    note: str | None = None
    command: str | None = None

    @property
    def failed(self) -> bool:
        """Whether the finding leads to exit code 1."""
        return self.counts and self.status in ("fail", "undefined")

    @property
    def invalid(self) -> bool:
        """Whether the finding leads to exit code 3."""
        return self.status == "invalid"

    @property
    def subject(self) -> str:
        """Subject of the criterion, in words."""
        words = [f"{self.scenario_id} with {self.configuration}"]
        if self.seed is not None:
            words.append(f"seed {self.seed}")
        if self.encounter_id is not None and self.scope == "encounter":
            words.append(f"encounter {self.encounter_id}")
        return ", ".join(words)

    @property
    def sentence(self) -> str:
        """Value and threshold in one line."""
        if self.status == "invalid":
            return f"invalid: {self.note}"
        unit = f" {self.unit}" if self.unit not in (None, "", "1") else ""
        name = f"{self.statistic} of {self.metric}" if self.statistic else self.metric
        if self.scope == "baseline":
            return str(self.note)
        said = f"{name} is undefined" if self.value is None else f"{name} = {self.value:.6g}{unit}"
        if self.threshold is not None:
            said += f", expected {self.operator} {self.threshold:.6g}{unit}"
        said += f" ({self.where})" if self.where else ""
        return f"{said}: {self.note}" if self.note else said

    @property
    def where(self) -> str:
        """Road users, time and place of a failure; empty if they are not known."""
        if self.ego_id is None or self.moment_s is None:
            return self.place or ""
        person = "" if self.ped_id is None else f" and pedestrian {self.ped_id}"
        return f"ego {self.ego_id}{person}, {self.moment_s:.1f} s, {self.place}"

    def row(self) -> dict[str, Any]:
        """Return the row of ``criteria.csv``."""
        return asdict(self)


def exit_code(findings: Sequence[Finding]) -> int:
    """Return 3 if a run is invalid, else 1 if a criterion failed, else 0."""
    if any(one.invalid for one in findings):
        return 3
    return 1 if any(one.failed for one in findings) else 0
