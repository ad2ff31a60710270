"""Run the experiments of several papers in parallel and write the claims with their results."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import Future, as_completed
from multiprocessing import get_context
from pathlib import Path
from time import monotonic

from pebble import ProcessPool

from cosim.errors import SimulationError
from studies.papers.catalog import Experiment
from studies.papers.claim import Claim
from studies.papers.table import write_claims

FIGURES = "figures"
CLAIMS = "claims.csv"
MOST_PROCESSES = 2

Finished = Callable[[Experiment, float], None]
"""Called with each finished experiment and the time that it took [s]."""
Timed = tuple[list[Claim], float]


def execute(experiments: Sequence[Experiment], folder: Path, finished: Finished) -> list[Claim]:
    """Run experiments, and write ``claims.csv`` and ``figures/*.png`` into an existing folder.

    Parameters
    ----------
    experiments : experiments to run; two at a time if there are two processors
    folder : folder for the files; ``claims.csv`` appears last, complete or not at all
    finished : called after each experiment, to show progress

    Raises
    ------
    SimulationError
        If a file cannot be written.
    """
    figures = folder / FIGURES
    try:
        figures.mkdir(exist_ok=True)
        claims = _run_all(experiments, figures, finished)
        write_claims(folder / CLAIMS, claims)
    except OSError as error:
        raise SimulationError(f"{error.filename or folder}: {error.strerror}") from error
    return claims


def _run_all(experiments: Sequence[Experiment], figures: Path, finished: Finished) -> list[Claim]:
    """Return the claims in the order of the experiments, regardless of which finishes first."""
    jobs = min(len(experiments), MOST_PROCESSES, os.cpu_count() or 1)
    if jobs < 2:
        results = []
        for one in experiments:
            results.append(_timed(one, figures))
            finished(one, results[-1][1])
        return [claim for claims, _ in results for claim in claims]
    # Spawned, not forked, so that a process starts in the same state everywhere.
    pool = ProcessPool(jobs, max_tasks=1, context=get_context("spawn"))
    try:
        futures = [pool.schedule(_timed, args=(one, figures)) for one in experiments]
        names: dict[Future[Timed], Experiment] = dict(zip(futures, experiments, strict=True))
        for future in as_completed(names):
            finished(names[future], future.result()[1])
    finally:
        pool.stop()  # type: ignore[no-untyped-call]  # done already, or somebody wants to end now
        pool.join()
    return [claim for future in futures for claim in future.result()[0]]


def _timed(experiment: Experiment, figures: Path) -> Timed:
    begun = monotonic()
    return experiment.run(figures), monotonic() - begun
