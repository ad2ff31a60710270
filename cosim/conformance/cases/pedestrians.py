"""Cases on how SUMO's pedestrians react to an ego."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

from cosim.conformance.case import Case, Values
from cosim.conformance.ride import Driver, Moved, Native, ride
from cosim.conformance.stage import pose_of, scene, separation, wait_for
from cosim.conformance.track import Pose, Shift, Track
from cosim.sumo.placement import Executed, Method, Placement

STEP = 0.1
LANE_END = 298.0
"""Where the crossing begins in the nets ``crossing`` and ``zebra`` [m]."""
CHANGE = 3.2
"""Distance between the centres of the two lanes [m]."""
DISTANCES = (80.0, 60.0, 40.0, 25.0)
"""Distances from the middle of a lane change to the crossing [m]."""


@dataclass(frozen=True, slots=True)
class Encounter:
    """An ego approaching a crossing, and a pedestrian who wants to cross from its right."""

    net: str = "crossing"
    route: str = "ab bc"
    lane: int = 1
    position: float = 150.0
    speed: float = 12.0
    shifts: tuple[Shift, ...] = ()
    brakes_at: float = math.inf
    walker_departs: float = 0.0
    walker_position: float = 290.0
    duration: float = 25.0


@dataclass(slots=True)
class Seen:
    """What the pedestrian did."""

    waits_at: float = math.inf
    """Time at which the pedestrian first stands before the crossing [s]."""
    steps_on_at: float = math.inf
    """Time at which the pedestrian is first on the crossing [s]."""
    ego_then: float = math.inf
    """Position of the ego's front bumper at that time [m]."""
    closest: float = math.inf
    """Smallest distance between the pedestrian's centre and the ego's body [m]."""
    trace: list[tuple[float, float]] = field(default_factory=list)


def driver_of(sumo: Any, way: str) -> Driver:
    """Return the driver of this name, one of the drivers that the cases compare."""
    match way:
        case "hybrid":
            return Placement(sumo, STEP)
        case "move":
            return Placement(sumo, STEP, Method.MOVE)
        case "native":
            return Native(sumo, STEP, agile=True)
        case _:
            return Moved(sumo, set_speed=False, hint=("ab", 1))


def _meet(encounter: Encounter, way: str) -> Seen:
    traffic = f"""<route id="r" edges="{encounter.route}"/>
        <vehicle id="ego" type="ego" route="r" depart="0" departLane="{encounter.lane}"
                 departPos="{encounter.position}" departSpeed="{encounter.speed}"/>
        <person id="walker" type="walker" depart="{encounter.walker_departs}"
                departPos="{encounter.walker_position}"><walk edges="ab cb" arrivalPos="40"/></person>"""
    seen = Seen()
    with scene(encounter.net, traffic, step=STEP) as sumo:
        wait_for(sumo, "ego")
        begin = pose_of(sumo, "ego")
        track = Track(begin.x, begin.y, encounter.speed, encounter.shifts, encounter.brakes_at)

        def look(time: float, pose: Pose, found: Executed) -> None:
            if "walker" not in sumo.person.getIDList():
                return
            x, y = sumo.person.getPosition("walker")
            road = sumo.person.getRoadID("walker")
            seen.trace.append((x, y))
            if road.startswith(":b_w") and sumo.person.getSpeed("walker") < 0.1:
                seen.waits_at = min(seen.waits_at, time)
            if road.startswith(":b_c") and time < seen.steps_on_at:
                seen.steps_on_at, seen.ego_then = time, pose.x
            body = (pose.x, pose.y, pose.heading, 4.5, 1.8)
            seen.closest = min(seen.closest, separation(body, (x + 0.005, y, 0.0, 0.01, 0.01)))

        ride(sumo, driver_of(sumo, way), track.at, encounter.duration, each=look)
    return seen


def _stop_short(way: str) -> Values:
    """Stop the ego 6 m before the lane's end; the pedestrian arrives a little earlier."""
    stop = Encounter(position=200.0, speed=10.0, brakes_at=(92.0 - 1.0 - 100.0 / 6.0) / 10.0, duration=90.0)
    seen = _meet(stop, way)
    return {
        "waits_from_s": seen.waits_at,
        "steps_on_at_s": seen.steps_on_at,
        "waiting_s": seen.steps_on_at - min(seen.waits_at, seen.steps_on_at),
    }


def _route(edges: str) -> Values:
    seen = _meet(Encounter(route=edges, position=100.0, walker_departs=5.0, walker_position=292.0), "hybrid")
    return {
        "steps_on_at_s": seen.steps_on_at,
        "ego_before_the_crossing_m": LANE_END - seen.ego_then,
        "closest_m": seen.closest,
    }


def _lane_changes(way: str) -> Values:
    """Change lanes in 3 s to either side, centred at several distances before a waiting pedestrian."""
    early, closest = 0, math.inf
    latest = -math.inf
    for distance in DISTANCES:
        for lane, offset in ((1, CHANGE), (2, -CHANGE)):
            middle = (LANE_END - distance - 90.0) / 12.0
            shifts = (Shift(middle - 1.5, 3.0, offset),)
            seen = _meet(Encounter(lane=lane, position=90.0, shifts=shifts), way)
            before = LANE_END - seen.ego_then
            early += before > 0.0
            latest = max(latest, before)
            closest = min(closest, seen.closest)
    return {
        "runs": 2 * len(DISTANCES),
        "stepped_out_before": early,
        "at_most_m": latest,
        "closest_m": closest,
    }


