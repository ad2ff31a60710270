"""Progress of a batch: a bar on a terminal, or a line from time to time in a log."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import datetime
from time import monotonic

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from cosim.batches.conduct import Tally
from cosim.batches.estimate import in_words

LOG_EVERY_S = 10.0
REDRAW_EVERY_S = 0.5
CHECKS_EVERY_S = 10.0

Show = Callable[[Tally], None]


@contextmanager
def shown_tally(log_every_s: float = LOG_EVERY_S) -> Iterator[Show]:
    """Give a function that shows the progress of a batch on the standard error stream."""
    if not sys.stderr.isatty():
        yield _log(log_every_s)
        return
    console = Console(stderr=True, highlight=False, markup=False)
    bar = Progress(
        BarColumn(), TextColumn("{task.description}"), console=console, transient=True, auto_refresh=False
    )
    with bar:
        yield _drawn(bar)


def shown_checks() -> Callable[[int, int], None]:
    """Return a function that reports from time to time how many configurations are checked."""
    next_line = monotonic() + CHECKS_EVERY_S

    def show(done: int, total: int) -> None:
        nonlocal next_line
        if monotonic() >= next_line:
            next_line = monotonic() + CHECKS_EVERY_S
            print(f"{done} of {total} configurations checked", file=sys.stderr, flush=True)

    return show


def _drawn(bar: Progress) -> Show:
    task = bar.add_task("", total=None)
    started = monotonic()
    next_draw = 0.0

    def show(tally: Tally) -> None:
        nonlocal next_draw
        for line in _taken_failures(tally):
            bar.console.print(line, soft_wrap=True)
        now = monotonic()
        if now < next_draw:
            return
        next_draw = now + REDRAW_EVERY_S
        over = tally.done + tally.failed
        bar.update(task, total=tally.total, completed=over, description=standing(tally, now - started))
        bar.refresh()

    return show


def _log(log_every_s: float) -> Show:
    started = monotonic()
    next_line = started + log_every_s

    def show(tally: Tally) -> None:
        nonlocal next_line
        lines = _taken_failures(tally)
        now = monotonic()
        if now >= next_line:
            next_line = now + log_every_s
            lines.append(standing(tally, now - started))
        for line in lines:
            print(f"{datetime.now():%Y-%m-%d %H:%M:%S} {line}", file=sys.stderr, flush=True)

    return show


def _taken_failures(tally: Tally) -> list[str]:
    lines = [f"failed: {outcome.job.name}: {outcome.reason}" for outcome in tally.failures]
    tally.failures.clear()
    return lines


def standing(tally: Tally, elapsed_s: float) -> str:
    """Return the progress of a batch in one line.

    Examples
    --------
    >>> standing(Tally(total=10, done=4, failed=1, running=2, made=3), 60.0)
    '4 of 10 done, 1 failed, 2 running, 4.0 runs/min, 75 s left'
    """
    line = f"{tally.done} of {tally.total} done, {tally.failed} failed, {tally.running} running"
    over = tally.made + tally.failed
    if over and elapsed_s > 0.0:
        left = tally.total - tally.done - tally.failed
        line += f", {60.0 * over / elapsed_s:.1f} runs/min, {in_words(left * elapsed_s / over)} left"
    return line
