"""Estimate of the duration of a batch, and its basis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean

from cosim.batches.job import Configuration, Job
from cosim.batches.ledger import Ledger
from cosim.batches.preflight import Checked

ROUGH_SPEED = 15.0
"""Simulated time over wall-clock time of one process, if no run is finished yet."""
ROUGH_START_S = 1.0
"""Wall-clock time to start SUMO and to analyse a run [s]."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """Wall-clock time of the runs that are missing."""

    wall_s: float
    basis: str


def estimate(
    jobs: Sequence[Job], missing: Sequence[Job], ledger: Ledger, checked: Checked, processes: int
) -> Estimate:
    """Return the time that the missing runs take, estimated from finished runs of the study if there are any.

    Parameters
    ----------
    jobs, missing : Sequence
        All runs of the study, and those that are not finished.
    ledger : Ledger
    checked : Checked
    processes : int
        Number of runs made at the same time.
    """
    waiting = set(missing)
    known: dict[tuple[str, str], list[float]] = {}
    for job in jobs:
        if job in waiting or job.name in ledger.damaged:
            continue
        wall_s, simulated_s = ledger.description(job.name)["wall_total_s"], _simulated(job, checked)
        known.setdefault(_kind(job.configuration), []).append(wall_s / simulated_s)
    rates = {kind: fmean(values) for kind, values in known.items()}
    total_s = 0.0
    for job in missing:
        if rates:
            rate = rates.get(_kind(job.configuration), fmean(rates.values()))
            total_s += rate * _simulated(job, checked)
        else:
            total_s += ROUGH_START_S + _simulated(job, checked) / ROUGH_SPEED
    finished = len(jobs) - len(missing)
    basis = (
        f"from the {finished} finished runs of this study"
        if rates
        else f"a rough figure: {ROUGH_SPEED:g} simulated seconds a second in each process"
    )
    return Estimate(total_s / max(1, min(processes, len(missing))), basis)


def _kind(one: Configuration) -> tuple[str, str]:
    return one.scenario_name, one.controller


def _simulated(job: Job, checked: Checked) -> float:
    return max(checked.simulated_s(job.configuration), 1e-3)


def in_words(seconds: float) -> str:
    """Return a time in the units that people would use.

    Examples
    --------
    >>> in_words(5000)
    '1 h 23 min'
    """
    minutes = round(seconds / 60.0)
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    if minutes < 60:
        return f"{minutes} min"
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours < 48 else f"{hours / 24.0:.1f} days"
