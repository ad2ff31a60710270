"""Road users in the simulation at one instant; SUMO may be queried only about these."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple, TypeVar

Value = TypeVar("Value")


class Present(NamedTuple):
    """All road users after a step.

    SUMO's lists of a step (who departed, who is near an ego) also name vehicles and persons that the same
    step has taken away again because they arrived, were removed or vaporised, or are teleporting. SUMO
    refuses every query about them.
    """

    vehicles: frozenset[str] = frozenset()
    """Vehicles on the road or parked; not those that are being teleported."""
    persons: frozenset[str] = frozenset()
    """Persons on foot, waiting or riding."""


class Departed(NamedTuple):
    """Road users that are present for the first time after a step, in the order of SUMO's lists."""

    vehicles: tuple[str, ...] = ()
    persons: tuple[str, ...] = ()


class Departures:
    """Finds who has departed; the first step includes the road users of a state that SUMO has loaded.

    Parameters
    ----------
    sumo : module or connection, before the first step
    """

    def __init__(self, sumo: Any) -> None:
        self._sumo = sumo
        self._loaded = everybody_present(sumo)

    def read(self, present: Present) -> Departed:
        """Return who has departed in the last step and is still there."""
        simulation, loaded, self._loaded = self._sumo.simulation, self._loaded, Present()
        vehicles = (*sorted(loaded.vehicles), *simulation.getDepartedIDList())
        persons = (*sorted(loaded.persons), *simulation.getDepartedPersonIDList())
        return Departed(
            tuple(name for name in dict.fromkeys(vehicles) if name in present.vehicles),
            tuple(name for name in dict.fromkeys(persons) if name in present.persons),
        )


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
