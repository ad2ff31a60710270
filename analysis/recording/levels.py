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
        """Return the number of an edge."""
        return self.numbers.get(name, 0)

    def of_lane(self, name: str) -> int:
        """Return the number of the edge of a lane; another edge may have the name of the lane."""
        return self.of(name.rpartition("_")[0])

    def of_edges(self, names: Iterable[str], codes: IntArray) -> IntArray:
        """Return the numbers of edges, given as codes into ``names``; code −1 stands for none."""
        return np.array([*map(self.of, names), 0], dtype=np.int64)[codes]

    def of_lanes(self, names: Iterable[str], codes: IntArray) -> IntArray:
        """Return the numbers of the edges of lanes, given as codes into ``names``; code −1: none."""
        return np.array([*map(self.of_lane, names), 0], dtype=np.int64)[codes]


def levels_of(crossed: Mapping[str, Iterable[str]]) -> Levels:
    """Return the levels of edges, given the edges that each one leads over or under.

    Examples
    --------
    >>> levels = levels_of({"bridge": ["street"]})
    >>> bool(levels.apart[levels.of_lane("street_0"), levels.of("bridge")]), levels.of("elsewhere")
    (True, 0)
    """
    names = sorted({*crossed, *(other for others in crossed.values() for other in others)})
    numbers = {name: number for number, name in enumerate(names, 1)}
    apart = np.zeros((len(names) + 1, len(names) + 1), dtype=np.bool_)
    for name, others in crossed.items():
        for other in others:
            apart[numbers[name], numbers[other]] = apart[numbers[other], numbers[name]] = True
    return Levels(numbers, apart)
