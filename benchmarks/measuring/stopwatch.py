"""Time by part: whose own code the clock was running in."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import wraps
from time import perf_counter
from typing import Any

import numpy as np

OTHER = "rest"
OUTSIDE = "outside"
"""Between the control steps; not reported."""


class Stopwatch:
    """Sums up the time spent in parts; a part called inside another is taken off the outer one.

    Parameters
    ----------
    whole
        Parts that keep the time of everything they call.
    """

    def __init__(self, whole: Sequence[str] = ()) -> None:
        self.seconds: dict[str, float] = {}
        self.calls: dict[str, int] = {}
        self.steps: list[dict[str, float]] = []
        """Time by part of each step that was ended."""
        self._whole = frozenset(whole)
        self._before: Mapping[str, float] = {}
        self._stack = [OUTSIDE]
        self._since = perf_counter()

    def timed(self, function: Callable[..., Any], part: str) -> Callable[..., Any]:
        """Return the function with its time counted under ``part``."""

        @wraps(function)
        def call(*args: Any, **kwargs: Any) -> Any:
            if self._stack[-1] in self._whole:
                return function(*args, **kwargs)
            with self.part(part):
                return function(*args, **kwargs)

        return call

    @contextmanager
    def part(self, part: str) -> Iterator[None]:
        """Count what is done inside under ``part``."""
        self._lap()
        self._stack.append(part)
        self.calls[part] = self.calls.get(part, 0) + 1
        try:
            yield
        finally:
            self._lap()
            self._stack.pop()

    def moved(self, seconds: float, source: str, target: str) -> None:
        """Count some of the time of one part under another."""
        self.seconds[source] = self.seconds.get(source, 0.0) - seconds
        self.seconds[target] = self.seconds.get(target, 0.0) + seconds

    def end_step(self) -> None:
        """Note what this step took."""
        self._lap()
        self.steps.append({part: now - self._before.get(part, 0.0) for part, now in self.seconds.items()})
        self._before = dict(self.seconds)

    def spread(self, parts: Sequence[str], skip: int = 0) -> dict[str, dict[str, float]]:
        """Return mean, median and 99th percentile of each part over the steps after the first ``skip``."""
        found = {}
        for part in parts:
            values = 1e3 * np.array([step.get(part, 0.0) for step in self.steps[skip:]])
            found[part] = {
                "mean_ms": float(values.mean()),
                "median_ms": float(np.median(values)),
                "p99_ms": float(np.percentile(values, 99)),
            }
        return found

    def _lap(self) -> None:
        now = perf_counter()
        top = self._stack[-1]
        self.seconds[top] = self.seconds.get(top, 0.0) + now - self._since
        self._since = now


@contextmanager
def watching(stopwatch: Stopwatch, places: Sequence[tuple[Any, str, str]]) -> Iterator[None]:
    """Count the functions at ``places`` (owner, attribute, part) while inside."""
    originals = [(owner, name, getattr(owner, name)) for owner, name, _ in places]
    for (owner, name, part), (*_, original) in zip(places, originals, strict=True):
        setattr(owner, name, stopwatch.timed(original, part))
    try:
        yield
    finally:
        for owner, name, original in originals:
            setattr(owner, name, original)


@contextmanager
def replaced(owner: Any, name: str, function: Callable[..., Any]) -> Iterator[None]:
    """Have ``owner.name`` be another function while inside."""
    original = getattr(owner, name)
    setattr(owner, name, function)
    try:
        yield
    finally:
        setattr(owner, name, original)
