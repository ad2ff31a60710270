"""Which tests need a POSIX system, and the last line of the tests: which did not run, and why."""

from __future__ import annotations

import gc
import os
import signal
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from cosim import processes

NEED_POSIX = (
    "chaos",
    "fuzz",
    "cosim/batches/test_dask_cluster.py",
    "cosim/batches/test_failures.py",
    "cosim/batches/test_unruly_at_once.py",
    "cosim/cli/test_crash.py",
    "cosim/recording/test_folders.py",
    "cosim/running/test_no_room.py",
    "cosim/search/test_dask.py",
    "studies/papers/test_command.py",
)
"""They use signals, processes that are killed, limits of resources or links; elsewhere they are not collected."""
collect_ignore = [] if os.name == "posix" else list(NEED_POSIX)


COARSE_DPI = 25


@pytest.fixture(scope="session", autouse=True)
def coarse_figures() -> Iterator[Callable[..., Any]]:
    """Write pictures with few dots, which takes half the time: most tests only ask whether there is one."""
    from matplotlib.figure import Figure

    fine = Figure.savefig

    def coarse(figure: Figure, file: Any, **given: Any) -> None:
        kind = given.get("format") or Path(file).suffix.removeprefix(".")
        fine(figure, file, **{**given, "dpi": COARSE_DPI} if kind == "png" else given)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "savefig", coarse)
        yield fine


@pytest.fixture
def fine_figures(coarse_figures: Callable[..., Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """Write pictures with as many dots as users get."""
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", coarse_figures)


def pytest_configure() -> None:
    """Let Ctrl-C end processes that tests start: a shell starts jobs in the background with Ctrl-C ignored.

    Besides, let a batch that is not told otherwise have one worker process.
    """
    gc.disable()  # until the tests are loaded: none of it is garbage
    # Another process costs more than it saves where tests run side by side. Tests of several ones ask for them.
    processes.cores = lambda: 1
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_finish() -> None:
    """Look for garbage in what tests make, seldom, and not in all the modules and tests that are loaded."""
    gc.enable()
    gc.set_threshold(10_000)
    gc.collect()
    gc.freeze()


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say in one line how many tests were skipped, for each reason."""
    reasons: Counter[str] = Counter()
    for report in terminalreporter.stats.get("skipped", []):
        told = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
        reasons[told.removeprefix("Skipped: ")] += 1
    if reasons:
        told = "; ".join(f"{count} because of: {reason}" for reason, count in reasons.items())
        terminalreporter.write_line(f"{reasons.total()} tests did not run: {told}")
