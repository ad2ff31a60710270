"""Cases on what SUMO reports: collisions, gaps, detectors and trip information."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

from cosim.conformance.case import Case, Values
from cosim.conformance.ride import Driver, Native, ride
from cosim.conformance.stage import pose_of, scene, wait_for
from cosim.conformance.track import Shift, Track
from cosim.sumo.placement import Method, Placement

STEP = 0.1


def _collisions(defaults: bool) -> Values:
    """Let a moved ego hit a slow car from behind, and drive into crossing traffic."""
    rear_end = """
        <route id="r" edges="ab bc"/>
        <vehicle id="ego" type="ego" route="r" depart="0"
                 departLane="1" departPos="100" departSpeed="10"/>
        <vehicle id="other" type="car" route="r" depart="0"
                 departLane="1" departPos="200" departSpeed="2"/>"""
    crossing = """
        <route id="r" edges="wx xe"/><route id="q" edges="sx xn"/>
        <vehicle id="ego" type="ego" route="r" depart="0"
                 departLane="2" departPos="100" departSpeed="10"/>
        <vehicle id="other" type="car" route="q" depart="0"
                 departLane="2" departPos="97" departSpeed="10"/>"""
    values: dict[str, float] = {}
    for name, net, traffic, speed in (
        ("rear_end", "narrow", rear_end, 2.0),
        ("junction", "junction", crossing, 10.0),
    ):
        with scene(net, traffic, step=STEP, collision_options=not defaults) as sumo:
            wait_for(sumo, "ego")
            wait_for(sumo, "other")
            sumo.vehicle.setSpeed("other", speed)
            sumo.vehicle.setSpeedMode("other", 32)
            sumo.vehicle.setLaneChangeMode("other", 0)
            begin = pose_of(sumo, "ego")
            driver = Placement(sumo, STEP, Method.MOVE)
            seen = ride(sumo, driver, Track(begin.x, begin.y, 10.0).at, 14.0, ["other"])
            values[f"{name}_overlap_steps"] = seen.overlaps
            values[f"{name}_reported"] = seen.reported
    return values


def _gap(corrected: bool) -> Values:
    """Compare SUMO's gaps between three cars with the true ones."""
    traffic = """<route id="r" edges="ab bc"/>
        <vehicle id="ego" type="ego" route="r" depart="0"
                 departLane="1" departPos="100" departSpeed="10"/>
        <vehicle id="ahead" type="car" route="r" depart="0"
                 departLane="1" departPos="150" departSpeed="10"/>
        <vehicle id="left" type="car" route="r" depart="0"
                 departLane="2" departPos="160" departSpeed="10"/>"""
    with scene("narrow", traffic, step=STEP) as sumo:
        wait_for(sumo, "ego")
        wait_for(sumo, "ahead")
        vehicle = sumo.vehicle
        front = vehicle.getPosition("ego")[0]
        values: dict[str, float | str] = {}
        true = vehicle.getPosition("ahead")[0] - vehicle.getLength("ahead") - front
        beside = vehicle.getPosition("left")[0] - vehicle.getLength("left") - front
        own = vehicle.getMinGap("ego") if corrected else 0.0  # the ego is the one behind in all three
        values["true_gap_m"] = true
        values["leader_error_m"] = vehicle.getLeader("ego", 100.0)[1] + own - true
        values["follower_error_m"] = vehicle.getFollower("ahead", 100.0)[1] + own - true
        values["neighbour_error_m"] = vehicle.getNeighbors("ego", 0b10)[0][1] + own - beside
        values["leader_when_none"] = str(vehicle.getLeader("left", 100.0))
        values["follower_when_none"] = str(vehicle.getFollower("ego", 100.0))
    return values


