"""Cases on the effects of ``moveToXY`` on lanes, routes, signals and the next run."""

from __future__ import annotations

from typing import Any

from cosim.conformance.case import Case, Values
from cosim.conformance.ride import Driver, Moved, ride
from cosim.conformance.stage import pose_of, scene, wait_for
from cosim.conformance.track import Pose, Shift, Track
from cosim.sumo.placement import Executed, Method, Placement

STEP = 0.1


def _drive_through(driver: str) -> Values:
    """Drive an ego through a junction along the recorded poses of a native car."""
    ways = (("wx xe", 1), ("wx xe", 2), ("wx xs", 1), ("wx xn", 2))
    steps = matched = 0
    kept = True
    for edges, lane in ways:
        poses, lanes = _recorded(edges, lane)
        with scene("junction", _traffic(edges, lane), step=STEP) as sumo:
            wait_for(sumo, "ego")
            chosen: Driver = Moved(sumo) if driver == "no hint" else Placement(sumo, STEP, Method.MOVE)
            chosen.take_over("ego")
            for pose, expected in zip(poses, lanes, strict=True):
                chosen.drive("ego", *pose)
                sumo.simulationStep()
                steps += 1
                matched += chosen.executed("ego").lane == expected
            kept = kept and sumo.vehicle.getRoute("ego")[-1] == edges.split()[-1]
    return {"steps": steps, "lane_matched_percent": 100.0 * matched / steps, "routes_kept": float(kept)}


def _traffic(edges: str, lane: int) -> str:
    return f"""<route id="r" edges="{edges}"/>
        <vehicle id="ego" type="ego" route="r" depart="0" departLane="{lane}" departPos="100"
                 departSpeed="8"/>"""


def _recorded(edges: str, lane: int) -> tuple[list[Pose], list[str]]:
    """Return the pose and the lane of a native car after each step."""
    poses, lanes = [], []
    with scene("junction", _traffic(edges, lane), step=STEP) as sumo:
        wait_for(sumo, "ego")
        sumo.vehicle.setSpeedMode("ego", 32)
        sumo.vehicle.setLaneChangeMode("ego", 0)
        sumo.vehicle.setSpeed("ego", 8.0)
        for _ in range(180):
            sumo.simulationStep()
            poses.append(pose_of(sumo, "ego"))
            lanes.append(sumo.vehicle.getLaneID("ego"))
    return poses, lanes


def _swerve(hinted: bool) -> Values:
    """Swerve 2.2 m towards the oncoming edge and back."""
    traffic = """<route id="r" edges="ab bc"/>
        <vehicle id="ego" type="ego" route="r" depart="0"
                 departLane="2" departPos="1200" departSpeed="10"/>"""
    with scene("narrow", traffic, step=STEP) as sumo:
        wait_for(sumo, "ego")
        begin = pose_of(sumo, "ego")
        track = Track(begin.x, begin.y, 10.0, (Shift(1.0, 2.0, 2.2), Shift(5.0, 2.0, -2.2)))
        oncoming = 0

        def look(time: float, pose: Pose, found: Executed) -> None:
            nonlocal oncoming
            oncoming += found.lane.startswith("ba")

        ride(sumo, Moved(sumo, hint=("ab", 2) if hinted else ("", -1)), track.at, 12.0, each=look)
        return {"route_left": " ".join(sumo.vehicle.getRoute("ego")), "steps_on_oncoming_edge": oncoming}


def _leak(step_after: bool) -> Values:
    """Run twice in this process; the first run ends with a move."""
    traffic = """<route id="r" edges="ab bc"/>
        <vehicle id="ego" type="ego" route="r" depart="0" departLane="2" departPos="100" departSpeed="10"/>"""
    seen: list[bool] = []
    for _ in range(2):
        with scene("narrow", traffic, step=STEP) as sumo:
            for _ in range(20):
                sumo.simulationStep()
            seen.append("ego" in sumo.vehicle.getIDList())
            if seen[-1]:
                x, y = sumo.vehicle.getPosition("ego")
                sumo.vehicle.moveToXY("ego", "ab", 2, x + 1.0, y, 90.0, 2)
                if step_after:
                    sumo.simulationStep()
    return {"ego_in_first_run": float(seen[0]), "ego_in_second_run": float(seen[1])}


