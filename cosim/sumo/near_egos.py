"""The road users near each ego, in the ego's route frame, computed for all egos at once.

An ego has a handful of road users near it, and a NumPy call costs more than the arithmetic on a handful of
numbers. The arrays here therefore concatenate the road users of all egos. A road user near two egos appears
twice.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import accumulate

import numpy as np

from controllers.interface import Pedestrians, Vehicles
from cosim.arrays import FloatArray, IntArray
from cosim.sumo.lane_path import PathCrossing
from cosim.sumo.path import project_all
from cosim.sumo.road_users import Cars
from cosim.sumo.surroundings import PEDESTRIAN_RADIUS, Surroundings
from cosim.sumo.view import Frame

COMES_ALONG = 0.3
"""Pedestrians who walk along the road faster than this, and than across it, are not about to cross [m/s]."""
APART = 3.0
"""If front and rear bumper are farther apart along the path than this many lengths of the vehicle, the path
leads past both sides of it."""


class NearEgos:
    """The road users near the egos at one instant.

    Parameters
    ----------
    names, frames : the egos, both in the same order
    surroundings : road users near any ego
    """

    def __init__(self, names: Sequence[str], frames: Sequence[Frame], surroundings: Surroundings) -> None:
        self._frames = frames
        self._surroundings = surroundings
        cars = [surroundings.cars_near[name] for name in names]
        persons = [surroundings.persons_near[name] for name in names]
        self.car_starts = [0, *accumulate(len(rows) for rows in cars)]
        """Row at which the vehicles of each ego begin, and the row at which the last ones end."""
        self._person_starts = [0, *accumulate(len(rows) for rows in persons)]
        self._car_rows: IntArray = _joined(cars)
        self._person_rows: IntArray = _joined(persons)
        self._cars_of_all: list[int] = self._car_rows.tolist()
        self._project(cars, persons)
        self.vehicles, self.back_along, self.back_across = self._all_vehicles()
        """The vehicles of all egos; along and across coordinates of their rear bumpers' centres [m]."""
        self._pedestrians = self._all_pedestrians()

    def cars_of(self, ego: int) -> list[int]:
        """Return the rows, in the surroundings' cars, of the vehicles near the ego of that number."""
        return self._cars_of_all[self.car_starts[ego] : self.car_starts[ego + 1]]

    def vehicles_of(self, ego: int) -> Vehicles:
        """Return the vehicles near the ego of that number."""
        them, part = self.vehicles, slice(self.car_starts[ego], self.car_starts[ego + 1])
        return Vehicles(
            them.names[part],
            them.along[part],
            them.across[part],
            them.along_speed[part],
            them.across_speed[part],
            them.acceleration[part],
            them.heading_error[part],
            them.length[part],
            them.width[part],
            them.position[part],
            them.heading[part],
        )

    def pedestrians_of(self, ego: int, crossings: Sequence[PathCrossing]) -> Pedestrians:
        """Return the pedestrians near the ego of that number; call it once.

        Parameters
        ----------
        crossings : crossings that the ego is told of
        """
        them, part = self._pedestrians, slice(self._person_starts[ego], self._person_starts[ego + 1])
        told = Pedestrians(
            them.names[part],
            them.along[part],
            them.across[part],
            them.along_speed[part],
            them.across_speed[part],
            them.radius[part],
            them.crossing[part],
            them.on_crossing[part],
            them.waiting[part],
            them.uncertainty[part],
            them.position[part],
            them.velocity[part],
        )
        if crossings and len(told):
            self._express_at_crossings(told, self._person_rows[part], crossings, self._frames[ego].origin)
        return told

    def _project(self, cars: Sequence[IntArray], persons: Sequence[IntArray]) -> None:
        """Project front bumpers, rear bumpers and persons onto the path of their ego."""
        all_cars, all_persons = self._surroundings.cars, self._surroundings.persons
        places = np.concatenate([all_cars.front, _rear_bumpers(all_cars), all_persons.position])
        fronts = len(all_cars.names)
        groups = [group for near in zip(cars, cars, persons, strict=True) for group in near]
        sizes = [len(group) for group in groups]
        kind = np.repeat(np.tile([0, 1, 2], len(cars)), sizes)
        rows = _joined(groups) + fronts * kind
        counts = [2 * len(near) + len(on_foot) for near, on_foot in zip(cars, persons, strict=True)]
        # A route round a block passes a place again: road users nearby must not end up a whole block away.
        origins = [frame.origin for frame in self._frames]
        curves = [frame.path.curve for frame in self._frames]
        along, across, heading = project_all(curves, places[rows], counts, origins)
        along = along - np.repeat(origins, counts)
        front, back, person = (np.flatnonzero(kind == number) for number in (0, 1, 2))
        self._at_front = along[front], across[front], heading[front]
        self._at_back = along[back], across[back]
        self._at_person = along[person], across[person], heading[person]

    def _all_vehicles(self) -> tuple[Vehicles, FloatArray, FloatArray]:
        rows, cars = self._car_rows, self._surroundings.cars
        along, across, path_heading = self._at_front
        velocity, length = cars.velocity[rows], cars.length[rows]
        cosine, sine = np.cos(path_heading), np.sin(path_heading)
        error = math.pi - np.mod(math.pi - (cars.heading[rows] - path_heading), 2.0 * math.pi)
        back_along, back_across = self._at_back
        parted = np.abs(back_along - along) > APART * length
        if parted.any():
            # The whole vehicle is where its front is, and does not reach over the path in between.
            back_along = np.where(parted, along - length * np.cos(error), back_along)
            back_across = np.where(parted, across - length * np.sin(error), back_across)
        vehicles = Vehicles(
            tuple(map(cars.names.__getitem__, self._cars_of_all)),
            along,
            0.5 * (across + back_across),
            velocity[:, 0] * cosine + velocity[:, 1] * sine,
            velocity[:, 1] * cosine - velocity[:, 0] * sine,
            cars.acceleration[rows],
            error,
            length,
            cars.width[rows],
            cars.front[rows],
            cars.heading[rows],
        )
        return vehicles, back_along, back_across

    def _all_pedestrians(self) -> Pedestrians:
        """Return the pedestrians of all egos as if no ego were told of any crossing."""
        rows, persons = self._person_rows, self._surroundings.persons
        along, across, heading = self._at_person
        velocity = persons.velocity[rows]
        cosine, sine = np.cos(heading), np.sin(heading)
        count = len(rows)
        return Pedestrians(
            tuple(map(persons.names.__getitem__, rows.tolist())),
            along,
            across,
            velocity[:, 0] * cosine + velocity[:, 1] * sine,
            velocity[:, 1] * cosine - velocity[:, 0] * sine,
            np.full(count, PEDESTRIAN_RADIUS),
            np.full(count, -1, dtype=np.int64),
            np.zeros(count, dtype=np.bool_),
            np.zeros(count, dtype=np.bool_),
            np.zeros(count) if persons.uncertainty is None else persons.uncertainty[rows],
            persons.position[rows],
            velocity,
        )

    def _express_at_crossings(
        self, told: Pedestrians, rows: IntArray, crossings: Sequence[PathCrossing], origin: float
    ) -> None:
        """Express pedestrians on or about to enter a crossing in the straight frame where the path meets it.

        Pedestrians who walk up to it along the road stay in the path's own frame: in a bend, they reach the
        inner side of the path long before that of the straight frame.
        """
        persons = self._surroundings.persons
        # If the path passes a crossing again, the first passage counts.
        index_of: dict[str, int] = {}
        for index, crossing in enumerate(crossings):
            index_of.setdefault(crossing.source.name, index)
        indices = [index_of.get(persons.crossing[row], -1) for row in rows.tolist()]
        concerned = set(indices) - {-1}
        if not concerned:
            return
        told.crossing[:] = indices
        position, velocity = persons.position[rows], persons.velocity[rows]
        on_crossing = persons.on_crossing[rows]
        for index in concerned:
            place = crossings[index]
            forward = np.array([math.cos(place.heading), math.sin(place.heading)])
            leftward = np.array([-forward[1], forward[0]])
            onward, across = velocity @ forward, velocity @ leftward
            comes_along = ~on_crossing & (np.abs(onward) > np.maximum(np.abs(across), COMES_ALONG))
            members = (told.crossing == index) & ~comes_along
            relative = position[members] - place.origin
            told.along[members] = place.middle - origin + relative @ forward
            told.across[members] = relative @ leftward
            told.along_speed[members] = onward[members]
            told.across_speed[members] = across[members]
        told.on_crossing[:] = (told.crossing >= 0) & on_crossing
        told.waiting[:] = (told.crossing >= 0) & ~on_crossing


def _joined(rows: Sequence[IntArray]) -> IntArray:
    return np.concatenate(rows) if rows else np.zeros(0, dtype=np.int64)


def _rear_bumpers(cars: Cars) -> FloatArray:
    back = np.empty_like(cars.front)
    back[:, 0] = cars.front[:, 0] - cars.length * np.cos(cars.heading)
    back[:, 1] = cars.front[:, 1] - cars.length * np.sin(cars.heading)
    return back
