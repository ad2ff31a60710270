"""Knowledge of pedestrians in a SUMO world: the surroundings as each ego believes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np

from controllers.interface import Body, Eyesight
from cosim.arrays import FloatArray
from cosim.sensing.eyesight import eyesight_of
from cosim.sensing.interface import Scene, Sensed, Sensing, Site
from cosim.sensing.senses import Senses
from cosim.step.plant import Plant
from cosim.sumo.network import Network
from cosim.sumo.road_users import Persons
from cosim.sumo.surroundings import PEDESTRIAN_RADIUS, Surroundings

BUILDING = "building"
"""Polygons of SUMO block the view if their type begins like this."""
_NO_SITE = Site({}, np.zeros((0, 4)), np.zeros((0, 4)))


class Knowledge:
    """Queries the sensors of all egos, unless the egos know the truth.

    The crossing that a pedestrian is on or will use next, and their size, are reported exactly for every
    pedestrian who is reported at all. Vehicles are known exactly.

    Parameters
    ----------
    sensing : the model
    sumo : module or connection
    network
    seed : of the run
    step : length of a step [s]
    look_every : number of steps between two looks

    Raises
    ------
    ValueError
        If the model's parameters do not fit the network.
    """

    def __init__(
        self, sensing: Sensing, sumo: Any, network: Network, seed: int, step: float, look_every: int
    ) -> None:
        self._step = step
        self._interval = look_every * step
        self._sensing = sensing
        self._site = _NO_SITE if sensing.exact else site_of(sumo, network)
        self._senses = None if sensing.exact else Senses(sensing, self._site, seed)
        self._eyesight: dict[Body, Eyesight | None] = {}

    def begin(self) -> None:
        """Begin an instant at which the egos' sensors look."""
        if self._senses is not None:
            self._senses.begin()

    def forget(self, ego: str) -> None:
        """Remove the sensors of an ego that is gone."""
        if self._senses is not None:
            self._senses.forget(ego)

    @property
    def now(self) -> tuple[Sensed, ...] | None:
        """Knowledge of the egos at this instant; ``None`` where they know the truth."""
        return None if self._senses is None else self._senses.now

    def eyesight(self, body: Body) -> Eyesight | None:
        """Return where an ego of that size looks from; ``None`` if it knows the truth."""
        if body not in self._eyesight:
            self._eyesight[body] = eyesight_of(self._sensing, self._site, body)
        return self._eyesight[body]

    def believed(self, egos: Mapping[str, Plant], time: float, surroundings: Surroundings) -> Surroundings:
        """Return the surroundings as the egos know them: what each ego believes of each pedestrian."""
        if self._senses is None:
            return surroundings
        told = [self._believed(self._senses, name, plant, time, surroundings) for name, plant in egos.items()]
        ends = np.cumsum([len(one.names) for one in told])
        rows = {
            name: np.arange(end - len(one.names), end)
            for name, one, end in zip(egos, told, ends.tolist(), strict=True)
        }
        return replace(surroundings, persons=_one_after_the_other(told), persons_near=rows)

    def _believed(
        self, senses: Senses, ego: str, plant: Plant, time: float, surroundings: Surroundings
    ) -> Persons:
        """Return the pedestrians that one ego knows of, as it knows them."""
        persons, rows = surroundings.persons, surroundings.persons_near[ego]
        cars, near = surroundings.cars, surroundings.cars_near[ego]
        belief = senses.look(
            Scene(
                ego,
                time,
                round(time / self._step),
                plant.x,
                plant.y,
                plant.heading,
                plant.body,
                _chosen(persons.names, rows.tolist()),
                persons.position[rows],
                persons.velocity[rows],
                np.full(len(rows), PEDESTRIAN_RADIUS),
                cars.front[near],
                cars.heading[near],
                cars.length[near],
                cars.width[near],
                self._interval,
            )
        )
        told = rows[belief.told]
        some = told.tolist()
        return Persons(
            _chosen(persons.names, some),
            belief.position[belief.told],
            belief.velocity[belief.told],
            _chosen(persons.edge, some),
            _chosen(persons.crossing, some),
            persons.on_crossing[told],
            _chosen(persons.phase, some),
            _chosen(persons.kind, some),
            belief.uncertainty[belief.told],
        )


def _one_after_the_other(persons: Sequence[Persons]) -> Persons:
    return Persons(
        tuple(chain.from_iterable(one.names for one in persons)),
        np.concatenate([np.zeros((0, 2)), *(one.position for one in persons)]),
        np.concatenate([np.zeros((0, 2)), *(one.velocity for one in persons)]),
        tuple(chain.from_iterable(one.edge for one in persons)),
        tuple(chain.from_iterable(one.crossing for one in persons)),
        np.concatenate([np.zeros(0, dtype=np.bool_), *(one.on_crossing for one in persons)]),
        tuple(chain.from_iterable(one.phase for one in persons)),
        tuple(chain.from_iterable(one.kind for one in persons)),
        np.concatenate([np.zeros(0), *(_uncertainty(one) for one in persons)]),
    )


def _uncertainty(persons: Persons) -> FloatArray:
    return np.zeros(len(persons.names)) if persons.uncertainty is None else persons.uncertainty


def site_of(sumo: Any, network: Network) -> Site:
    """Return what does not move: crossings, lanes, and the buildings of the configuration."""
    lanes = [np.hstack([lane.shape[:-1], lane.shape[1:]]) for lane in network.lanes.values()]
    crossings = {name: crossing.axis for name, crossing in network.crossings.items()}
    walls = [
        _sides(np.array([point[:2] for point in sumo.polygon.getShape(name)], dtype=np.float64))
        for name in sorted(sumo.polygon.getIDList())
        if sumo.polygon.getType(name).startswith(BUILDING)
    ]
    nothing = np.zeros((0, 4))
    return Site(crossings, np.concatenate([nothing, *lanes]), np.concatenate([nothing, *walls]))


def _sides(outline: FloatArray) -> FloatArray:
    return np.hstack([outline, np.roll(outline, -1, axis=0)])


def _chosen(texts: Sequence[str], rows: Sequence[int]) -> tuple[str, ...]:
    return tuple(texts[row] for row in rows)
