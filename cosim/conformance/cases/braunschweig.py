"""Cases on a real intersection that ships with SUMO, with signals, trucks, bicycles and pedestrians.

A first run records some cars of the demand while SUMO drives them. A second run takes over the same cars and
drives them along their recorded positions at the same times, so that the traffic around them stays the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cosim.conformance.case import Case, Values
from cosim.conformance.ride import Driver, Moved
from cosim.conformance.stage import COLLISION_OPTIONS, OPTIONS, pose_of, sumo_home
from cosim.conformance.track import Pose
from cosim.sumo.connection import start
from cosim.sumo.lanes import Lanes
from cosim.sumo.placement import Executed, Placement

STEP = 0.05
STEPS = 1200
SHORTEST = 200
"""Only cars seen for more than this many steps are taken over."""
EVERY = 3
"""One in this many of these cars becomes an ego."""


@dataclass(frozen=True, slots=True)
class Recorded:
    """A car as SUMO drove it, from its first step on the road."""

    first: int
    poses: tuple[Pose, ...]
    lanes: tuple[str, ...]
    route: tuple[str, ...]


class NativeEverywhere:
    """A driver that uses ``setSpeed`` and ``changeSublane`` even in junctions and across lane ends."""

    def __init__(self, sumo: Any, step: float) -> None:
        self._sumo = sumo
        self._step = step
        self._lanes = Lanes(sumo)
        self._parameters = Placement(sumo, step)

    def take_over(self, name: str) -> None:
        """Begin to drive."""
        self._parameters.take_over(name)

    def drive(self, name: str, front_x: float, front_y: float, heading: float, speed: float) -> None:
        """Say where the vehicle has to be after the next step."""
        vehicle = self._sumo.vehicle
        lane = self._lanes.shape(vehicle.getLaneID(name))
        place = lane.place(front_x, front_y)
        ahead = (place.along * lane.scale - vehicle.getLanePosition(name)) / self._step
        vehicle.setSpeed(name, min(max(ahead, 0.0), 2.0 * speed + 1.0))
        vehicle.changeSublane(name, place.across - vehicle.getLateralLanePosition(name))

    def executed(self, name: str) -> Executed:
        """Return the vehicle's position, speed and lane in SUMO."""
        vehicle = self._sumo.vehicle
        x, y = vehicle.getPosition(name)
        return Executed(x, y, vehicle.getSpeed(name), vehicle.getLaneID(name))


@contextmanager
def _running() -> Iterator[Any]:
    configuration = sumo_home() / "tools" / "game" / "fokr_bs_demo.sumocfg"
    options = ["--configuration-file", str(Path(configuration)), "--lateral-resolution", "0.4"]
    connection = start([*options, *OPTIONS, *COLLISION_OPTIONS])
    try:
        yield connection.sumo
    finally:
        connection.close()


def _record() -> dict[str, Recorded]:
    found: dict[str, tuple[int, list[Pose], list[str], tuple[str, ...]]] = {}
    with _running() as sumo:
        for number in range(STEPS):
            sumo.simulationStep()
            for name in sumo.vehicle.getIDList():
                if name not in found:
                    if sumo.vehicle.getVehicleClass(name) != "passenger":
                        continue
                    found[name] = (number, [], [], sumo.vehicle.getRoute(name))
                found[name][1].append(pose_of(sumo, name))
                found[name][2].append(sumo.vehicle.getLaneID(name))
    long = [name for name, row in found.items() if len(row[1]) > SHORTEST]
    return {
        name: Recorded(found[name][0], tuple(found[name][1]), tuple(found[name][2]), found[name][3])
        for name in long[::EVERY]
    }


def _weave(pose: Pose, number: int, amplitude: float) -> Pose:
    """Return the pose shifted sideways, alternately to the left and to the right."""
    aside = amplitude * math.sin(0.4 * number * STEP)
    return pose._replace(x=pose.x - aside * math.sin(pose.heading), y=pose.y + aside * math.cos(pose.heading))


def _replay(egos: dict[str, Recorded], make: Callable[[Any], Driver], amplitude: float) -> dict[str, float]:
    steps = mismatched = lost = routes = 0
    error = 0.0
    driven: set[str] = set()
    with _running() as sumo:
        driver = make(sumo)
        for number in range(STEPS):
            present = set(sumo.vehicle.getIDList())
            now: dict[str, tuple[Pose, str]] = {}
            for name, car in egos.items():
                index = number - car.first
                if name not in present or index <= 0:
                    continue
                if index >= len(car.poses):
                    sumo.vehicle.remove(name)
                    continue
                if name not in driven:
                    driver.take_over(name)
                    driven.add(name)
                pose = _weave(car.poses[index], index, amplitude)
                driver.drive(name, *pose)
                now[name] = (pose, car.lanes[index])
            sumo.simulationStep()
            for name in set(sumo.vehicle.getIDList()) & now.keys():
                pose, lane = now[name]
                found = driver.executed(name)
                steps += 1
                error = max(error, math.dist(found[:2], pose[:2]))
                mismatched += found.lane != lane
                lost += not found.lane
                left = sumo.vehicle.getRoute(name)[sumo.vehicle.getRouteIndex(name) :]
                routes += not left or egos[name].route[-len(left) :] != left
    return {
        "egos": len(driven),
        "ego_steps": steps,
        "error_m": error,
        "lane_mismatch_percent": 100.0 * mismatched / max(1, steps),
        "steps_off_lanes": lost,
        "steps_with_changed_route": routes,
    }


def _city(make: Callable[[Any], Driver]) -> Values:
    """Drive exactly as recorded (to compare lanes and routes) and weaving by 0.5 m (positions and routes)."""
    egos = _record()
    straight, weaving = _replay(egos, make, 0.0), _replay(egos, make, 0.5)
    return {
        "egos": straight["egos"],
        "ego_steps": straight["ego_steps"],
        "error_m": max(straight["error_m"], weaving["error_m"]),
        "lane_mismatch_percent": straight["lane_mismatch_percent"],
        "steps_with_changed_route": straight["steps_with_changed_route"]
        + weaving["steps_with_changed_route"],
    }


def _off_road(keep_route: int) -> Values:
    """Weave by 4 m, over kerbs and medians."""
    return _replay(_record(), lambda sumo: Moved(sumo, keep_route=keep_route), 4.0)


CASES = (
    Case(
        key="braunschweig",
        name="Hybrid is exact on the lanes of a real intersection and keeps lane and route",
        shows="bends, signals, many short lanes, traffic of all kinds, several egos at once",
        claim=lambda: _city(lambda sumo: Placement(sumo, STEP)),
        control=lambda: _city(lambda sumo: NativeEverywhere(sumo, STEP)),
        expected="error <= 0.02 m, lane mismatch <= 0.2 % of steps, every remaining route kept",
        control_expected="driven natively in junctions too: error above 0.1 m",
        holds=lambda values: (
            float(values["error_m"]) <= 0.02
            and float(values["lane_mismatch_percent"]) <= 0.2
            and values["steps_with_changed_route"] == 0
        ),
        control_fails=lambda values: float(values["error_m"]) > 0.1,
    ),
    Case(
        key="keep_route_6",
        name="Positions off the road are harmless with keepRoute 2",
        shows="keepRoute 6 ends the process: it is never used",
        claim=lambda: _off_road(2),
        control=lambda: _off_road(6),
        expected="return code 0",
        control_expected="keepRoute 6: the process crashes; its return code is recorded",
        holds=lambda values: values["return_code"] == 0,
        control_fails=lambda values: values["return_code"] != 0,
    ),
)
