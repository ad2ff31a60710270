"""Worker processes: each makes one run after another, and the pool watches it.

A run that fails ends its process, so that nothing of it can affect the next run. The pool then starts
another process.
"""

from __future__ import annotations

import faulthandler
import importlib
import multiprocessing
import os
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from multiprocessing import connection
from pathlib import Path
from typing import NoReturn

from cosim.batches.identity import source_digest
from cosim.batches.job import Job
from cosim.batches.outcome import LOG, NOTE, REASON, RUN
from cosim.errors import CosimError, SimulationError
from cosim.recording.provenance import Inputs

FAILED = 70
"""Exit code of a process whose run failed and that wrote down the reason (``EX_SOFTWARE``)."""
DISK_FULL = 74
"""Exit code of a process whose run failed and that could not write the reason (``EX_IOERR``)."""
TELL_EVERY_S = 10.0
"""Time between two progress lines in the log of a run [s]."""
SHARE_BEFORE_DUMP = 0.9
"""Share of the time limit after which the stack of a run is dumped to its log."""
LONG_ENOUGH_S = 0.5
"""A process whose run fails lives at least this long, so that the pool learns which run it had [s]."""

RECORDINGS = ("*.parquet", "map.json", "datapackage.json")
"""Files of a run that a batch can drop: the recording, and the dictionary of tables, as it writes its own."""


@dataclass(frozen=True, slots=True)
class Handling:
    """Settings of how runs are executed, which do not affect their numbers."""

    timeout_s: float
    drop_recordings: bool = False


def begin(environment: Mapping[str, str]) -> None:
    """Get a new worker process ready; the time to load modules here counts towards no run's time limit.

    Parameters
    ----------
    environment : Mapping
        Environment variables of the process that asked for this one, which may be a copy of an older process.
    """
    os.environ.clear()
    os.environ.update(environment)
    faulthandler.enable()
    threading.Thread(target=_end_with_parent, daemon=True).start()
    importlib.import_module("cosim.running.execution")


def check(job: Job, start_sumo: bool) -> tuple[Inputs, str] | str:
    """Return the inputs of a run and the hash of the code, or the reason why the run cannot be made.

    Parameters
    ----------
    job : Job
    start_sumo : bool
        Whether SUMO reads the files, too.
    """
    from cosim.running.compose import compose, inputs_of

    request = job.request()
    try:
        if not start_sumo:
            return inputs_of(request), source_digest(job.configuration.controller)
        composition = compose(request)
        try:
            return composition.inputs, source_digest(job.configuration.controller)
        finally:
            composition.close()
    except CosimError as error:
        return str(error)


def make(job: Job, place: str, folder: Path, handling: Handling) -> None:
    """Make a run in ``folder``; end the process if the run fails.

    Parameters
    ----------
    job : Job
    place : str
        Where the scenario is on this machine.
    folder : Path
        Folder of this attempt; must not exist.
    handling : Handling
    """
    started = time.monotonic()
    folder.mkdir(parents=True)
    with _output_to(folder / LOG):
        print(job.command(), flush=True)
        faulthandler.dump_traceback_later(SHARE_BEFORE_DUMP * handling.timeout_s)
        try:
            _make(job, place, folder / RUN, handling)
        except BaseException as error:  # noqa: BLE001  told to the batch, which goes on without this process
            _fail(folder, error, started)
        finally:
            faulthandler.cancel_dump_traceback_later()


def _make(job: Job, place: str, folder: Path, handling: Handling) -> None:
    from analysis.files import write_json
    from analysis.sealing import seal
    from cosim.running.execution import execute
    from cosim.running.simulation import TELEPORTED

    source = source_digest(job.configuration.controller)  # taken when the code is loaded
    started = time.monotonic()
    outcome = execute(replace(job.request(), scenario=place, out=folder), _heartbeat())
    if outcome.invalid_reason and not outcome.invalid_reason.startswith(TELEPORTED):
        raise SimulationError(outcome.invalid_reason)
    one = job.configuration
    note = {
        "run": job.name,
        "scenario": one.scenario,
        "place": one.place,
        "controller": one.controller,
        "seed": job.seed,
        "settings": dict(one.settings),
        "varied": dict(one.varied),
        "command": job.command(),
        "source": source,
    }
    note_file = write_json(folder / NOTE, note)
    dropped = []
    if handling.drop_recordings:
        dropped = [path for pattern in RECORDINGS for path in folder.glob(pattern)]
        for path in dropped:
            path.unlink()
    description = {**outcome.description, "wall_total_s": round(time.monotonic() - started, 3)}
    seal(folder, (note_file, write_json(folder / "run.json", description)), dropped)


def _heartbeat() -> Callable[[float, float | None], None]:
    said = time.monotonic()

    def report(simulated: float, end: float | None) -> None:
        nonlocal said
        if time.monotonic() - said > TELL_EVERY_S:
            said = time.monotonic()
            print(f"simulated {simulated:.0f} of {end or 0.0:.0f} s", flush=True)

    return report


def _fail(folder: Path, error: BaseException, started: float) -> NoReturn:
    """Write down the reason and end the process."""
    text = str(error) if isinstance(error, CosimError) else f"{type(error).__name__}: {error}"
    text = text.replace(str(folder / RUN), "the run")  # the message outlasts the folder
    code = FAILED
    try:
        traceback.print_exception(error)
        (folder / REASON).write_text(" ".join(text.split()) + "\n", encoding="utf-8")
    except OSError:
        code = DISK_FULL
    time.sleep(max(0.0, LONG_ENOUGH_S - (time.monotonic() - started)))
    os._exit(code)


def _end_with_parent() -> None:
    """End this process as soon as the process that started it has ended for any reason."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(1)


@contextmanager
def _output_to(path: Path) -> Iterator[None]:
    """Send both output streams to a file, including the output of libraries."""
    sys.stdout.flush()
    sys.stderr.flush()
    saved = [os.dup(number) for number in (1, 2)]
    with path.open("ab", buffering=0) as log:
        for number in (1, 2):
            os.dup2(log.fileno(), number)
    try:
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for number, copy in zip((1, 2), saved, strict=True):
            os.dup2(copy, number)
            os.close(copy)
