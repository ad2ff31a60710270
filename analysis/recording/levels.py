"""Edges of a recorded map that lead over or under each other: road users on the one never meet the others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from analysis.arrays import BoolArray, IntArray


@dataclass(frozen=True, slots=True)
class Levels:
    """Numbers of the edges, from 1; 0 stands for all edges that lead over or under no other one."""

    numbers: Mapping[str, int]
    apart: BoolArray
    """Whether two edges are on different levels, shape (1 + edges, 1 + edges)."""

    def of(self, name: str) -> int:
        """Return the number of an edge, or of the edge of a lane."""
        return self.numbers.get(name) or self.numbers.get(name.rpartition("_")[0], 0)

    def of_all(self, names: Iterable[str], codes: IntArray) -> IntArray:
        """Return the numbers of edges or lanes, given as codes into ``names``; code −1 stands for none."""
        return np.array([*map(self.of, names), 0], dtype=np.int64)[codes]


def levels_of(crossed: Mapping[str, Iterable[str]]) -> Levels:
    """Return the levels of edges, given the edges that each one leads over or under.

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
