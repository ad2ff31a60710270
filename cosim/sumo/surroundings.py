"""Road users near the egos: read from SUMO once per step, as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosim.arrays import IntArray
from cosim.sumo.network import Network
from cosim.sumo.present import Present
from cosim.sumo.road_users import CarReader, Cars, KnownState, PersonReader, Persons, sumo_constant
from cosim.sumo.sight import sight

PEDESTRIAN_RADIUS = 0.25
"""Assumed radius of a pedestrian, see docs/conventions.md [m]."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """All road users near any ego at one instant, and the egos that each of them is near."""

    persons: Persons
    cars: Cars
    persons_near: Mapping[str, IntArray]
    """By ego: rows of ``persons``."""
    cars_near: Mapping[str, IntArray]
    """By ego: rows of ``cars``, without the ego itself."""


class Observer:
    """Reads the surroundings of egos by context subscriptions.

    SUMO merges the results for persons and vehicles of one context by their ids. Therefore the two ask for
    different variables: a two-dimensional position belongs to a person and a three-dimensional one to a
    vehicle. One id may be both.
    """

    def __init__(self, sumo: Any, network: Network, step: float) -> None:
        self._sumo = sumo
        self._people = PersonReader(sumo, network, step)
        self._cars = CarReader(sumo, step)
        self._sight = sight(network)

    def follow(self, ego: str) -> None:
        """Begin to look around a vehicle."""
        sumo = self._sumo
        vehicle = sumo.vehicle
        persons = sumo_constant(sumo, "CMD_GET_PERSON_VARIABLE")
        cars = sumo_constant(sumo, "CMD_GET_VEHICLE_VARIABLE")
        vehicle.subscribeContext(ego, persons, self._sight.persons, self._people.variables)
        vehicle.subscribeContext(ego, cars, self._sight.vehicles, self._cars.variables)

    def leave(self, ego: str) -> None:
        """Stop looking around a vehicle that is still on the road."""
        sumo = self._sumo
        for name, reach in (
            ("CMD_GET_PERSON_VARIABLE", self._sight.persons),
            ("CMD_GET_VEHICLE_VARIABLE", self._sight.vehicles),
        ):
            sumo.vehicle.unsubscribeContext(ego, sumo_constant(sumo, name), reach)

    def read(self, egos: Sequence[str], known: Mapping[str, KnownState], present: Present) -> Surroundings:
        """Return the road users near these egos after the last step.

        Parameters
        ----------
        egos : names of the egos
        known : states of vehicles, used instead of SUMO's, by name
        present : road users that exist; SUMO may still name others
        """
        sumo = self._sumo
        person_rows: dict[str, int] = {}
        car_rows: dict[str, int] = {}
        found_persons: list[Mapping[int, Any]] = []
        found_cars: list[Mapping[int, Any]] = []
        persons_near: dict[str, IntArray] = {}
        cars_near: dict[str, IntArray] = {}
        for ego in egos:
            near_persons: list[int] = []
            near_cars: list[int] = []
            for name, values in sumo.vehicle.getContextSubscriptionResults(ego).items():
                if name in present.persons and self._people.is_there(values):
                    row = person_rows.get(name)
                    if row is None:
                        row = person_rows[name] = len(found_persons)
                        found_persons.append(values)
                    near_persons.append(row)
                if name in present.vehicles and self._cars.is_there(values):
                    row = car_rows.get(name)
                    if row is None:
                        row = car_rows[name] = len(found_cars)
                        found_cars.append(values)
                    if name != ego:
                        near_cars.append(row)
            persons_near[ego] = np.array(near_persons, dtype=np.int64)
            cars_near[ego] = np.array(near_cars, dtype=np.int64)
        self._people.forget_absent(present)
        self._cars.forget_absent(present)
        return Surroundings(
            self._people.read(tuple(person_rows), found_persons),
            self._cars.read(tuple(car_rows), found_cars, known),
            persons_near,
            cars_near,
        )
