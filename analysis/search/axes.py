"""The axes of a search space, and points on them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

Value = float | int | str
Point = Mapping[str, Value]
"""A value for each axis, by name."""
DIGITS = 4
"""Significant digits of a searched number, so that people can read a point and write it down."""


@dataclass(frozen=True, slots=True)
class Axis:
    """One quantity that a search varies: a number within bounds, or one of several choices."""

    name: str
    low: float = 0.0
    high: float = 1.0
    whole: bool = False
    """Whether its values are whole numbers."""
    choices: tuple[str, ...] = ()
    """The choices, if it is not a number."""
    when: tuple[tuple[str, tuple[str, ...]], ...] = ()
    """It has an effect only if each of these axes has one of these choices."""

    def matters(self, point: Point) -> bool:
        """Return whether it has an effect at a point.

        Examples
        --------
        >>> pause = Axis("pause_s", when=(("manner", ("hesitating",)),))
        >>> pause.matters({"manner": "steady"}), pause.matters({"manner": "hesitating"})
        (False, True)
        """
        return all(str(point[name]) in choices for name, choices in self.when)

    @property
    def numeric(self) -> bool:
        """Whether its values are numbers."""
        return not self.choices

    def value(self, share: float) -> Value:
        """Return the value at a share of the axis, from 0 to 1.

        Examples
        --------
        >>> Axis("speed_mps", 0.5, 2.5).value(0.25), Axis("side", choices=("left", "right")).value(0.5)
        (1.0, 'right')
        """
        if self.choices:
            return self.choices[min(int(share * len(self.choices)), len(self.choices) - 1)]
        if self.whole:
            count = round(self.high - self.low) + 1
            return int(self.low) + min(int(share * count), count - 1)
        return min(max(rounded(self.low + share * (self.high - self.low)), self.low), self.high)

    def share(self, value: Value) -> float:
        """Return the share of a value on the axis; for a choice or whole number, the middle of its part.

        Examples
        --------
        >>> Axis("speed_mps", 0.5, 2.5).share(1.0), Axis("side", choices=("left", "right")).share("right")
        (0.25, 0.75)
        """
        if self.choices:
            return (self.choices.index(str(value)) + 0.5) / len(self.choices)
        if self.whole:
            return (float(value) - self.low + 0.5) / (self.high - self.low + 1.0)
        return (float(value) - self.low) / (self.high - self.low)


def rounded(value: float) -> float:
    """Return a number with `DIGITS` significant digits.

    Examples
    --------
    >>> rounded(1.23456), rounded(-0.00123456)
    (1.235, -0.001235)
    """
    if value == 0.0 or not math.isfinite(value):
        return value
    return round(value, DIGITS - 1 - math.floor(math.log10(abs(value))))


def point(axes: Sequence[Axis], shares: Sequence[float]) -> dict[str, Value]:
    """Return the point at given shares of the axes."""
    return {axis.name: axis.value(float(share)) for axis, share in zip(axes, shares, strict=True)}


def shares(axes: Sequence[Axis], points: Sequence[Point]) -> np.ndarray:
    """Return the shares of points, as an array (points, axes)."""
    found = [[axis.share(one[axis.name]) for axis in axes] for one in points]
    return np.array(found, dtype=np.float64).reshape(len(points), len(axes))


def distance(axes: Sequence[Axis], one: Point, other: Point) -> float:
    """Return the distance between two points, 0 to 1; all axes weigh the same, and choices are 0 or 1 apart.

    Examples
    --------
    >>> speed, side = Axis("speed", 0.0, 4.0), Axis("side", choices=("left", "right"))
    >>> distance([speed, side], {"speed": 0.0, "side": "left"}, {"speed": 4.0, "side": "right"})
    1.0
    """
    total = sum(_apart(axis, one[axis.name], other[axis.name]) ** 2 for axis in axes)
    return math.sqrt(total / max(len(axes), 1))


def _apart(axis: Axis, one: Value, other: Value) -> float:
    if axis.choices:
        return float(one != other)
    return abs(axis.share(one) - axis.share(other))
