"""Scripted pedestrians in a SUMO world: they walk, egos perceive them, SUMO's drivers yield to them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from controllers.interface import CrossingKind, PedestrianPhase
from cosim.errors import InputError, SimulationError
from cosim.pedestrians.behaviour import RoadUser, Scene, State
from cosim.pedestrians.population import Population, Scripted
from cosim.step.plant import Plant
from cosim.sumo.ground import Ground, Spot
from cosim.sumo.lights import Lights
from cosim.sumo.network import Network
from cosim.sumo.road_users import Persons
from cosim.sumo.sight import sight
from cosim.sumo.surroundings import Surroundings
from cosim.sumo.track import Track
from cosim.sumo.traffic_near import TrafficNear, way_along
from cosim.sumo.yielding import STEPPING_OUT, Seen, Yielding
from sumo_scenarios.pedestrian_tables import PedestrianTable

WALKING = 0.05
"""Below this speed, a pedestrian counts as standing [m/s]."""


class ScriptedPersons:
    """All scripted pedestrians of a run.

    Parameters
    ----------
    tables : the scenario's tables of pedestrians
    network
    seed : seed of the run
    begin, end : simulated time of the end of the warm-up and of the end of the run [s]

    Raises
    ------
    InputError
        If a place does not exist, or a trajectory leaves the network.
    """

    def __init__(
        self, tables: Sequence[PedestrianTable], network: Network, seed: int, begin: float, end: float
    ) -> None:
        self._network = network
        self._seen_from = sight(network).persons
        self._begin = begin
        self._any = bool(tables)
        self._ground = Ground(network) if tables else None
        try:
            self._population = Population(tables, self._ground, seed, begin, end) if self._ground else None
        except ValueError as error:
            raise InputError(f"[[pedestrians]]: {error}") from error
        self._to_come: list[Scripted] = list(self._population.fixed) if self._population else []
        self._there: dict[str, tuple[Scripted, State]] = {}
        self._spots: dict[str, tuple[State, Spot, PedestrianPhase]] = {}
        """Spots as last looked up; every step needs them twice."""
        self._egos_seen: set[str] = set()
        self._sumo: Any = None

    def join(self, sumo: Any, step: float) -> None:
        """Join a simulation that has been started.

        Parameters
        ----------
        sumo : module or connection
        step : length of a step [s]
        """
        self._sumo = sumo
        self._step = step
        self._traffic = TrafficNear(sumo, self._network)
        self._yielding = Yielding(sumo, self._traffic, step)

    def walk(self, time: float, egos: Sequence[RoadUser], driven: Collection[str]) -> None:
        """Move the pedestrians to where they are after the coming step, and make SUMO's drivers yield.

        Parameters
        ----------
        time : now [s]
        egos : the egos as they are now
        driven : vehicles, among the egos or not, that SUMO does not drive
        """
        if not self._any or time < self._begin - 1e-9:
            return
        near = self._traffic.read(list(self._there))
        lights = Lights(self._sumo)
        scene = self._scene(time, egos, lights)
        seen = {name: self._seen(state, time, one, lights) for name, (one, state) in self._there.items()}
        self._yielding.hold({name: one for name, one in seen.items() if one is not None}, near, driven)
        until = time + self._step
        own = {ego.name for ego in egos}
        for name, (one, state) in list(self._there.items()):
            after = one.behaviour.next(state, _with_others(scene, near[name], own), until)
            if after is None:
                del self._there[name]
                self._traffic.leave(name)
                continue
            self._there[name] = (one, after)
            self._traffic.move(name, after.x, after.y)
        self._let_in(scene, until, own)

    @property
    def any(self) -> bool:
        """Whether the scenario has scripted pedestrians."""
        return self._any

    def forget_vehicle(self, name: str) -> None:
        """Leave a vehicle alone from now on: a controller has taken it over, or it is gone."""
        if self._any:
            self._yielding.forget(name)

    def among(
        self, surroundings: Surroundings, places: Mapping[str, tuple[float, float]], time: float
    ) -> Surroundings:
        """Return the surroundings with the scripted pedestrians near any ego.

        Parameters
        ----------
        surroundings : the surroundings as SUMO knows them
        places : front bumpers of the egos [m]
        time : now [s]
        """
        if not self._there:
            return surroundings
        at = {name: (state.x, state.y) for name, (_, state) in self._there.items()}
        table = np.array(list(at.values()), dtype=np.float64).reshape(-1, 2)
        first = len(surroundings.persons.names)
        near: dict[str, NDArray[np.int64]] = {}
        any_near = np.zeros(len(table), dtype=bool)
        for ego, place in places.items():
            within = np.hypot(table[:, 0] - place[0], table[:, 1] - place[1]) <= self._seen_from
            any_near |= within
            near[ego] = np.flatnonzero(within)
        names = [name for name, found in zip(at, any_near.tolist(), strict=True) if found]
        taken = set(names) & set(surroundings.persons.names)
        if taken:
            raise SimulationError(
                f"the demand has a person '{min(taken)}', the name of a scripted pedestrian; rename the row"
            )
        row_of = np.cumsum(any_near) - 1 + first
        persons_near = {
            ego: np.concatenate([rows, row_of[near[ego]]]) for ego, rows in surroundings.persons_near.items()
        }
        merged = self._merged(surroundings.persons, names, time)
        return replace(surroundings, persons=merged, persons_near=persons_near)

    def _merged(self, known: Persons, names: Sequence[str], time: float) -> Persons:
        chosen = [self._there[name] for name in names]
        spots = [self._spot(one, state, time) for one, state in chosen]
        motion = np.array([state.motion for _, state in chosen], dtype=np.float64).reshape(-1, 4)
        phases = tuple(phase.value for _, phase in spots)
        return Persons(
            (*known.names, *names),
            np.concatenate([known.position, motion[:, :2]]),
            np.concatenate([known.velocity, motion[:, 2:]]),
            (*known.edge, *(spot.edge for spot, _ in spots)),
            (*known.crossing, *(spot.crossing for spot, _ in spots)),
            np.concatenate(
                [
                    known.on_crossing,
                    np.array([p == PedestrianPhase.CROSSING.value for p in phases], dtype=bool),
                ]
            ),
            (*known.phase, *phases),
            (*known.kind, *(one.kind for one, _ in chosen)),
        )

    def _spot(self, one: Scripted, state: State, time: float) -> tuple[Spot, PedestrianPhase]:
        """Return a pedestrian's place, the crossing they are on or will use next, and their phase."""
        assert self._ground is not None
        known = self._spots.get(one.name)
        if known is not None and known[0] is state:
            return known[1], known[2]
        here, phase = self._ground.at(state.x, state.y), PedestrianPhase.WALKING
        if here.crossing:
            phase = PedestrianPhase.CROSSING
        elif ahead := self._ground.first_crossing(one.behaviour.onward(state, time)):
            here, phase = Spot(here.edge, ahead, here.on_road), PedestrianPhase.WAITING
        self._spots[one.name] = (state, here, phase)
        return here, phase

    def _seen(self, state: State, time: float, one: Scripted, lights: Lights) -> Seen | None:
        """Return a pedestrian as drivers see them; ``None`` for one who stands beside the road."""
        spot, phase = self._spot(one, state, time)
        stands = abs(state.x_speed) + abs(state.y_speed) < WALKING
        crossing = self._network.crossings.get(spot.crossing)
        if crossing is None or not (
            lights.kind(crossing) is CrossingKind.ZEBRA or lights.pedestrians_have_green(crossing)
        ):
            return Seen(*state.motion) if spot.on_road or not stands else None
        x_speed, y_speed = state.x_speed, state.y_speed
        if phase is PedestrianPhase.WAITING and stands:
            onward = one.behaviour.onward(state, time)
            ahead = onward[-1] - onward[0]
            length = float(np.hypot(*ahead))
            if length > 0.0:
                x_speed, y_speed = (STEPPING_OUT * ahead / length).tolist()
        return Seen(state.x, state.y, x_speed, y_speed, True, 0.5 * crossing.width)

    def _scene(self, time: float, egos: Sequence[RoadUser], lights: Lights) -> Scene:
        assert self._population is not None
        crossings = self._network.crossings
        green = {name: lights.pedestrians_have_green(crossings[name]) for name in self._population.signals}
        return Scene(time, egos, (), {name: shows for name, shows in green.items() if shows is not None})

    def _let_in(self, scene: Scene, until: float, own: Collection[str]) -> None:
        """Add the pedestrians who appear by the end of the step; ``own`` are the names of the egos."""
        assert self._population is not None
        for ego in scene.egos:
            if ego.name not in self._egos_seen:
                self._egos_seen.add(ego.name)
                self._to_come += self._population.for_ego(ego.name)
        waiting = []
        later = replace(scene, time=until)
        for one in self._to_come:
            appears = one.behaviour.first(later)
            if appears is None:
                waiting.append(one)
                continue
            # A pedestrian may set off within the step in which they appear, once they have looked around.
            near = self._traffic.around(appears.x, appears.y)
            state = one.behaviour.next(appears, _with_others(scene, near, own), until)
            if state is not None:
                self._there[one.name] = (one, state)
                self._traffic.watch(one.name, state.x, state.y)
        self._to_come = waiting


def _with_others(scene: Scene, near: Sequence[RoadUser], own: Collection[str]) -> Scene:
    """Return a scene in which a pedestrian also sees the vehicles near them that are no egos."""
    return replace(scene, others=[vehicle for vehicle in near if vehicle.name not in own])


def road_user(name: str, plant: Plant, track: Track) -> RoadUser:
    """Return an ego as pedestrians see it."""
    way = way_along(track.path.curve, *plant.front, track.along)
    body = plant.body
    return RoadUser(name, *plant.front, plant.heading, plant.speed, body.length, body.width, way)
