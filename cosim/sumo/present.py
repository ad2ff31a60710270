"""Who is in the simulation at one instant: the only road users about whom SUMO may be asked."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple, TypeVar

Value = TypeVar("Value")


class Present(NamedTuple):
    """Everybody who is there after a step.

    SUMO's lists of a step (who departed, who is near an ego) also name vehicles and persons that the same
    step has taken away again: arrived, removed, vaporised, teleporting. SUMO refuses every question about
    them.
    """

    vehicles: frozenset[str] = frozenset()
    """On the road or parked; not those that are being teleported."""
    persons: frozenset[str] = frozenset()
    """On foot, waiting or riding."""


def everybody_present(sumo: Any) -> Present:
    """Return who is in the simulation now.

    Parameters
    ----------
    sumo : module or connection
    """
    return Present(frozenset(sumo.vehicle.getIDList()), frozenset(sumo.person.getIDList()))


def forget_absent(known: dict[str, Value], present: Iterable[str]) -> None:
    """Drop what is remembered of those who are gone, once they are the greater part of it.

    >>> known = dict.fromkeys(map(str, range(300)), 0)
    >>> forget_absent(known, frozenset({"1", "2"}))
    >>> sorted(known)
    ['1', '2']
    """
    there = present if isinstance(present, frozenset) else frozenset(present)
    if len(known) > 2 * len(there) + _FEW:
        for name in known.keys() - there:
            del known[name]


_FEW = 200
