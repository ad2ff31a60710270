"""The car that brakes ahead of the first ego on the arterial: as hard as asked, where asked, and only then."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from sumo_scenarios.library import load, prepare, with_parameters

pytestmark = pytest.mark.sumo


def speeds(folder: Path, settings: dict[str, str]) -> list[tuple[float, float, float, str]]:
    """Return time, position, speed and lane of the car ahead at every step."""
    import libsumo

    wanted = {"vehicles_per_hour": "0", "pedestrians_per_hour": "0", "warmup_s": "10", "duration_s": "60"}
    scenario, _ = with_parameters(load("jaywalk_arterial"), {**wanted, **settings})
    found = []
    libsumo.start(["sumo", *prepare(scenario, 1, folder).options])
    try:
        while libsumo.simulation.getTime() < 60.0:
            libsumo.simulationStep()
            if "ahead" in libsumo.vehicle.getIDList():
                at, speed = libsumo.vehicle.getLanePosition("ahead"), libsumo.vehicle.getSpeed("ahead")
                found.append((libsumo.simulation.getTime(), at, speed, libsumo.vehicle.getLaneID("ahead")))
    finally:
        libsumo.close()
    return found


@pytest.mark.parametrize(("braking", "lane"), [(2.0, "1"), (3.5, "2"), (7.0, "1")])
def test_it_brakes_as_hard_as_asked_and_stands_where_asked(tmp_path: Path, braking: float, lane: str) -> None:
    asked = {"ahead_braking_mps2": str(braking), "ahead_stands_at_m": "180", "ahead_stands_s": "4"}
    found = speeds(tmp_path, {"ahead": "braking_car", "ahead_lane": lane, **asked})
    assert found[0][0] == pytest.approx(8.0, abs=0.15), "two seconds before the ego"
    standing = [one for one in found if one[2] < 0.01]
    assert {one[3] for one in found if one[0] <= standing[-1][0]} == {f"east_{lane}"}
    assert standing[0][1] == pytest.approx(180.0, abs=1.0)
    assert standing[-1][0] - standing[0][0] == pytest.approx(4.0, abs=0.3)
    before = [one for one in found if one[0] < standing[0][0]]
    changes = [(a[2] - b[2]) / 0.1 for a, b in pairwise(before)]
    hard = sorted(changes)[len(changes) - 5]
    assert hard == pytest.approx(braking, rel=0.15)
    assert found[-1][2] > 10.0, "it drives on"


def test_without_being_asked_for_nobody_comes(tmp_path: Path) -> None:
    assert speeds(tmp_path, {}) == []
