"""Results of each driver with each sensing, for each kind of obstacle that hides pedestrians."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.arrays import FloatArray
from analysis.results.run_tables import ENCOUNTERS
from analysis.statistics.paired import compare_values
from analysis.study.runs import StudyRun

ORDER = ("perfect", "onboard", "roadside", "fused")
"""Order of the sensing models on the page and in the figure."""

Seeing = tuple[str, float | None]
"""Sensing model, and the latency of its messages if it has any [ms]."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """The measures of one run."""

    seed: int
    encounters: int
    """Number of encounters with people who were in the ego's path or were touched."""
    contacts: int
    preventable: int
    """Number of contacts that the reference driver would have prevented, regardless of the ego's sensing."""
    told: FloatArray
    """For each encounter, how long the ego had known of the pedestrian when the conflict came [s]."""
    delay: float


@dataclass(frozen=True, slots=True)
class Cell:
    """Results of one driver with one sensing and one kind of obstacle."""

    hidden_by: str
    driver: str
    seeing: Seeing
    runs: int
    outcomes: tuple[Outcome, ...]
    """Outcomes of the valid runs, sorted by seed."""

    @property
    def encounters(self) -> int:
        """Return their number in all runs."""
        return sum(one.encounters for one in self.outcomes)

    @property
    def contacts(self) -> int:
        """Return their number in all runs."""
        return sum(one.contacts for one in self.outcomes)

    @property
    def delay(self) -> float | None:
        """Return the mean delay over the runs [s]."""
        return float(np.mean([one.delay for one in self.outcomes])) if self.outcomes else None


def cells(runs: Iterable[StudyRun]) -> list[Cell]:
    """Return the cells of a study, in a fixed order."""
    runs = list(runs)
    several = {run.parameters.get("hidden_speed_mps") for run in runs} - {None}
    groups: dict[tuple[str, str, Seeing], list[StudyRun]] = {}
    for run in runs:
        driver = run.controller
        pace = run.parameters.get("hidden_speed_mps")
        if pace is not None and len(several) > 1:
            driver += f", hidden_speed_mps = {float(pace):g}"
        groups.setdefault((run.setting["hidden_by"], driver, seeing_of(run)), []).append(run)
    found = []
    for key, mine in groups.items():
        valid = sorted((run for run in mine if run.valid), key=lambda run: run.seed)
        found.append(Cell(*key, len(mine), tuple(outcome_of(run) for run in valid)))
    return sorted(
        found,
        key=lambda cell: (
            cell.hidden_by,
            cell.driver,
            ORDER.index(cell.seeing[0]),
            cell.seeing[1] if cell.seeing[1] is not None else -1.0,
        ),
    )


def seeing_of(run: StudyRun) -> Seeing:
    """Return how the ego of a run perceives people."""
    latency = run.setting.get("sensing.latency_ms")
    return run.setting["sensing"], None if latency is None else float(latency)


def outcome_of(run: StudyRun) -> Outcome:
    """Return the measures of a valid run."""
    table = pd.read_csv(run.folder / ENCOUNTERS.file)
    met = table[(table["entered"] == 1) | (table["collision"] == 1)]
    touched = met[met["collision"] == 1]
    return Outcome(
        run.seed,
        len(met),
        len(touched),
        int((touched["preventable_r157"] == 1).sum()),
        met["visible_before_conflict_s"].dropna().to_numpy(dtype=np.float64),
        run.numbers["ego_delay_mean_s"],
    )


def against(cell: Cell, base: Cell | None, what: str) -> str:
    """Return the mean difference between two cells over their common seeds, with its 95 % interval.

    Parameters
    ----------
    cell, base : two sensings of one driver
    what : ``contacts`` per encounter, or ``delay`` [s]
    """
    if base is None or base is cell:
        return ""
    values = [{one.seed: _value(one, what) for one in side.outcomes} for side in (base, cell)]
    seeds = sorted(values[0].keys() & values[1].keys())
    found = compare_values(*(np.array([side[seed] for seed in seeds]) for side in values))
    if found.difference is None:
        return ""
    text = f"{found.difference:+.2f}"
    if found.interval is not None:
        text += f" ({found.interval.low:+.2f} … {found.interval.high:+.2f})"
    return text


def _value(outcome: Outcome, what: str) -> float:
    return outcome.delay if what == "delay" else outcome.contacts / max(outcome.encounters, 1)
