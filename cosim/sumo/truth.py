"""Converts what was read from SUMO into what the judge is told: road users as they really are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from cosim.arrays import IntArray
from cosim.step.world import PersonsTruth, VehiclesTruth
from cosim.sumo.lights import Lights
from cosim.sumo.network import NetCrossing
from cosim.sumo.road_users import Cars, Persons
from cosim.sumo.surroundings import PEDESTRIAN_RADIUS


def persons_truth(persons: Persons, rows: IntArray) -> PersonsTruth:
    """Return the pedestrians in some rows as they really are."""
    return PersonsTruth(
        names=_of(persons.names, rows),
        x=persons.position[rows, 0],
        y=persons.position[rows, 1],
        x_speed=persons.velocity[rows, 0],
        y_speed=persons.velocity[rows, 1],
        radius=np.full(len(rows), PEDESTRIAN_RADIUS),
        place=_of(persons.edge, rows),
        crossing=tuple(persons.crossing[row] or None for row in rows),
        phase=_of(persons.phase, rows),
        kind=_of(persons.kind, rows),
    )


def with_signals(persons: PersonsTruth, lights: Lights, crossings: Mapping[str, NetCrossing]) -> PersonsTruth:
    """Return the pedestrians with the light of the crossing that each is on or comes to."""

    def signal(name: str | None) -> str | None:
        green = None if name is None else lights.pedestrians_have_green(crossings[name])
        return None if green is None else "green" if green else "red"

    return replace(persons, signal=tuple(map(signal, persons.crossing)))


def vehicles_truth(cars: Cars, rows: IntArray) -> VehiclesTruth:
    """Return the vehicles in some rows as they really are."""
    return VehiclesTruth(
        names=_of(cars.names, rows),
        x=cars.front[rows, 0],
        y=cars.front[rows, 1],
        heading=cars.heading[rows],
        speed=cars.speed[rows],
        length=cars.length[rows],
        width=cars.width[rows],
        place=_of(cars.lane, rows),
        kind=_of(cars.kind, rows),
    )


def _of(values: tuple[str, ...], rows: IntArray) -> tuple[str, ...]:
    return tuple(values[row] for row in rows)
