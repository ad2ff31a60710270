"""How far measures of the analysis are from independent judges: shapely and brute-force searches.

The judges share no code with the analysis.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Agreement:
    """How far a measure is from its judge over all cases."""

    measure: str
    judge: str
    cases: int
    defined: int
    largest: float
    mean: float
    unit: str
    disagreements: int = 0
    """Cases in which one says defined and the other does not."""


Judge = Callable[[int], Agreement]


def agreement(
    measure: str, judge: str, cases: int, difference: Array, unit: str, disagreements: int = 0
) -> Agreement:
    """Return what the differences from the judge come to."""
    largest = float(difference.max()) if len(difference) else 0.0
    mean = float(difference.mean()) if len(difference) else 0.0
    return Agreement(measure, judge, cases, len(difference), largest, mean, unit, disagreements)