def _red() -> Values:
    """Move an ego over a red light, under two speed modes."""
    values: dict[str, float | str] = {}
    for mode in (31, 32):
        with scene("signal", _RED, step=STEP) as sumo:
            begin = _before_red(sumo)
            stopped: set[str] = set()
            driver = Moved(sumo, speed_mode=mode)
            track = Track(begin.x, begin.y, 10.0)
            ride(sumo, driver, track.at, 20.0, each=lambda *_: stopped.update(_complaints(sumo)))  # noqa: B023
            values[f"edge_mode_{mode}"] = sumo.vehicle.getRoadID("ego")
            values[f"emergency_stops_mode_{mode}"] = len(stopped)
    return values


def _red_native() -> Values:
    """Drive towards the same red light with ``setSpeed`` alone, in the speed mode that lets SUMO brake."""
    with scene("signal", _RED, step=STEP) as sumo:
        _before_red(sumo)
        sumo.vehicle.setSpeedMode("ego", 31)
        sumo.vehicle.setSpeed("ego", 10.0)
        for _ in range(200):
            sumo.simulationStep()
        return {"edge_mode_31": sumo.vehicle.getRoadID("ego")}


_RED = """<route id="r" edges="ab bc"/>
    <vehicle id="ego" type="ego" route="r" depart="0" departLane="1" departPos="50" departSpeed="10"/>"""


def _before_red(sumo: Any) -> Pose:
    wait_for(sumo, "ego")
    links = len(sumo.trafficlight.getRedYellowGreenState("b"))
    sumo.trafficlight.setRedYellowGreenState("b", "r" * links)
    return pose_of(sumo, "ego")


def _complaints(sumo: Any) -> list[str]:
    return [
        *sumo.simulation.getEmergencyStoppingVehiclesIDList(),
        *sumo.simulation.getStartingTeleportIDList(),
    ]


CASES = (
    Case(
        key="move_recipe",
        name="The move recipe keeps the ego on the lane that it is on",
        shows="edge and lane as a hint, internal lanes included, over straight on, right and left",
        claim=lambda: _drive_through("recipe"),
        control=lambda: _drive_through("no hint"),
        expected="lane matched in at least 99.9 % of steps, route kept",
        control_expected="without the hint: less than 99.9 % of steps, or a route lost",
        holds=lambda values: float(values["lane_matched_percent"]) >= 99.9 and values["routes_kept"] == 1,
        control_fails=lambda values: (
            float(values["lane_matched_percent"]) < 99.9 or values["routes_kept"] == 0
        ),
    ),
    Case(
        key="hint",
        name="With the edge hint a swerve towards the oncoming lane keeps the route",
        shows="keepRoute 2 takes the nearest edge, and with it destroys the rest of the route for good",
        claim=lambda: _swerve(hinted=True),
        control=lambda: _swerve(hinted=False),
        expected="2.2 m towards the oncoming edge: route still 'ab bc', never on the oncoming edge",
        control_expected="without the hint: on the oncoming edge, and the route has lost its end",
        holds=lambda values: values["route_left"] == "ab bc" and values["steps_on_oncoming_edge"] == 0,
        control_fails=lambda values: (
            values["route_left"] != "ab bc" and float(values["steps_on_oncoming_edge"]) > 0
        ),
    ),
    Case(
        key="leak",
        name="A run whose last move is followed by a step leaves the next run alone",
        shows="a pending move survives close(): in the next run a vehicle of that name never appears",
        claim=lambda: _leak(step_after=True),
        control=lambda: _leak(step_after=False),
        expected="the ego appears in both runs",
        control_expected="without the step: not in the second",
        holds=lambda values: values["ego_in_second_run"] == 1,
        control_fails=lambda values: values["ego_in_first_run"] == 1 and values["ego_in_second_run"] == 0,
    ),
    Case(
        key="red",
        name="A moved ego drives through red, whatever its speed mode",
        shows="red lights are the controller's responsibility (#14548)",
        claim=_red,
        control=_red_native,
        expected="modes 31 and 32: beyond the junction after 20 s, under 32 without an emergency stop",
        control_expected="driven by setSpeed under mode 31: stopped at the light",
        holds=lambda values: (
            values["edge_mode_31"] == values["edge_mode_32"] == "bc"
            and values["emergency_stops_mode_32"] == 0
        ),
        control_fails=lambda values: values["edge_mode_31"] == "ab",
    ),
)