def _outputs(way: str) -> dict[str, str]:
    """Return what detectors and tripinfo report of an ego that changes lanes after an edge boundary."""
    traffic = """<route id="r" edges="ab bc"/>
        <vehicle id="ego" type="ego" route="r" depart="0" departLane="1" departPos="150" departSpeed="10"
                 arrivalPos="300"/>"""
    with TemporaryDirectory(prefix="cosim-conformance-") as name:
        folder = Path(name)
        detectors = "".join(
            f'<inductionLoop id="{lane}" lane="{lane}" pos="{at}" period="100" file="{folder}/loops.xml"/>'
            for lane, at in (("ab_1", 250), ("bc_1", 50), ("bc_2", 150))
        )
        detectors += f"""<laneAreaDetector id="area" lane="bc_2" pos="50" endPos="200" period="100"
            file="{folder}/area.xml"/>"""
        trips = ("--tripinfo-output", f"{folder}/trips.xml", "--tripinfo-output.write-unfinished", "true")
        with scene("joined", traffic, *trips, step=STEP, additional=detectors) as sumo:
            wait_for(sumo, "ego")
            begin = pose_of(sumo, "ego")
            track = Track(begin.x, begin.y, 10.0, (Shift(16.0, 3.0, 3.5),))
            driver: Driver = Native(sumo, STEP, agile=True)
            if way != "native":
                driver = Placement(sumo, STEP, Method(way))
            driver.take_over("ego")
            number = 0
            while sumo.simulation.getTime() < 110.0:
                number += 1
                if "ego" in sumo.vehicle.getIDList():
                    if sumo.vehicle.getPosition("ego")[0] > 650.0:
                        sumo.vehicle.remove("ego")
                    else:
                        driver.drive("ego", *track.at(number * STEP))
                sumo.simulationStep()
                if "ego" in sumo.vehicle.getIDList():
                    driver.executed("ego")
        found: dict[str, str] = {}
        for file in ("loops.xml", "area.xml", "trips.xml"):
            for element in ElementTree.parse(folder / file).getroot():
                about = f"{element.get('id')} {element.get('begin', '')}".strip()
                found.update({f"{about} {key}": value for key, value in element.attrib.items()})
        return found


def _compared(way: str) -> Values:
    native, found = _outputs("native"), _outputs(way)
    keys = native.keys() | found.keys()
    different = sorted(key for key in keys if not _same(native.get(key, ""), found.get(key, "")))
    return {
        "compared": len(native),
        "different": len(different),
        "which": ", ".join(different[:4]),
        "duration_s": found["ego duration"],
        "route_length_m": found["ego routeLength"],
    }


def _same(one: str, other: str) -> bool:
    """Return whether two printed values are the same; numbers may differ by one unit of their last digit."""
    try:
        return abs(float(one) - float(other)) < 0.0101
    except ValueError:
        return one == other


def _gap_errors(values: Values) -> list[float]:
    return [abs(float(value)) for name, value in values.items() if name.endswith("_error_m")]


CASES = (
    Case(
        key="collisions",
        name="With the coupling's options SUMO reports what the ego hits",
        shows="the defaults hide it; reports repeat every step, so our own geometry is the truth",
        claim=lambda: _collisions(defaults=False),
        control=lambda: _collisions(defaults=True),
        expected="a rear-end and a junction collision: both overlap and are reported",
        control_expected="SUMO's defaults: both overlap, none is reported",
        holds=lambda values: (
            float(values["rear_end_reported"]) > 0 and float(values["junction_reported"]) > 0
        ),
        control_fails=lambda values: (
            float(values["rear_end_overlap_steps"]) > 0
            and float(values["junction_overlap_steps"]) > 0
            and values["rear_end_reported"] == values["junction_reported"] == 0
        ),
    ),
    Case(
        key="gaps",
        name="getLeader, getFollower and getNeighbors plus minGap are the bumper gap",
        shows="they leave minGap out: 43.0 m for 45.5 m",
        claim=lambda: _gap(corrected=True),
        control=lambda: _gap(corrected=False),
        expected="error <= 0.01 m with the minGap of whoever is behind added; None and ('', -1.0) for nobody",
        control_expected="without adding minGap: 2.5 m short",
        holds=lambda values: (
            max(_gap_errors(values)) <= 0.01
            and values["leader_when_none"] == "None"
            and values["follower_when_none"] == "('', -1.0)"
        ),
        control_fails=lambda values: all(abs(error - 2.5) <= 0.01 for error in _gap_errors(values)),
    ),
    Case(
        key="outputs",
        name="Detectors and trip information see a hybrid ego as a native car",
        shows="induction loops, an area detector and tripinfo, over an edge boundary and a lane change",
        claim=lambda: _compared("hybrid"),
        control=lambda: _compared("move"),
        expected="every value the same, up to one unit of the last printed digit",
        control_expected="move: the ego never arrives and its route length is wrong",
        holds=lambda values: values["different"] == 0,
        control_fails=lambda values: float(values["different"]) > 0,
    ),
)
