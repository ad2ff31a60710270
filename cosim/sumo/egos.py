"""Where egos come from: trips added for them, vehicles of the demand by id, or a share of its cars."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cosim.errors import InputError, SimulationError
from cosim.sumo.network import Network
from cosim.sumo.route import Route
from sumo_scenarios.model import Egos
from sumo_scenarios.vehicle_names import taken_names

EGO_TYPE = "cosim_ego"
PASSENGER = "passenger"
INSERTION_PATIENCE = 60.0
"""If an ego finds no place on its first edge for this long, that is an error [s]."""
ROADLESS_CLASSES = frozenset(
    {"pedestrian", "tram", "rail_urban", "rail", "rail_electric", "rail_fast", "ship", "container"}
    | {"cable_car", "subway", "aircraft", "wheelchair", "drone"}
)
"""Vehicle classes that cannot be driven by steering and braking on a road."""


@dataclass(slots=True)
class Trip:
    """A trip added for an ego that has yet to appear."""

    name: str
    route: Route
    depart: float
    """Simulated time at which it is due [s]."""
    asked: bool = False
    """Whether SUMO has been asked to insert it."""


class EgoSources:
    """Chooses which departing vehicles become egos, and inserts the trips added for egos.

    Parameters
    ----------
    egos : what the scenario says
    network
    seed : seed of the draw for the share
    start : simulated time from which egos may appear [s]
    needed : whether there has to be an ego

    Raises
    ------
    InputError
        If a route is not possible, or there is no road for cars.
    """

    def __init__(self, egos: Egos, network: Network, seed: int, start: float, needed: bool = True) -> None:
        self._egos = egos
        self._seed = seed
        self._needed = needed
        self._start = start
        self._wanted = set(egos.vehicles)
        self._cars_seen = 0
        self._departed_seen = 0
        self._some_departed: list[str] = []
        if needed and not egos.routes and not egos.vehicles and not egos.share:
            raise InputError("no ego: expected a route, a vehicle id or a share of the passenger cars")
        roads = network.roads
        if not egos.vehicles and not any(network.allowed_lanes(edge, PASSENGER) for edge in roads):
            raise InputError(f"the network has no lane for passenger cars on any of its {len(roads)} edges")
        routes = [Route(network, edges, PASSENGER) for edges in egos.routes]
        count = max(egos.count, 1) if routes else 0
        first = start + egos.first_depart_s
        self.trips = [
            Trip(f"ego_{number}", routes[number % len(routes)], first + number * egos.headway_s)
            for number in range(count)
        ]

    @property
    def ends(self) -> bool:
        """Whether no further ego can appear; never true with a share, because demand may still come."""
        return not self._egos.share and not self.trips and not self._wanted

    def check(self, sumo: Any, demand: Sequence[Path] = ()) -> None:
        """Check the egos against the running simulation, before its first step.

        Parameters
        ----------
        sumo : module or connection
        demand : files of the demand, of which SUMO has read the beginning only

        Raises
        ------
        InputError
            If the vehicle type does not exist, or the name of an ego is taken.
        """
        wanted = self._egos.vehicle_type
        known = sumo.vehicletype.getIDList()
        if self.trips and wanted and wanted not in known:
            names = ", ".join(name for name in sorted(known) if not name.startswith("DEFAULT_"))
            raise InputError(f'no vehicle type "{wanted}" for the egos; the scenario has {names}')
        own = {trip.name for trip in self.trips}
        files = taken_names(demand, own)
        taken = files.keys() | (set(sumo.vehicle.getLoadedIDList()) & own)
        if taken:
            name = min(taken)
            place = f" in {files[name].name}" if name in files else ""
            raise InputError(
                f'the demand already has a vehicle "{name}"{place}, the name of an ego; '
                "give the vehicle another id"
            )

    def insert(self, sumo: Any, time: float) -> None:
        """Ask SUMO to insert the trips that are due.

        Raises
        ------
        SimulationError
            If a trip has found no place for too long.
        """
        for trip in self.trips:
            if trip.asked and time > trip.depart + INSERTION_PATIENCE:
                edge = trip.route.edges[0]
                raise SimulationError(
                    f'ego "{trip.name}" could not be inserted on edge "{edge}" for {INSERTION_PATIENCE:g} s: '
                    f"{sumo.edge.getLastStepVehicleNumber(edge)} vehicles are on it, mean speed "
                    f"{sumo.edge.getLastStepMeanSpeed(edge):.1f} m/s; expected a free place"
                )
            if not trip.asked and time >= trip.depart - 1e-9:
                self._ask(sumo, trip)

    def _ask(self, sumo: Any, trip: Trip) -> None:
        kind = self._egos.vehicle_type
        if not kind:
            kind = EGO_TYPE
            if kind not in sumo.vehicletype.getIDList():
                _add_ego_type(sumo)
        route = f"{trip.name}_route"
        sumo.route.add(route, trip.route.edges)
        sumo.vehicle.add(
            trip.name,
            route,
            typeID=kind,
            departLane=self._egos.depart_lane,
            departPos="base",
            departSpeed=self._egos.depart_speed,
        )
        trip.asked = True

    def choose(self, sumo: Any, departed: Sequence[str], time: float) -> list[str]:
        """Return which of the vehicles that have just departed are egos.

        Raises
        ------
        InputError
            If a vehicle requested as an ego cannot be driven on a road, or is a taxi.
        """
        chosen = []
        own = {trip.name for trip in self.trips if trip.asked}
        self._departed_seen += len(departed)
        self._some_departed += departed[: max(0, 5 - len(self._some_departed))]
        for name in departed:
            if name in own:
                self.trips = [trip for trip in self.trips if trip.name != name]
                chosen.append(name)
            elif name in self._wanted:
                self._wanted.discard(name)
                kind = sumo.vehicle.getVehicleClass(name)
                if kind in ROADLESS_CLASSES:
                    raise InputError(f'vehicle "{name}" is of class {kind}; an ego has to drive on a road')
                if _is_taxi(sumo, name):
                    raise InputError(
                        f'vehicle "{name}" is a taxi, whose way SUMO decides anew for each passenger; '
                        "expected a vehicle that drives to its own destination"
                    )
                chosen.append(name)
            elif self._egos.share and is_private_car(sumo, name):
                self._cars_seen += 1
                if time > self._start and drawn(self._seed, name) < self._egos.share:
                    chosen.append(name)
        return chosen

    def is_of_share(self, name: str) -> bool:
        """Return whether a vehicle became an ego by the share only, so that another would do as well."""
        return name not in self._egos.vehicles and bool(self._egos.share)

    def check_seen(self, any_ego: bool, end: float) -> None:
        """Check at the end of a run that all expected egos appeared.

        Raises
        ------
        SimulationError
            If a requested vehicle never departed, or an ego is needed and the share produced none.
        """
        if self._wanted:
            some = ", ".join(f'"{name}"' for name in self._some_departed) or "none"
            raise SimulationError(
                f'vehicle "{min(self._wanted)}" did not depart until {end:g} s; '
                f"{self._departed_seen} vehicles did, for instance {some}"
            )
        if self._needed and self._egos.share and not any_ego:
            seen = f"{self._cars_seen} passenger cars departed until {end:g} s"
            told = (
                f"{seen}, and none of them was drawn with a share of {self._egos.share:g}; expected a larger "
                "share, another seed or more time"
                if self._cars_seen
                else f"{seen}, of {self._departed_seen} vehicles; expected cars of which a share can be egos"
            )
            raise SimulationError(f"no ego: {told}")


def is_private_car(sumo: Any, name: str) -> bool:
    """Return whether a vehicle is a car on a trip of its own, not one that fetches or carries passengers."""
    vehicle = sumo.vehicle
    if vehicle.getVehicleClass(name) != PASSENGER or vehicle.getPersonNumber(name) > 0:
        return False
    return not _is_taxi(sumo, name)


def _is_taxi(sumo: Any, name: str) -> bool:
    """Return whether SUMO sends a vehicle to passengers who call it."""
    return bool(sumo.vehicle.getParameter(name, "has.taxi.device") == "true")


def drawn(seed: int, name: str) -> float:
    """Return a number in [0, 1) that depends only on the seed and the vehicle, not on the controller."""
    digest = hashlib.sha256(f"{seed}:{name}".encode()).digest()
    return int.from_bytes(digest[:8], "big") / 2.0**64


def _add_ego_type(sumo: Any) -> None:
    types = sumo.vehicletype
    types.copy("DEFAULT_VEHTYPE", EGO_TYPE)
    types.setVehicleClass(EGO_TYPE, PASSENGER)
    types.setLength(EGO_TYPE, 4.5)
    types.setWidth(EGO_TYPE, 1.8)
    types.setMinGap(EGO_TYPE, 2.5)
    # The ego desires the same speed in every run; for other vehicles, SUMO draws speed factors.
    types.setSpeedFactor(EGO_TYPE, 1.0)
    types.setSpeedDeviation(EGO_TYPE, 0.0)
