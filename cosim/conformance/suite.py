"""Find the conformance cases, run both sides of each in separate processes, and judge them."""

from __future__ import annotations

import importlib
import json
import os
import pkgutil
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from cosim import processes
from cosim.conformance import cases as case_modules
from cosim.conformance.case import Case, Result, Values
from cosim.conformance.stage import nets_folder, use_nets
from cosim.errors import InputError, SimulationError

CLAIM = "claim"
CONTROL = "control"
_TIMEOUT = 600.0


def cases() -> tuple[Case, ...]:
    """Return every case, in the order of the modules' names."""
    found: list[Case] = []
    for module in sorted(info.name for info in pkgutil.iter_modules(case_modules.__path__)):
        found.extend(importlib.import_module(f"{case_modules.__name__}.{module}").CASES)
    return tuple(found)


def named(keys: Sequence[str]) -> tuple[Case, ...]:
    """Return the cases with these keys.

    Raises
    ------
    InputError
        If a key belongs to no case.
    """
    known = {case.key: case for case in cases()}
    for key in keys:
        if key not in known:
            raise InputError(f"no conformance case is called {key!r}; there are {', '.join(known)}")
    return tuple(known[key] for key in keys)


def run(
    chosen: Sequence[Case], jobs: int = 1, finished: Callable[[Result], None] | None = None
) -> list[Result]:
    """Run cases, ``jobs`` of them at a time, and return their results in the same order.

    Parameters
    ----------
    chosen : cases to run
    jobs : number of cases that run at the same time
    finished : called with each result as soon as it is there, to show progress
    """
    with ThreadPoolExecutor(max_workers=max(1, jobs)) as pool:
        return list(pool.map(partial(_judged, finished=finished), chosen))


def measure(case: Case, side: str) -> Values:
    """Run one side of a case in a new process; a crash is reported in the value ``return_code``.

    Raises
    ------
    SimulationError
        If the process took too long.
    """
    with tempfile.TemporaryDirectory(prefix="cosim-conformance-") as folder:
        output, log = Path(folder) / "values.json", Path(folder) / "log.txt"
        process = processes.context().Process(  # type: ignore[attr-defined]  # of every context that there is
            target=_serve, args=(case.key, side, output, log, nets_folder()), daemon=True
        )
        process.start()
        process.join(_TIMEOUT)
        if process.exitcode is None:
            process.kill()
            process.join()
            raise SimulationError(f"conformance case {case.key} took more than {_TIMEOUT:.0f} s")
        values: dict[str, float | str] = {"return_code": process.exitcode}
        if output.exists():
            values.update(json.loads(output.read_text()))
        elif process.exitcode >= 0:
            last = (log.read_text(errors="replace").strip().splitlines() or ["no message"])[-1]
            values["error"] = last
        return values


def _serve(key: str, side: str, output: Path, log: Path, nets: Path) -> None:
    """Measure one side of a case in this process and write its values as JSON."""
    use_nets(nets)
    with log.open("wb") as file:
        for stream in (1, 2):  # also catches output of libraries
            os.dup2(file.fileno(), stream)
    (case,) = named([key])
    values = case.claim() if side == CLAIM else case.control()
    output.write_text(json.dumps(dict(values)))


def _judged(case: Case, finished: Callable[[Result], None] | None) -> Result:
    begun = time.monotonic()
    measured, control = measure(case, CLAIM), measure(case, CONTROL)
    held = "error" not in measured and _met(case.holds, measured)
    result = Result(
        case=case,
        measured=measured,
        control_measured=control,
        passed="error" not in measured and held is not case.expected_failure,
        control_failed_as_it_must="error" not in control and _met(case.control_fails, control),
        seconds=time.monotonic() - begun,
    )
    if finished is not None:
        finished(result)
    return result


def _met(criterion: Callable[[Values], bool], values: Values) -> bool:
    """Return whether the criterion is met; it is not if a crash left out a value that it needs."""
    try:
        return criterion(values)
    except KeyError:
        return False
