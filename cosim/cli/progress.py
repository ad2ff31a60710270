"""Progress of a run: a bar on a terminal, a line now and then in a log."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

SILENT_S = 3.0
"""Nothing is shown of runs that are over sooner [s]."""
LOG_EVERY_S = 10.0
REDRAW_EVERY_S = 0.2

Report = Callable[[float, float | None], None]


@contextmanager
def shown_progress() -> Iterator[Report]:
    """Give a function that is told the simulated time and the end, where one is known [s]."""
    if sys.stderr.isatty():
        with _bar() as report:
            yield report
    else:
        yield _log()


@contextmanager
def _bar() -> Iterator[Report]:
    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.fields[clock]}"),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        transient=True,
        auto_refresh=False,
    )
    task = bar.add_task("simulating", total=None, clock="")
    next_draw = monotonic() + SILENT_S
    started = False

    def report(time: float, end: float | None) -> None:
        nonlocal next_draw, started
        now = monotonic()
        if now < next_draw:
            return
        if not started:
            bar.start()
            started = True
        next_draw = now + REDRAW_EVERY_S
        bar.update(task, total=end, completed=time, clock=_clock(time, end))
        bar.refresh()

    try:
        yield report
    finally:
        if started:
            bar.stop()


def _log() -> Report:
    next_line = monotonic() + LOG_EVERY_S

    def report(time: float, end: float | None) -> None:
        nonlocal next_line
        now = monotonic()
        if now >= next_line:
            next_line = now + LOG_EVERY_S
            print(f"simulated {_clock(time, end)}", file=sys.stderr, flush=True)

    return report


def _clock(time: float, end: float | None) -> str:
    return f"{time:.0f} s" if end is None else f"{time:.0f} of {end:.0f} s"
