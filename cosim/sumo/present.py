"""Road users in the simulation at one instant; SUMO may be queried about these only."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple, TypeVar

Value = TypeVar("Value")


class Present(NamedTuple):
    """All road users after a step.

    SUMO's lists of a step (who departed, who is near an ego) also name vehicles and persons that the same
    step has taken away again: arrived, removed, vaporised, teleporting. SUMO refuses every question about
    them.
    """

    vehicles: frozenset[str] = frozenset()
    """On the road or parked; not those that are being teleported."""
    persons: frozenset[str] = frozenset()
    """On foot, waiting or riding."""


def everybody_present(sumo: Any) -> Present:
    """Return the road users in the simulation now.

    Parameters
    ----------
    sumo : module or connection
    """
    return Present(frozenset(sumo.vehicle.getIDList()), frozenset(sumo.person.getIDList()))


def forget_absent(known: dict[str, Value], present: Iterable[str]) -> None:
    """Drop the entries of absent road users once they outnumber those of the present ones.

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
