"""Which edges of a recorded map lead over or under each other: nobody on the one meets those on the other."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from analysis.arrays import BoolArray, IntArray


@dataclass(frozen=True, slots=True)
class Levels:
    """Edges by number, from 1; 0 stands for all that cross nothing."""

    numbers: Mapping[str, int]
    apart: BoolArray
    """Whether two edges are on different levels, shape (1 + edges, 1 + edges)."""

    def of(self, name: str) -> int:
        """Return the number of an edge, or of the edge of a lane."""
        return self.numbers.get(name) or self.numbers.get(name.rpartition("_")[0], 0)

    def of_all(self, names: Iterable[str], codes: IntArray) -> IntArray:
        """Return the number of each of many names, given as codes into some; −1 stands for none."""
        return np.array([*map(self.of, names), 0], dtype=np.int64)[codes]


def levels_of(crossed: Mapping[str, Iterable[str]]) -> Levels:
    """Return the levels of edges, each with those that it crosses without meeting them.

    Examples
    --------
    >>> levels = levels_of({"bridge": ["street"]})
    >>> bool(levels.apart[levels.of("street_0"), levels.of("bridge")]), levels.of("elsewhere")
    (True, 0)
    """
    names = sorted({*crossed, *(other for others in crossed.values() for other in others)})
    numbers = {name: number for number, name in enumerate(names, 1)}
    apart = np.zeros((len(names) + 1, len(names) + 1), dtype=np.bool_)
    for name, others in crossed.items():
        for other in others:
            apart[numbers[name], numbers[other]] = apart[numbers[other], numbers[name]] = True
    return Levels(numbers, apart)
