"""Counts the objects that are carried over to a mended network, and those that cannot be."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable

NAMED = 3
"""Number of ids of omitted objects that are named."""


class Carried:
    """Counts by kind, such as ``busStop`` or ``departLane of vehicle``."""

    def __init__(self) -> None:
        self._renumbered: Counter[str] = Counter()
        self._moved: Counter[str] = Counter()
        self._left_out: defaultdict[tuple[str, str], list[str]] = defaultdict(list)

    def renumbered(self, kind: str) -> None:
        """Count an object that names a lane whose number has changed."""
        self._renumbered[kind] += 1

    def moved(self, kind: str) -> None:
        """Count an object whose position along its lane has changed."""
        self._moved[kind] += 1

    def left_out(self, kind: str, name: str, why: str) -> None:
        """Note an object that is not in the copy."""
        self._left_out[kind, why].append(name)

    def lines(self) -> list[str]:
        """Return one line for each kind that was changed, and for each kind and reason of omission."""
        kinds = dict.fromkeys([*self._renumbered, *self._moved])
        said = [f"{kind}: {', '.join(self._changes(kind))}" for kind in kinds]
        for (kind, why), names in self._left_out.items():
            said.append(f"{kind}: {len(names)} left out, {_some(names)}: {why}")
        return said

    def _changes(self, kind: str) -> Iterable[str]:
        if self._renumbered[kind]:
            yield f"{self._renumbered[kind]} with a new lane number"
        if self._moved[kind]:
            yield f"{self._moved[kind]} with a new position"


def _some(names: list[str]) -> str:
    """Return the first three names.

    >>> _some(["a", "b", "c", "d"])
    "'a', 'b', 'c', …"
    """
    return ", ".join(map(repr, names[:NAMED])) + (", …" if len(names) > NAMED else "")
