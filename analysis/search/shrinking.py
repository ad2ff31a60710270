"""The smallest change of a failing point that makes it pass, as property-based testing shrinks an example.

It is a generator that yields points to try and is sent whether each of them passes, so that several failures
can be tried side by side.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass

from analysis.search.axes import Axis, Point, Value, distance, rounded

HALVINGS = 5
"""How often the interval between failing and passing is halved."""

Asking = Generator[list[dict[str, Value]], list[bool], "Change | None"]


@dataclass(frozen=True, slots=True)
class Change:
    """A change that makes a failing point pass."""

    failing: Point
    """The failing point nearest to the boundary that was tried."""
    passing: Point
    """The passing point, which differs from it only in ``keys``."""
    keys: tuple[str, ...]

    def in_words(self) -> str:
        """Return the change as part of a sentence."""
        return ", ".join(
            f"{key} {_told(self.passing[key])} instead of {_told(self.failing[key])}" for key in self.keys
        )


def nearest(axes: Sequence[Axis], failing: Point, passing: Sequence[Point]) -> Point | None:
    """Return the passing point nearest to a failing one; the first of several equally near ones."""
    return min(passing, key=lambda one: distance(axes, failing, one), default=None)


def smallest_change(axes: Sequence[Axis], failing: Point, passing: Point) -> Asking:
    """Find a small change of few values that makes a failing point pass.

    First, each value alone is taken from the passing point; of those that suffice, the one with the
    smallest change is kept. If none suffices, values are put back to those of the failing point one by one,
    the largest change first, as long as the point still passes. Then the interval from failing to passing is
    halved `HALVINGS` times.

    Parameters
    ----------
    axes
    failing, passing
        Points that were tried.
    """
    by_name = {axis.name: axis for axis in axes}
    keys = [
        axis.name
        for axis in axes
        if failing[axis.name] != passing[axis.name] and (axis.matters(failing) or axis.matters(passing))
    ]
    if not keys:
        return None
    sizes = {key: distance([by_name[key]], failing, passing) for key in keys}
    answers = yield [{**failing, key: passing[key]} for key in keys]
    alone = [key for key, passes in zip(keys, answers, strict=True) if passes]
    if alone:
        needed = [min(alone, key=lambda key: sizes[key])]
    else:
        needed = list(keys)
        for key in sorted(keys, key=lambda each: -sizes[each]):
            fewer = [each for each in needed if each != key]
            if len(needed) > 2 and (yield [_mixed(failing, passing, fewer)])[0]:
                needed = fewer
    low: dict[str, Value] = dict(failing)
    high = _mixed(failing, passing, needed)
    for _ in range(HALVINGS):
        middle = {**low, **{key: _between(by_name[key], low[key], high[key]) for key in needed}}
        if middle in (low, high):
            break
        if (yield [middle])[0]:
            high = middle
        else:
            low = middle
    return Change(low, high, tuple(key for key in needed if low[key] != high[key]))


def _mixed(failing: Point, passing: Point, keys: Sequence[str]) -> dict[str, Value]:
    return {**failing, **{key: passing[key] for key in keys}}


def _between(axis: Axis, low: Value, high: Value) -> Value:
    """Return the middle; for choices, the passing one, and for neighbouring whole numbers, the lower one."""
    if not axis.numeric or isinstance(low, str) or isinstance(high, str):
        return high
    if axis.whole:
        return int(low + (high - low) / 2)
    return rounded(0.5 * (low + high))


def _told(value: Value) -> str:
    return value if isinstance(value, str) else f"{value:g}"
