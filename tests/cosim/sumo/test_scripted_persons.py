"""SUMO's drivers and our egos meet pedestrians whom SUMO does not have."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import libsumo
import pytest

from cosim.conformance.stage import separation
from cosim.errors import InputError
from cosim.step.frames import heading_of
from cosim.sumo.network_file import read_network
from cosim.sumo.present import everybody_present
from cosim.sumo.scripted_persons import ScriptedPersons
from cosim.sumo.surroundings import Observer
from cosim.sumo.yielding import stopping_speed
from sumo_scenarios.pedestrian_tables import read_pedestrians

from .conftest import TYPES

pytestmark = pytest.mark.sumo

STEP = 0.1
CAR = '<vType id="keeper" sigma="0" speedDev="0" lcKeepRight="0" length="4.5"/><vehicle id="car" type="keeper" depart="0" departLane="{lane}" departPos="10" departSpeed="{speed}"><route edges="am mj jb"/></vehicle>'


@dataclass
class Meeting:
    """What happened between one car and the pedestrians."""

    speeds: list[float] = field(default_factory=list)
    fronts: list[float] = field(default_factory=list)
    pedestrians: list[tuple[float, float]] = field(default_factory=list)
    closest: float = math.inf
    """Between the car's body and a pedestrian's disc [m]."""

    @property
    def slowest(self) -> float:
        return min(self.speeds)


class Scene:
    """SUMO with scripted pedestrians, and no ego."""

    def __init__(
        self, network: Path, folder: Path, rows: Sequence[Mapping[str, Any]], demand: str, *options: str
    ):
        routes = folder / "r.rou.xml"
        routes.write_text(f"<routes>{TYPES}{demand}</routes>")
        tables = read_pedestrians(rows, {}, folder / "scenario.toml")
        self.scripted = ScriptedPersons(tables, read_network(network), 1, 0.0, 1000.0)
        libsumo.start(
            ["sumo", "-n", str(network), "-r", str(routes), "--step-length", str(STEP), "--no-step-log", "true",
             "--no-warnings", "true", "--time-to-teleport", "-1", *options]
        )  # fmt: skip
        self.scripted.join(libsumo, STEP)

    def run(self, duration: float, car: str = "car", driven: Sequence[str] = ()) -> Meeting:
        seen = Meeting()
        for _ in range(round(duration / STEP)):
            self.scripted.walk(libsumo.simulation.getTime(), (), driven)
            libsumo.simulationStep()
            places = [libsumo.poi.getPosition(name) for name in libsumo.poi.getIDList()]
            seen.pedestrians += places
            if car not in libsumo.vehicle.getIDList():
                continue
            x, y = libsumo.vehicle.getPosition(car)
            heading = heading_of(libsumo.vehicle.getAngle(car))
            body = (x, y, heading, libsumo.vehicle.getLength(car), libsumo.vehicle.getWidth(car))
            for px, py in places:
                seen.closest = min(seen.closest, separation(body, (px + 0.005, py, 0.0, 0.01, 0.01)) - 0.25)
            seen.speeds.append(libsumo.vehicle.getSpeed(car))
            seen.fronts.append(x)
        return seen


@pytest.fixture
def scenes(town_file: Path, tmp_path: Path) -> Iterator[Any]:
    """Open scenes in the town; the last one is closed after the test."""

    def open_(rows: Sequence[Mapping[str, Any]], demand: str, *options: str) -> Scene:
        if libsumo.isLoaded():
            libsumo.simulationStep()
            libsumo.close()
        return Scene(town_file, tmp_path, rows, demand, *options)

    yield open_
    if libsumo.isLoaded():
        libsumo.simulationStep()
        libsumo.close()


def crosser(start_s: float, x: float = 80.0, **more: Any) -> dict[str, Any]:
    """Return a row for somebody who crosses the road from its right, away from crossings."""
    row = {"name": "walker", "kind": "line", "lane": "am_1", "from_m": [x, -3.0], "to_m": [x, 18.0]}
    return {**row, "speed_mps": 1.4, "start": {"time_s": start_s}, **more}


@pytest.mark.parametrize("options", [("--lateral-resolution", "0.4"), ()])
@pytest.mark.parametrize("lane", [1, 2])
def test_a_car_of_sumos_stops_for_a_jaywalker_away_from_crossings(
    scenes: Any, lane: int, options: tuple[str, ...]
) -> None:
    # The pedestrian walks onto the car's lane and stands there; otherwise the car would be gone after 35 s.
    demand = CAR.format(lane=lane, speed=10)
    walks = {1: 3.0, 2: 6.2}[lane]
    seen = scenes([crosser(1.0, stop_after_m=walks, stay_s=40.0)], demand, *options).run(40.0)
    assert seen.slowest < 0.1
    assert seen.fronts[-1] < 80.0
    assert seen.closest > 1.0
    without = scenes([], demand, *options).run(40.0)
    assert max(without.fronts) > 300.0


def test_it_drives_on_when_the_way_is_free_again_and_obeys_sumo_as_before(scenes: Any) -> None:
    seen = scenes([crosser(3.0)], CAR.format(lane=1, speed=10)).run(25.0)
    assert seen.slowest < 9.0
    assert seen.closest > 0.3
    assert seen.fronts[-1] > 150.0
    assert libsumo.vehicle.getSpeedMode("car") == 31
    # Comfortable braking is 4.5 m/s², and nobody had to brake harder.
    assert max(a - b for a, b in zip(seen.speeds, seen.speeds[1:], strict=False)) < 0.46


def test_nobody_brakes_for_people_on_the_sidewalk_or_who_have_passed(scenes: Any) -> None:
    along = crosser(0.0, from_m=[20.0, -2.6], to_m=[140.0, -2.6])
    waits = crosser(900.0, name="waits")
    over = crosser(0.0, name="over", from_m=[60.0, 2.0], to_m=[60.0, 40.0], speed_mps=2.0)
    seen = scenes([along, waits, over], CAR.format(lane=1, speed=10)).run(10.0)
    alone = scenes([], CAR.format(lane=1, speed=10)).run(10.0)
    assert seen.speeds == pytest.approx(alone.speeds)


def test_those_who_appear_look_at_sumos_vehicles_before_they_set_off(scenes: Any) -> None:
    # Somebody appears about every second, and the car passes their line after 5 s.
    row = crosser(0.0, start={"per_hour": 3600.0, "accepted_gap_s": 9.0})
    seen = scenes([row], CAR.format(lane=1, speed=10)).run(4.0)
    assert len(seen.pedestrians) > 20
    assert len(set(seen.pedestrians)) == 1
    # With nobody on the road, they set off as they appear.
    alone = scenes([row], "").run(4.0)
    assert len(set(alone.pedestrians)) > 20


def test_a_vehicle_that_a_controller_drives_is_left_alone(scenes: Any) -> None:
    row = crosser(1.0, stop_after_m=3.0, stay_s=40.0)
    seen = scenes([row], CAR.format(lane=1, speed=10)).run(12.0, driven=("car",))
    assert seen.closest < 0.0


@pytest.mark.parametrize("setback_m", [0.3, 1.0])
def test_a_car_of_sumos_lets_a_scripted_pedestrian_go_first_at_a_zebra(scenes: Any, setback_m: float) -> None:
    # The pedestrian waits for a gap that a driver has to give: unseen by the traffic, they would not go.
    row = {
        "name": "polite", "kind": "crossing", "crossing": ":m_c0", "side": "first", "speed_mps": 1.3,
        "setback_m": setback_m, "start": {"time_s": 5.0, "accepted_gap_s": 30.0},
    }  # fmt: skip
    seen = scenes([row], CAR.format(lane=1, speed=10)).run(30.0)
    assert seen.slowest < 0.1
    stopped = seen.fronts[seen.speeds.index(seen.slowest)]
    assert 130.0 < stopped < 150.0  # the crossing begins at 150 m
    assert seen.closest > 0.5
    assert seen.fronts[-1] > 160.0


def test_at_a_crossing_where_they_have_to_wait_they_do_not(tmp_path: Path, unmarked_file: Path) -> None:
    row = {
        "name": "patient", "kind": "crossing", "crossing": ":m_c0", "side": "first", "speed_mps": 1.3,
        "start": {"time_s": 5.0, "accepted_gap_s": 8.0},
    }  # fmt: skip
    scene = Scene(unmarked_file, tmp_path, [row], CAR.format(lane=1, speed=10))
    try:
        seen = scene.run(14.0)
        assert min(seen.speeds[20:]) > 5.0
        begins = seen.pedestrians[0]
        assert math.dist(begins, seen.pedestrians[60]) == 0.0
    finally:
        libsumo.simulationStep()
        libsumo.close()


def test_who_steps_out_too_late_for_anybody_is_hit_at_a_lower_speed(scenes: Any) -> None:
    late = crosser(3.8, from_m=[80.0, -2.0])
    seen = scenes([late], CAR.format(lane=1, speed=10)).run(12.0)
    assert max(a - b for a, b in zip(seen.speeds, seen.speeds[1:], strict=False)) > 0.5


def test_a_place_that_is_not_in_the_network_is_refused(town_file: Path) -> None:
    network = read_network(town_file)
    start = {"time_s": 0.0}
    common = {"name": "x", "speed_mps": 1.0, "start": start}
    line = {**common, "kind": "line", "from_m": [0.0, 0.0], "to_m": [0.0, 5.0]}
    for row, words in (
        ({**line, "lane": "am_9"}, "no lane 'am_9'.*am_"),
        ({**line, "lane": "am_1", "to_m": [900.0, 0.0]}, "is 1.* m long"),
        ({**common, "kind": "crossing", "crossing": ":m_c7"}, "no crossing ':m_c7'.*:m_c0"),
        ({**common, "kind": "jaywalk", "edge": "nowhere", "section_m": [1.0, 2.0]}, "no edge 'nowhere'"),
        ({**common, "kind": "jaywalk", "edge": "am", "section_m": [1.0, 900.0]}, "m long"),
    ):
        tables = read_pedestrians([row], {}, Path("scenario.toml"))
        with pytest.raises(InputError, match=words):
            ScriptedPersons(tables, network, 1, 0.0, 100.0)


def test_the_speed_that_stops_in_time_does(scenes: Any) -> None:
    for gap in (0.5, 3.0, 17.0):
        left, speed = gap, stopping_speed(gap, 4.0, STEP)
        while speed > 1e-6:
            left -= speed * STEP
            assert left > -1e-9
            before, speed = speed, stopping_speed(left, 4.0, STEP)
            assert before - speed < 4.0 * STEP + 1e-9


@pytest.mark.parametrize(
    ("keep_route", "stands", "sees"),
    [(2, False, False), (6, False, True), (6, True, False)],
    ids=["a lane that bans pedestrians", "permissions ignored, walking", "permissions ignored, standing"],
)
def test_why_sumo_is_not_asked_to_show_them(scenes: Any, keep_route: int, stands: bool, sees: bool) -> None:
    """What SUMO's drivers make of a person that moveToXY puts before them; docs/pedestrians.md says more."""
    scenes([], CAR.format(lane=1, speed=10), "--lateral-resolution", "0.4")
    libsumo.person.add("walker", "am", 80.0)
    libsumo.person.appendWaitingStage("walker", 1e6)
    slowest = 10.0
    for _ in range(75):
        time = libsumo.simulation.getTime()
        # The person is on the car's lane from the beginning, or steps onto it when the car is 15 m away.
        y = 195.2 if stands else 191.0 + 1.4 * max(0.0, time - 2.0)
        libsumo.person.moveToXY("walker", "", 80.0, y, 0.0, keep_route)
        libsumo.simulationStep()
        if "car" in libsumo.vehicle.getIDList():
            slowest = min(slowest, libsumo.vehicle.getSpeed("car"))
    assert (slowest < 8.0) is sees


def test_observers_and_scripted_persons_agree_on_the_types_of_their_arrays(scenes: Any) -> None:
    scene = scenes([crosser(0.0)], CAR.format(lane=1, speed=10))
    scene.run(1.0)
    observer = Observer(libsumo, scene.scripted._network, STEP)
    observer.follow("car")
    libsumo.simulationStep()
    known = observer.read(("car",), {}, everybody_present(libsumo))
    merged = scene.scripted.among(known, {"car": (20.0, 195.2)}, 1.0)
    assert merged.persons.names == ("walker",)
    assert merged.persons_near["car"].tolist() == [0]
    assert merged.persons.kind == ("line",)
    assert merged.persons.position.shape == (1, 2)
    assert scene.scripted.among(known, {"car": (20.0, -400.0)}, 1.0).persons.names == ()
