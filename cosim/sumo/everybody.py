"""All road users near a crossing, egos or not, each read by a subscription."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cosim.arrays import FloatArray, IntArray
from cosim.step.world import Traffic
from cosim.sumo.lights import Lights
from cosim.sumo.network import Network
from cosim.sumo.present import Departed, Present, forget_absent
from cosim.sumo.road_users import CarReader, KnownState, PersonReader, sumo_constant
from cosim.sumo.truth import persons_truth, vehicles_truth, with_signals

PERSON_RANGE, VEHICLE_RANGE = 20.0, 60.0
"""Pedestrians and vehicles farther from every crossing are left out [m]."""
CELL = 4.0
"""Size of the cells by which the ground near crossings is known [m]."""


class Everybody:
    """Reads all road users near crossings.

    Parameters
    ----------
    sumo : module or connection
    network
    step : length of a step [s]
    """

    def __init__(self, sumo: Any, network: Network, step: float) -> None:
        self._sumo = sumo
        self._crossings = network.crossings
        self._people = PersonReader(sumo, network, step)
        self._cars = CarReader(sumo, step)
        self._allowed = sumo_constant(sumo, "VAR_ALLOWED_SPEED")
        self._classes: dict[str, str] = {}
        axes = [crossing.axis for crossing in network.crossings.values()]
        self._person_places = Places(axes, PERSON_RANGE)
        self._vehicle_places = Places(axes, VEHICLE_RANGE)

    def follow(self, departed: Departed) -> None:
        """Begin to read the road users that departed in the last step; to be called after every step."""
        for name in departed.vehicles:
            self._sumo.vehicle.subscribe(name, (*self._cars.variables, self._allowed))
        for name in departed.persons:
            self._sumo.person.subscribe(name, self._people.variables)

    def leave(self, name: str) -> None:
        """Stop reading a vehicle that is about to be removed; otherwise the next step would fail."""
        self._sumo.vehicle.unsubscribe(name)

    def read(self, known: Mapping[str, KnownState], present: Present) -> Traffic:
        """Return the road users near a crossing after the last step.

        Parameters
        ----------
        known : states of egos, used instead of SUMO's, by name
        present : road users that exist; SUMO may still name others
        """
        sumo = self._sumo
        people = {
            name: values
            for name, values in sumo.person.getAllSubscriptionResults().items()
            if name in present.persons and self._people.is_there(values)
        }
        cars = {
            name: values
            for name, values in sumo.vehicle.getAllSubscriptionResults().items()
            if name in present.vehicles and self._cars.is_there(values)
        }
        self._people.forget_absent(present)
        self._cars.forget_absent(present)
        forget_absent(self._classes, present.vehicles)
        persons = self._people.read(tuple(people), tuple(people.values()))
        vehicles = self._cars.read(tuple(cars), tuple(cars.values()), known)
        limits = np.array([values[self._allowed] for values in cars.values()], dtype=np.float64)
        near = np.flatnonzero(self._vehicle_places.hold(vehicles.front))
        names = tuple(vehicles.names[row] for row in near)
        people_near = np.flatnonzero(self._person_places.hold(persons.position))
        return Traffic(
            persons=with_signals(persons_truth(persons, people_near), Lights(self._sumo), self._crossings),
            vehicles=vehicles_truth(vehicles, near),
            acceleration=vehicles.acceleration[near],
            speed_limit=limits[near],
            vehicle_class=tuple(map(self._class_of, names)),
            is_ego=tuple(name in known for name in names),
        )

    def _class_of(self, name: str) -> str:
        found = self._classes.get(name)
        if found is None:
            found = self._classes[name] = self._sumo.vehicle.getVehicleClass(name)
        return found


class Places:
    """The ground within a distance of some lines, as a set of cells.

    Parameters
    ----------
    lines : each (n, 2) [m]
    reach : the distance [m]

    Examples
    --------
    >>> places = Places([np.array([[0.0, 0.0], [10.0, 0.0]])], 20.0)
    >>> places.hold(np.array([[5.0, 19.0], [5.0, 30.0], [-40.0, 0.0]])).tolist()
    [True, False, False]
    """

    def __init__(self, lines: Iterable[FloatArray], reach: float) -> None:
        offsets = np.arange(-np.ceil(reach / CELL), np.ceil(reach / CELL) + 1.0)
        dx, dy = np.meshgrid(offsets, offsets)
        disc = np.column_stack((dx.ravel(), dy.ravel()))[np.hypot(dx, dy).ravel() * CELL <= reach + CELL]
        points = np.unique(np.round(np.concatenate([np.zeros((0, 2)), *map(_densely, lines)]) / CELL), axis=0)
        self._cells = np.unique(_codes((points[:, None] + disc).reshape(-1, 2)))

    def hold(self, positions: FloatArray) -> NDArray[np.bool_]:
        """Return which positions are near, shape (n,); positions up to two cells farther may count too."""
        codes = _codes(np.round(positions / CELL))
        at = np.minimum(np.searchsorted(self._cells, codes), max(len(self._cells) - 1, 0))
        return self._cells[at] == codes if len(self._cells) else np.zeros(len(codes), dtype=np.bool_)


def _densely(line: FloatArray) -> FloatArray:
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))
    at = np.linspace(0.0, way[-1], int(way[-1] / CELL) + 2)
    return np.column_stack([np.interp(at, way, line[:, axis]) for axis in (0, 1)])


def _codes(cells: FloatArray) -> IntArray:
    """Return one number for each cell."""
    whole = cells.astype(np.int64)
    return np.asarray(whole[:, 0] * 2**31 + whole[:, 1])
