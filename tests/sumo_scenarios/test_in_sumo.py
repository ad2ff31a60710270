"""Each built-in scenario starts in SUMO, vehicles move, and pedestrians use the crossings."""

from __future__ import annotations

from pathlib import Path

import pytest

from sumo_scenarios.library import load, names, prepare, with_parameters

pytestmark = pytest.mark.sumo

# Pedestrians wait for gaps and green; the first of the measured hour sets out 139 s after its beginning.
UNTIL_S = {
    "braunschweig": 160.0,
    "braunschweig_calibrated": 160.0,
    "midblock_unmarked": 120.0,
    "signalised_junction": 120.0,
}

# Where there is none, those who cross are scripted: tests/cosim/running/test_scripted_pedestrians.py.
CROSSINGS = {
    "midblock_unmarked": 5,
    "midblock_zebra": 5,
    "signalised_junction": 4,
    "jaywalk_arterial": 0,
    "bus_stop_occlusion": 0,
}
SLOW = {"braunschweig_calibrated"}  # the roads of braunschweig with other demand


@pytest.mark.long
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in names()]
)
def test_vehicles_move_and_pedestrians_cross(name: str, tmp_path: Path) -> None:
    import libsumo

    prepared = prepare(load(name), 1, tmp_path)
    crossings: set[str] = set()
    fastest = 0.0
    libsumo.start(["sumo", *prepared.options])
    try:
        step, wanted = 0, CROSSINGS.get(name, 1)
        end = prepared.begin_s + UNTIL_S.get(name, 90.0)
        while libsumo.simulation.getTime() < end and (fastest <= 8.0 or len(crossings) < wanted):
            libsumo.simulationStep()
            step += 1
            if step % 10 == 0:
                fastest = max([fastest, *map(libsumo.vehicle.getSpeed, libsumo.vehicle.getIDList())])
                edges = map(libsumo.person.getRoadID, libsumo.person.getIDList())
                crossings.update(edge for edge in edges if edge.startswith(":") and "_c" in edge)
        as_asked = libsumo.simulation.getDeltaT() == pytest.approx(load(name).step_s)
        assert as_asked
    finally:
        libsumo.close()
    assert fastest > 8.0
    assert len(crossings) >= wanted


def test_without_demand_nobody_comes(tmp_path: Path) -> None:
    import libsumo

    scenario, _ = with_parameters(
        load("midblock_zebra"), {"vehicles_per_hour": "0", "pedestrians_per_hour": "0"}
    )
    libsumo.start(["sumo", *prepare(scenario, 1, tmp_path).options])
    try:
        for _ in range(600):
            libsumo.simulationStep()
        assert libsumo.person.getIDCount() == 0
        assert set(libsumo.vehicle.getIDList()) == {"roadworks_right", "roadworks_middle"}
    finally:
        libsumo.close()


def test_the_decision_road_offers_room_beside_the_ego_only_after_the_dense_column(tmp_path: Path) -> None:
    """An ego that keeps the right lane meets a short gap beside it, then a short one in its own lane only."""
    import libsumo

    scenario = load("decision_rules")
    short_beside: list[float] = []
    short_in_lane_only: list[float] = []
    libsumo.start(["sumo", *prepare(scenario, 1, tmp_path).options])
    try:
        while libsumo.simulation.getTime() < 150.0:
            if libsumo.simulation.getTime() == pytest.approx(scenario.warmup_s):
                libsumo.route.add("ego", list(scenario.egos.routes[0]))
                libsumo.vehicle.add("ego", "ego", departLane="1", departSpeed="desired")
                libsumo.vehicle.setLaneChangeMode("ego", 0)
            libsumo.simulationStep()
            if "ego" not in libsumo.vehicle.getIDList() or libsumo.vehicle.getRoadID("ego") != "east_1":
                continue
            place = libsumo.vehicle.getPosition("ego")[0]
            least = 2.5 + libsumo.vehicle.getSpeed("ego")
            gaps: dict[int, list[float]] = {1: [], 2: []}
            for name in libsumo.vehicle.getIDList():
                other, lane = libsumo.vehicle.getPosition(name)[0], libsumo.vehicle.getLaneIndex(name)
                if name != "ego" and libsumo.vehicle.getRoadID(name) == "east_1":
                    length = libsumo.vehicle.getLength(name) if other > place else 5.0
                    gaps[lane].append(abs(other - place) - length)
            if min(gaps[2], default=least + 1) <= least:
                short_beside.append(place)
            elif min(gaps[1], default=least + 1) <= least:
                short_in_lane_only.append(place)
    finally:
        libsumo.close()
    assert max(short_beside) - min(short_beside) > 200.0
    assert len(short_in_lane_only) > 100
    assert max(short_in_lane_only) > max(short_beside)
