"""Which tests need a POSIX system, and the last line of the tests: which did not run, and why."""

from __future__ import annotations

import gc
import os
import signal
from collections import Counter

import pytest

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


def pytest_configure() -> None:
    """Let Ctrl-C end processes that tests start: a shell starts jobs in the background with Ctrl-C ignored."""
    gc.disable()  # until the tests are loaded: none of it is garbage
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
