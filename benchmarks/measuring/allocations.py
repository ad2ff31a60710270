"""What a control step allocates, and whether anything of it stays."""

from __future__ import annotations

import gc
import itertools
import sys
import tracemalloc
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from controllers.interface import Perception
from measuring import perceptions
from measuring.bars import Bar
from measuring.perceptions import STEP, Case

MOST_HELD = 1024.0
"""Bytes per 1000 steps that count as nothing."""
WARM_UP = 0.3
"""Steps before that, as a share of those watched."""
LOOKS = 10
"""How often what is held is read, evenly spread."""


def watch(case: Case, solver: str, steps: int) -> dict[str, Any]:
    """Return what is still held after so many control steps, and the peaks of single steps."""
    perceptions.warm_up(case, solver)
    approaches = perceptions.record(case)
    seen = _endless(approaches)
    driver = perceptions.controller(case, solver)
    # A look is always at the same place of the approaches: what a plan holds depends on who is around.
    whole = sum(map(len, approaches))
    every = whole * max(1, round(steps / LOOKS / whole))
    steps = max(steps, 2 * every + 1)
    held: list[int] = []
    peaks = np.zeros(steps)  # before anything is counted
    tracemalloc.start()
    try:
        # The growth of the first thousand steps is larger than what comes after.
        for _ in range(whole * max(1, round(WARM_UP * steps / whole))):
            perception = next(seen)
            driver.plan(perception, driver.decide(perception))
        for i in range(steps):
            perception = next(seen)
            if i % every == 0:
                gc.collect()
                # Python remembers up to 4096 names of attributes that were looked up. NumPy makes some
                # anew each time; they are nobody's.
                _forget_names()
                held.append(tracemalloc.get_traced_memory()[0])
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            driver.plan(perception, driver.decide(perception))
            peaks[i] = tracemalloc.get_traced_memory()[1] - before
    finally:
        tracemalloc.stop()
    slope = float(np.polyfit(np.arange(len(held)) * every, held, 1)[0])
    return {
        "case": str(case),
        "steps": steps,
        "bytes_per_1000_steps": 1000.0 * slope,
        "bytes_after_first": int(held[0]),
        "bytes_after_last": int(held[-1]),
        "peak_median_kb": float(np.median(peaks)) / 1e3,
        "peak_most_kb": float(peaks.max()) / 1e3,
    }


def _forget_names() -> None:
    """Empty Python's caches of attribute names, which it fills again."""
    forget: Callable[[], None] = getattr(sys, "_clear_internal_caches", None) or sys._clear_type_cache
    forget()


def told(entry: Mapping[str, Any]) -> str:
    """Return one line about what was found."""
    return (
        f"{entry['steps']} control steps hold {entry['bytes_per_1000_steps']:+.0f} bytes more per 1000; "
        f"a step's peak is {entry['peak_median_kb']:.0f} kB in the median, "
        f"{entry['peak_most_kb']:.0f} at most"
    )


def bars(held: Mapping[str, Mapping[str, Any]]) -> list[Bar]:
    """Return what is asked of the memory of a control step."""
    return [
        Bar(
            what=f"bytes still held per 1000 control steps over {entry['steps']}, {solver}",
            measured=entry["bytes_per_1000_steps"],
            at_most=MOST_HELD,
            unit="bytes",
        )
        for solver, entry in held.items()
    ]


def _endless(approaches: list[perceptions.Approach]) -> Iterator[Perception]:
    """Return the approaches again and again, on one clock."""
    time = 0.0
    for approach in itertools.cycle(approaches):
        for perception in approach:
            yield replace(perception, ego=replace(perception.ego, time=time))
            time += STEP