def _traces(way: str) -> Values:
    """Return how far the pedestrian deviates at most from their path for a native car, per manoeuvre [m]."""
    values: dict[str, float] = {}
    speed, position = 12.0, 90.0
    middle = (LANE_END - 40.0 - position) / speed
    braking = (LANE_END - 6.0 - position - speed**2 / 6.0) / speed
    approach = Encounter(speed=speed, position=position)
    manoeuvres = {
        "keep": approach,
        "change": replace(approach, shifts=(Shift(middle - 1.5, 3.0, CHANGE),)),
        "straddle": replace(approach, shifts=(Shift(middle - 1.5, 3.0, 1.4),)),
        "stop": replace(approach, brakes_at=braking, duration=35.0),
    }
    for net, departures in (("crossing", (0.0,)), ("zebra", (5.0, 8.0))):
        for name, manoeuvre in manoeuvres.items():
            worst = 0.0
            for departs in departures:
                encounter = replace(manoeuvre, net=net, walker_departs=departs)
                worst = max(worst, _apart(_meet(encounter, "native").trace, _meet(encounter, way).trace))
            values[f"{net}_{name}_apart_m"] = worst
    values["turning_apart_m"], values["turning_closest_m"] = _turning(way)
    return values


def _apart(one: list[tuple[float, float]], other: list[tuple[float, float]]) -> float:
    if len(one) != len(other):
        return math.inf
    return max((math.dist(a, b) for a, b in zip(one, other, strict=True)), default=0.0)


def _turning(way: str) -> tuple[float, float]:
    """Return this distance for a right turn across a zebra crossing; the ego repeats a native car's poses.

    Also return how close the native car comes to the pedestrian [m]: a car that stays far away would prove
    nothing.
    """
    worst, closest = 0.0, math.inf
    for departs in (2.0, 4.0, 8.0):
        poses, native = _turn(departs, None, way)
        worst = max(worst, _apart(native, _turn(departs, poses, way)[1]))
        for pose, (x, y) in zip(poses[len(poses) - len(native) :], native, strict=True):
            body = (pose.x, pose.y, pose.heading, 4.5, 1.8)
            closest = min(closest, separation(body, (x + 0.005, y, 0.0, 0.01, 0.01)))
    return worst, closest


def _turn(departs: float, poses: list[Pose] | None, way: str) -> tuple[list[Pose], list[tuple[float, float]]]:
    traffic = f"""<route id="r" edges="wx xs"/>
        <vehicle id="ego" type="ego" route="r" depart="0" departLane="1" departPos="100" departSpeed="6"/>
        <person id="walker" type="walker" depart="{departs}" departPos="10"><walk edges="xs sx"/></person>"""
    trace: list[tuple[float, float]] = []
    driven: list[Pose] = []
    with scene("junction", traffic, step=STEP) as sumo:
        wait_for(sumo, "ego")
        sumo.vehicle.setSpeedMode("ego", 32)
        sumo.vehicle.setLaneChangeMode("ego", 0)
        driver = driver_of(sumo, way)
        if poses is None:
            sumo.vehicle.setSpeed("ego", 6.0)
        else:
            driver.take_over("ego")
        for number in range(250):
            if poses is not None:
                driver.drive("ego", *poses[number])
            sumo.simulationStep()
            if poses is not None:
                driver.executed("ego")
            driven.append(pose_of(sumo, "ego"))
            if "walker" in sumo.person.getIDList():
                trace.append(sumo.person.getPosition("walker"))
    return driven, trace


def _far_apart(values: Values) -> bool:
    return max(float(value) for name, value in values.items() if name.endswith("_apart_m")) > 0.2


CASES = (
    Case(
        key="set_speed",
        name="A pedestrian steps out in front of an ego that has stopped",
        shows="pedestrians react to the speed that SUMO plans; moveToXY alone leaves its own plan in place",
        claim=lambda: _stop_short("move"),
        control=lambda: _stop_short("moveToXY only"),
        expected="crossing without priority, ego stopped 6 m short: the pedestrian waits at most 12 s",
        control_expected="moveToXY without setSpeed: the pedestrian waits more than 30 s",
        holds=lambda values: float(values["waiting_s"]) <= 12.0,
        control_fails=lambda values: float(values["waiting_s"]) > 30.0,
    ),
    Case(
        key="route",
        name="A pedestrian waits for an ego whose route goes on beyond the crossing",
        shows="an ego needs its full route: without a next edge it does not approach the crossing",
        claim=lambda: _route("ab bc"),
        control=lambda: _route("ab"),
        expected="ego at 12 m/s: the pedestrian steps out after it has passed",
        control_expected="route that ends before the crossing: the pedestrian steps out before it has passed",
        holds=lambda values: float(values["ego_before_the_crossing_m"]) < 0.0,
        control_fails=lambda values: float(values["ego_before_the_crossing_m"]) > 0.0,
    ),
    Case(
        key="blind_step",
        name="A pedestrian keeps waiting while the ego changes lanes before the crossing",
        shows="a move that changes the lane drops the ego's approach to the crossing for one step",
        claim=lambda: _lane_changes("hybrid"),
        control=lambda: _lane_changes("move"),
        expected="change centred 80, 60, 40, 25 m before the pedestrian, who always waits for the ego",
        control_expected="move: the pedestrian steps out before",
        holds=lambda values: values["stepped_out_before"] == 0,
        control_fails=lambda values: float(values["stepped_out_before"]) > 0,
    ),
    Case(
        key="traces",
        name="Pedestrians walk as they would for a native car",
        shows="keep, lane change, straddle, stop, turn; zebra and crossing without priority",
        claim=lambda: _traces("hybrid"),
        control=lambda: _traces("move"),
        expected="positions within 0.2 m at all times, also of one whom the turning car comes close to",
        control_expected="move: more than 0.2 m apart",
        holds=lambda values: not _far_apart(values) and float(values["turning_closest_m"]) < 2.0,
        control_fails=_far_apart,
    ),
)
