"""Cases of an ego that leaves its path, and of an ego whose route another program changes."""

from __future__ import annotations

from typing import Any

from cosim.conformance.case import Case, Values
from cosim.conformance.ride import Driver, Moved
from cosim.conformance.stage import pose_of, scene, wait_for
from cosim.step.frames import degrees_of
from cosim.sumo.placement import Placement

STEP = 0.1
BEFORE_BEND = 170.0
"""Position at which the ego starts, 20 m before the junction [m]."""


class _Hinted(Moved):
    """A driver that moves the ego to its true position, with its last known lane as a hint."""

    def drive(self, name: str, front_x: float, front_y: float, heading: float, speed: float) -> None:
        """Say where the vehicle has to be after the next step."""
        lane: str = self._sumo.vehicle.getLaneID(name) or self._lane
        self._lane = lane
        edge, _, index = lane.rpartition("_")
        self._sumo.vehicle.setSpeed(name, speed)
        self._sumo.vehicle.moveToXY(name, edge, int(index), front_x, front_y, degrees_of(heading), 2)

    _lane = "wx_1"


def _straight_on(driver: str) -> Values:
    """Drive straight on where the route turns right, like a car that is too fast for the bend."""
    with scene("junction", _traffic("wx xs", BEFORE_BEND), step=STEP) as sumo:
        wait_for(sumo, "ego")
        chosen: Driver = _Hinted(sumo) if driver == "hinted" else Placement(sumo, STEP)
        chosen.take_over("ego")
        begin = pose_of(sumo, "ego")
        lost = nowhere = 0
        for number in range(1, 51):
            chosen.drive("ego", begin.x + 0.8 * number, begin.y, 0.0, 8.0)
            sumo.simulationStep()
            lane = chosen.executed("ego").lane
            nowhere += not lane
            lost += sumo.vehicle.getRoute("ego")[-1] != "xs"
        return {"steps_with_another_route": lost, "steps_on_no_lane": nowhere}


def _rerouted(driver: str) -> Values:
    """Give the ego another route once, as a rerouter of the configuration would."""
    with scene("junction", _traffic("wx xe", 100.0), step=STEP) as sumo:
        wait_for(sumo, "ego")
        chosen: Driver = Moved(sumo, hint=("wx", 1)) if driver == "moved" else Placement(sumo, STEP)
        chosen.take_over("ego")
        begin = pose_of(sumo, "ego")
        sumo.vehicle.setRoute("ego", ["wx", "xs"])
        wrong = 0
        for number in range(1, 51):
            chosen.drive("ego", begin.x + 0.8 * number, begin.y, 0.0, 8.0)
            sumo.simulationStep()
            chosen.executed("ego")
            wrong += _route(sumo) != "wx xe"
        return {"steps_with_another_route": wrong}


def _route(sumo: Any) -> str:
    return " ".join(sumo.vehicle.getRoute("ego"))


def _traffic(edges: str, position: float) -> str:
    return f"""<route id="r" edges="{edges}"/>
        <vehicle id="ego" type="ego" route="r" depart="0" departLane="1" departPos="{position}"
                 departSpeed="8"/>"""


CASES = (
    Case(
        key="off_the_bend",
        name="An ego that cannot follow its bend keeps its lane and its route in SUMO",
        shows="beside its path SUMO takes it for a car on another path, changes its route, and may crash",
        claim=lambda: _straight_on("placement"),
        control=lambda: _straight_on("hinted"),
        expected="straight on at a right turn: always on a lane, never another route",
        control_expected="moved to its true position: another route, or on no lane",
        holds=lambda values: values["steps_with_another_route"] == 0 and values["steps_on_no_lane"] == 0,
        control_fails=lambda values: (
            float(values["steps_with_another_route"]) + float(values["steps_on_no_lane"]) > 0
        ),
    ),
    Case(
        key="route_changed",
        name="A route changed by another program is set again at once",
        shows="an ego without its route drives against the traffic, without any message",
        claim=lambda: _rerouted("placement"),
        control=lambda: _rerouted("moved"),
        expected="no step ends with another route",
        control_expected="only moved: it keeps the other route",
        holds=lambda values: values["steps_with_another_route"] == 0,
        control_fails=lambda values: float(values["steps_with_another_route"]) > 10,
    ),
)
