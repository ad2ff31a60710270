"""Recorded vehicles: at each step, SUMO has them where they were recorded; they react to nobody."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from sumo_scenarios.recorded_vehicles import RecordedVehicle

ON_A_LANE, ANYWHERE = 0, 2
"""Values of ``keepRoute`` of moveToXY. ``ANYWHERE`` takes the position as it is. With the sublane model,
``ON_A_LANE`` does so too, and puts the vehicle on the nearest lane. There, ``ANYWHERE`` may match a lane
beside the vehicle, for instance where lanes end in a bend, and take the vehicle off that lane: SUMO 1.28 then
crashes if another vehicle drives on the same edge. ``ANYWHERE`` is safe where there is no lane at all."""
DEFAULT_TYPE = "DEFAULT_VEHTYPE"
IGNORES_EVERYTHING = 0
"""Speed mode and lane-change mode in which a vehicle reacts to nothing."""


class RecordedVehicles:
    """Moves recorded vehicles.

    Parameters
    ----------
    vehicles : by name
    begin : simulated time that is time 0 of the recording [s]
    """

    def __init__(self, vehicles: Mapping[str, RecordedVehicle], begin: float) -> None:
        self._to_come = sorted(vehicles.values(), key=lambda one: (float(one.motion[0, 0]), one.name))
        self._begin = begin
        self._there: dict[str, RecordedVehicle] = {}
        self._routes: set[str] = set()
        self._types: set[str] = set()

    @property
    def names(self) -> frozenset[str]:
        """Names of the vehicles that are on the road."""
        return frozenset(self._there)

    def move(self, sumo: Any, until: float, remove: Callable[[str], None]) -> None:
        """Tell SUMO where each recorded vehicle is after the step.

        Parameters
        ----------
        sumo : module or connection
        until : simulated time after the step [s]
        remove : takes a vehicle off the road
        """
        time = until - self._begin
        for name in [name for name, one in self._there.items() if time > one.motion[-1, 0] + 1e-9]:
            del self._there[name]
            if name in sumo.vehicle.getIDList():
                remove(name)
        while self._to_come and self._to_come[0].motion[0, 0] <= time + 1e-9:
            self._add(sumo, self._to_come.pop(0))
        for name, one in self._there.items():
            x, y, heading, speed = _state(one, time)
            angle = (90.0 - math.degrees(heading)) % 360.0
            _place(sumo, name, x, y, angle)
            sumo.vehicle.setSpeed(name, speed)

    def _add(self, sumo: Any, one: RecordedVehicle) -> None:
        route, kind = f"recorded_{one.edge}", f"recorded_{one.vehicle_class}_{one.length:g}_{one.width:g}"
        if route not in self._routes:
            sumo.route.add(route, [one.edge])
            self._routes.add(route)
        if kind not in self._types:
            sumo.vehicletype.copy(DEFAULT_TYPE, kind)
            sumo.vehicletype.setVehicleClass(kind, one.vehicle_class)
            sumo.vehicletype.setLength(kind, one.length)
            sumo.vehicletype.setWidth(kind, one.width)
            self._types.add(kind)
        sumo.vehicle.add(one.name, route, typeID=kind, departLane="best", departPos="base")
        sumo.vehicle.setSpeedMode(one.name, IGNORES_EVERYTHING)
        sumo.vehicle.setLaneChangeMode(one.name, IGNORES_EVERYTHING)
        self._there[one.name] = one


def _place(sumo: Any, name: str, x: float, y: float, angle: float) -> None:
    if float(sumo.simulation.getOption("lateral-resolution")) > 0.0:
        try:
            sumo.vehicle.moveToXY(name, "", -1, x, y, angle, ON_A_LANE)
            return
        except sumo.TraCIException:  # there is no road within 100 m
            pass
    sumo.vehicle.moveToXY(name, "", -1, x, y, angle, ANYWHERE)


def _state(one: RecordedVehicle, time: float) -> tuple[float, float, float, float]:
    """Return x, y, heading and speed at a time: interpolated, but the heading is of the nearest sample."""
    times = one.motion[:, 0]
    x, y, speed = (float(np.interp(time, times, one.motion[:, column])) for column in (1, 2, 4))
    at = int(np.argmin(np.abs(times - time)))
    return x, y, float(one.motion[at, 3]), speed
