"""Checks of a study before its first run, so that errors are found early."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, replace
from pathlib import Path

from cosim.batches.identity import Identity, identity_of
from cosim.batches.job import Configuration, Job
from cosim.batches.matrix import Matrix
from cosim.batches.pool import Pool
from cosim.errors import InputError, SimulationError
from cosim.recording.provenance import Inputs

Progress = Callable[[int, int], None]
"""Called with the number of configurations checked so far, and the number of all."""


@dataclass(frozen=True, slots=True)
class Checked:
    """Configurations that can be run, and the inputs on which their numbers depend."""

    inputs: dict[Configuration, tuple[Inputs, str]]

    def identity(self, job: Job) -> Identity:
        """Return the inputs that determine the numbers of a run."""
        inputs, source = self.inputs[job.configuration]
        return identity_of(replace(inputs, seed=job.seed), source)

    def simulated_s(self, configuration: Configuration) -> float:
        """Return the simulated time of a run [s]."""
        return self.inputs[configuration][0].duration_s or 0.0


def check(matrix: Matrix, pool: Pool, file: Path, progress: Progress = lambda done, total: None) -> Checked:
    """Build every configuration once, and let SUMO read every scenario once with each set of parameters.

    Raises
    ------
    InputError
        If a configuration cannot be run; names the first one.
    SimulationError
        If the check is interrupted.
    """
    try:
        return _checked(matrix, pool, file, progress)
    except KeyboardInterrupt:
        raise SimulationError(f"interrupted while {file} was checked; nothing was run") from None


def _checked(matrix: Matrix, pool: Pool, file: Path, progress: Progress) -> Checked:
    started: set[object] = set()
    waiting: deque[tuple[Configuration, Future[tuple[Inputs, str] | str]]] = deque()
    found: dict[Configuration, tuple[Inputs, str]] = {}
    for one in (*matrix.configurations, None):
        while waiting and (one is None or len(waiting) >= pool.capacity()):
            checked, future = waiting.popleft()
            answer = future.result()
            if isinstance(answer, str):
                raise InputError(f"{file}: {checked.label}: {answer}")
            found[checked] = answer
            progress(len(found), len(matrix.configurations))
        if one is not None:
            waiting.append((one, pool.check(Job(one, matrix.seeds[0]), one.road not in started)))
            started.add(one.road)
    return Checked(found)
