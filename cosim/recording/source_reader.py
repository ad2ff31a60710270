"""Reads the values of columns from one object; it has to be fast, as every ego has a row in every step."""

from __future__ import annotations

from collections.abc import Sequence
from operator import attrgetter, itemgetter
from typing import Any


class SourceReader:
    """Reads attributes of attributes, each intermediate one once; if one is ``None``, so is the value.

    Examples
    --------
    >>> SourceReader(["imag.real", "real"]).read(3)
    (0, 3)
    """

    def __init__(self, sources: Sequence[str]) -> None:
        # Intermediate objects are numbered: first the object itself, then each one after its owner.
        number = {"": 0}
        self._ways: list[tuple[int, attrgetter[Any]]] = []
        ends: dict[int, list[str]] = {}
        for source in sources:
            way = ""
            *names, _ = source.split(".")
            for name in names:
                before, way = number[way], f"{way}.{name}"
                if way not in number:
                    number[way] = len(number)
                    self._ways.append((before, attrgetter(name)))
            ends.setdefault(number[way], []).append(source)
        self._groups = [
            # "__class__" is added because for a single name attrgetter returns the value, not a tuple.
            (at, attrgetter(*map(_last, group), "__class__"), (None,) * (len(group) + 1))
            for at, group in ends.items()
        ]
        found = [one for group in ends.values() for one in (*group, "")]
        places = [found.index(source) for source in sources]
        self._in_order = itemgetter(*places, places[0])

    def read(self, made_of: Any) -> tuple[Any, ...]:
        """Return the values in the order of the sources."""
        objects = [made_of]
        for before, attribute in self._ways:
            one = objects[before]
            objects.append(None if one is None else attribute(one))
        found: list[Any] = []
        for at, attributes, nothing in self._groups:
            one = objects[at]
            found += nothing if one is None else attributes(one)
        values: tuple[Any, ...] = self._in_order(found)
        return values[:-1]


def _last(source: str) -> str:
    return source.rpartition(".")[2]
