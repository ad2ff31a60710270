"""Numbers of a scenario's description, fixed or drawn from a distribution."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np

SHAPES = ("normal", "lognormal", "uniform", "choice")
_EXAMPLES = "a number, { normal = [mean, deviation] }, { uniform = [from, to] } or { choice = [a, b] }"


@dataclass(frozen=True, slots=True)
class Distribution:
    """Distribution from which a number is drawn.

    ``normal`` takes mean and standard deviation, ``lognormal`` median and standard deviation of the
    logarithm, ``uniform`` both ends, ``choice`` any values with weights. The first two are truncated at
    ``minimum`` and ``maximum``.

    >>> Distribution("choice", (1.4,)).draw(np.random.default_rng(1))
    1.4
    """

    shape: str
    values: tuple[float, ...]
    weights: tuple[float, ...] = ()
    minimum: float = -math.inf
    maximum: float = math.inf

    @property
    def lowest(self) -> float:
        """Smallest number that can be drawn."""
        if self.shape in ("uniform", "choice"):
            return min(self.values)
        return max(self.minimum, 0.0) if self.shape == "lognormal" else self.minimum

    @property
    def highest(self) -> float:
        """Largest number that can be drawn."""
        return max(self.values) if self.shape in ("uniform", "choice") else self.maximum

    def draw(self, generator: np.random.Generator) -> float:
        """Return one number; the generator advances by one, whatever the shape."""
        return self.quantile(float(generator.random()))

    def quantile(self, share: float) -> float:
        """Return the quantile for this share; for ``choice``, values count in the order given.

        >>> Distribution("uniform", (2.0, 6.0)).quantile(0.25)
        3.0
        """
        if self.shape == "uniform":
            return self.values[0] + share * (self.values[1] - self.values[0])
        if self.shape == "choice":
            weights = np.cumsum(self.weights or (1.0,) * len(self.values))
            found = int(np.searchsorted(weights, share * weights[-1], side="right"))
            return self.values[min(found, len(self.values) - 1)]
        low, high = self._shares()
        # The inverse is not defined at 0 and 1.
        share = min(max(low + share * (high - low), 1e-12), 1.0 - 1e-12)
        standard = NormalDist().inv_cdf(share)
        if self.shape == "lognormal":
            number = self.values[0] * math.exp(self.values[1] * standard)
        else:
            number = self.values[0] + self.values[1] * standard
        return min(max(number, self.minimum), self.maximum)

    def _shares(self) -> tuple[float, float]:
        """Return the shares of the untruncated distribution below the minimum and below the maximum."""
        middle, deviation = self.values
        if deviation == 0.0:
            return 0.0, 1.0
        cut = []
        for bound in (self.minimum, self.maximum):
            if self.shape == "lognormal":
                bound = math.log(bound / middle) if bound > 0.0 else -math.inf
            else:
                bound -= middle
            cut.append(NormalDist().cdf(bound / deviation) if math.isfinite(bound) else float(bound > 0.0))
        return cut[0], cut[1]


def read_distribution(value: Any, low: float = -math.inf, high: float = math.inf) -> Distribution:
    """Return the distribution that a description gives, checked to give numbers from ``low`` to ``high``.

    Raises
    ------
    ValueError
        If the description is wrong; the message is one line that says what was expected.
    """
    if isinstance(value, Distribution):
        return value
    if isinstance(value, bool) or not isinstance(value, int | float | Mapping):
        raise ValueError(f"expected {_EXAMPLES}, got {value!r}")
    found = _from_table(value) if isinstance(value, Mapping) else Distribution("choice", (_finite(value),))
    if found.lowest < low or found.highest > high:
        missing = found.shape in ("normal", "lognormal")
        hint = "; give a minimum and a maximum" if missing else ""
        raise ValueError(f"expected {low:g} to {high:g}, got {found.lowest:g} to {found.highest:g}{hint}")
    return found


def _from_table(table: Mapping[str, Any]) -> Distribution:
    shapes = [key for key in table if key in SHAPES]
    allowed = {"normal", "minimum", "maximum"}
    if len(shapes) != 1:
        raise ValueError(f"expected {_EXAMPLES}, got {dict(table)!r}")
    shape = shapes[0]
    if shape == "lognormal":
        allowed = {"lognormal", "minimum", "maximum"}
    elif shape != "normal":
        allowed = {shape, "weights"} if shape == "choice" else {shape}
    unknown = sorted(set(table) - allowed)
    if unknown:
        raise ValueError(
            f"unknown key '{unknown[0]}' beside '{shape}'; there are: {', '.join(sorted(allowed))}"
        )
    values = _numbers(shape, table[shape])
    weights = _numbers("weights", table["weights"]) if "weights" in table else ()
    bounds = [_finite(table[key]) if key in table else fallback for key, fallback in _BOUNDS]
    found = Distribution(shape, values, weights, *bounds)
    _check(found)
    return found


_BOUNDS = (("minimum", -math.inf), ("maximum", math.inf))


def _check(found: Distribution) -> None:
    count = len(found.values)
    if found.shape == "choice":
        if not count:
            raise ValueError("'choice': expected at least one number, got none")
        if found.weights and len(found.weights) != count:
            raise ValueError(f"'weights': expected {count} numbers, got {len(found.weights)}")
        if found.weights and (min(found.weights) < 0.0 or sum(found.weights) <= 0.0):
            raise ValueError("'weights': expected numbers of at least 0, not all of them 0")
        return
    if count != 2:
        raise ValueError(f"'{found.shape}': expected two numbers, got {count}")
    if found.shape == "uniform":
        if found.values[0] > found.values[1]:
            raise ValueError(f"'uniform': {found.values[0]:g} is greater than {found.values[1]:g}")
        return
    if found.values[1] < 0.0 or (found.shape == "lognormal" and found.values[0] <= 0.0):
        raise ValueError(f"'{found.shape}': expected a deviation of at least 0, and a median above 0")
    low, high = found._shares()
    inside = found.minimum <= found.values[0] <= found.maximum
    if found.minimum > found.maximum or not (high - low > 1e-9 or inside):
        raise ValueError(f"'{found.shape}': nothing lies between {found.minimum:g} and {found.maximum:g}")


def _numbers(key: str, values: Any) -> tuple[float, ...]:
    if not isinstance(values, list):
        raise ValueError(f"'{key}': expected a list of numbers, got {values!r}")
    return tuple(_finite(value) for value in values)


def _finite(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"expected a finite number, got {value!r}")
    return float(value)
