"""Vehicles that SUMO has where they were recorded, also where that is on no lane."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from cosim.sumo.world import SumoWorld
from sumo_scenarios.library import load, prepare
from tests.cosim.cli.commands import source_environment

from .conftest import drive

pytestmark = pytest.mark.long

HEADER = "vehicle,class,edge,time_s,x_m,y_m,heading_rad,speed_mps,length_m,width_m\n"
DRIVE = """
import sys
import libsumo
import sumo
from pathlib import Path
from cosim.sumo.recorded_vehicles import RecordedVehicles
from sumo_scenarios.recorded_vehicles import read_recorded_vehicles

network = Path(sumo.__file__).parent / "tools/game/fokr_bs_demo/fokr_bs.net.xml.gz"
libsumo.start(
    ["sumo", "-n", str(network), "--step-length", "0.1", "--no-warnings", *sys.argv[2:]]
)
vehicles = RecordedVehicles(read_recorded_vehicles(Path(sys.argv[1])), 0.0)
for step in range(1, 31):
    vehicles.move(libsumo, 0.1 * step, libsumo.vehicle.remove)
    libsumo.simulationStep()
    for name in libsumo.vehicle.getIDList():
        print(f"{0.1 * step:.1f}", name, *libsumo.vehicle.getPosition(name), flush=True)
"""


SUBLANE = ("--lateral-resolution", "0.4")


def driven(folder: Path, rows: str, *options: str) -> dict[tuple[float, str], tuple[float, float]]:
    """Return where vehicles are, by time and name, in a process of its own: a crash of SUMO would end it."""
    (folder / "vehicles.csv").write_text(HEADER + rows)
    done = subprocess.run(
        [sys.executable, "-c", DRIVE, str(folder / "vehicles.csv"), *options],
        env=source_environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    words = [line.split() for line in done.stdout.splitlines()]
    return {(float(time), name): (float(x), float(y)) for time, name, x, y in words}


def straight(name: str, x: float, y: float, vx: float, vy: float, heading: float) -> str:
    """Return the rows of a car that is at a place after 2 s and drives evenly."""
    speed = (vx**2 + vy**2) ** 0.5
    return "".join(
        f"{name},passenger,-7.110,{time:.1f},{x + vx * (time - 2.0):.3f},{y + vy * (time - 2.0):.3f},"
        f"{heading},{speed:.3f},4.5,1.8\n"
        for time in (0.1 * step for step in range(31))
    )


@pytest.mark.sumo
def test_a_car_beside_the_end_of_its_lane_does_not_crash_sumo_when_another_one_drives_there(
    tmp_path: Path,
) -> None:
    """Between the last lanes of one edge and the first of the next, in a bend, is a wedge without a lane."""
    rows = straight("a", 296.14, 164.5, -1.15, 10.5, 1.708) + straight("b", 289.46, 164.15, -2.0, 6.8, 1.854)
    there = driven(tmp_path, rows, *SUBLANE)
    assert there[2.0, "a"] == pytest.approx((296.14, 164.5), abs=0.01)
    assert there[2.5, "b"] == pytest.approx((288.46, 167.55), abs=0.01)


@pytest.mark.sumo
@pytest.mark.parametrize("options", [SUBLANE, ()])
def test_cars_off_the_road_are_where_they_were_recorded(tmp_path: Path, options: tuple[str, ...]) -> None:
    rows = straight("far", -500.0, -500.0, 1.0, 0.0, 0.0) + straight("a", 296.14, 164.5, -1.15, 10.5, 1.708)
    there = driven(tmp_path, rows, *options)
    assert there[2.5, "far"] == pytest.approx((-499.5, -500.0), abs=0.01)
    assert there[2.0, "a"] == pytest.approx((296.14, 164.5), abs=0.01)


@pytest.mark.sumo
@pytest.mark.parametrize("warmup_s", [0.0, 2.0])
def test_recorded_vehicles_and_people_have_one_time_which_begins_after_the_warm_up(
    tmp_path: Path, town_file: Path, warmup_s: float
) -> None:
    (tmp_path / "town.sumocfg").write_text(
        f'<configuration><net-file value="{town_file}"/><step-length value="0.1"/></configuration>'
    )
    times = [0.1 * step for step in range(41)]
    (tmp_path / "cars.csv").write_text(
        HEADER + "".join(f"c,passenger,am,{t:.1f},{60 + 8 * t:.2f},195.2,0,8,4.5,1.8\n" for t in times)
    )
    (tmp_path / "people.csv").write_text(
        "person,time_s,x_m,y_m\n" + "".join(f"p,{t:.1f},90,{191 + t:.2f}\n" for t in times)
    )
    (tmp_path / "scenario.toml").write_text(
        f"description = 'both'\nduration_s = {warmup_s + 3.0}\nwarmup_s = {warmup_s}\n"
        "sumocfg = 'town.sumocfg'\nrecorded_vehicles = 'cars.csv'\n"
        "[egos]\ncount = 1\n[[egos.routes]]\nedges = 'am mj jb'\n"
        "[[pedestrians]]\nname = 'real'\nkind = 'trajectory'\nfile = 'people.csv'\n"
    )
    scenario = load(str(tmp_path))
    world = SumoWorld(scenario, prepare(scenario, 1, tmp_path), 1)
    try:
        seen = {round(one.time - warmup_s, 3): one for one in drive(world)}[1.5]
    finally:
        world.close()
    assert (*seen.vehicles.x, *seen.persons.y) == pytest.approx((72.0, 192.5), abs=0.01)
