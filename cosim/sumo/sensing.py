"""Converts the surroundings into what each ego is told, in its route frame."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from controllers.interface import Body, EgoState, Eyesight, JunctionFoe, Perception, RoadAhead
from cosim.sumo.changed_limits import ChangedLimits
from cosim.sumo.driven_ego import DrivenEgo
from cosim.sumo.foes import FoeFinder
from cosim.sumo.gaps import LaneLine, extents, neighbour_gaps
from cosim.sumo.lane_path import PathCrossing
from cosim.sumo.lights import Lights
from cosim.sumo.near_egos import NearEgos
from cosim.sumo.network import Network
from cosim.sumo.road import road_ahead
from cosim.sumo.sight import looked_ahead
from cosim.sumo.surroundings import Surroundings
from cosim.sumo.view import Frame


class Perceiver:
    """Tells egos what they perceive.

    Parameters
    ----------
    sumo : module or connection
    network
    interval : time until the next plan is requested [s]
    eyesight : returns where an ego of a given size looks from
    limits : speed limits that differ from those of the network
    """

    def __init__(
        self,
        sumo: Any,
        network: Network,
        interval: float,
        eyesight: Callable[[Body], Eyesight | None],
        limits: ChangedLimits,
    ) -> None:
        self._sumo = sumo
        self._foes = FoeFinder(sumo, network)
        self._interval = interval
        self._eyesight = eyesight
        self._limits = limits

    def perceive(self, egos: Sequence[DrivenEgo], time: float, known: Surroundings) -> list[Perception]:
        """Return what each ego is told, and store its frame with the ego.

        Parameters
        ----------
        egos
        time : now [s]
        known : the road users near any ego, as the egos know them
        """
        if not egos:
            return []
        frames = [Frame(ego.plant, ego.track) for ego in egos]
        for ego, frame in zip(egos, frames, strict=True):
            ego.frame = frame
        near = NearEgos([ego.name for ego in egos], frames, known)
        lights = Lights(self._sumo)
        self._foes.begin(known.cars, time)
        crossings = [frame.crossings() for frame in frames]
        roads: list[RoadAhead] = []
        lines: list[dict[int, LaneLine]] = []
        for number, ego in enumerate(egos):
            road, lanes = self._road(
                ego, frames[number], crossings[number], near.cars_of(number), known, lights
            )
            roads.append(road)
            lines.append(lanes)
        gaps = neighbour_gaps(
            near.vehicles,
            extents(near.vehicles, near.back_along, near.back_across),
            near.car_starts,
            lines,
            [(frame.back, frame.front) for frame in frames],
        )
        return [
            Perception(
                self._state(ego, frames[number], time),
                near.pedestrians_of(number, crossings[number]),
                near.vehicles_of(number),
                gaps[number],
                roads[number],
                self._eyesight(ego.plant.body),
            )
            for number, ego in enumerate(egos)
        ]

    def _road(
        self,
        ego: DrivenEgo,
        frame: Frame,
        crossings: Sequence[PathCrossing],
        cars: Sequence[int],
        known: Surroundings,
        lights: Lights,
    ) -> tuple[RoadAhead, dict[int, LaneLine]]:
        signals, junctions = frame.signals(), frame.junctions(looked_ahead(ego.plant.speed))
        foes: list[JunctionFoe] = []
        if junctions and cars:
            foes = self._foes.find(ego.name, frame.origin, junctions, cars, known.cars, lights)
        return road_ahead(frame, ego.track, crossings, signals, lights, foes, ego.own_limit, self._limits.now)

    def _state(self, ego: DrivenEgo, frame: Frame, time: float) -> EgoState:
        plant = ego.plant
        return EgoState(
            ego.name,
            time,
            plant.x,
            plant.y,
            plant.heading,
            frame.across,
            frame.heading_error,
            plant.speed,
            plant.acceleration,
            plant.steering,
            plant.body,
            plant.drive,
            self._interval,
        )
