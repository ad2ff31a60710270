"""A controller in the place of a recorded vehicle, among recorded road users."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.files import read_csv
from cosim.validation.stand_in import OWN, met_people
from sumo_scenarios import library
from sumo_scenarios.library import ScenarioError
from sumo_scenarios.recorded_vehicles import read_recorded_vehicles
from tests.analysis.trajectories import streets
from tests.cosim.cli.commands import ended
from tests.cosim.running.test_no_room import room
from tests.cosim.tracks import networks

HEADER = "vehicle,class,edge,time_s,x_m,y_m,heading_rad,speed_mps,length_m,width_m\n"


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a drive behind a recorded car, towards one and before a pedestrian."""
    folder = tmp_path_factory.mktemp("stand-in")
    # A spreadsheet would take the name of the edge for a formula.
    networks.street(folder, edges=networks.EDGES.replace('"w1"', '"-w1"'))
    networks.configure(folder)
    # SUMO takes no blanks in names.
    tracks = [
        streets.car("lead", 10.0, begin_s=8.0, duration_s=14.0),
        streets.car("my own", 10.0, begin_s=10.0, duration_s=14.0),
        streets.track("opposite", "car", (180.0, 1.6), (-9.0, 0.0), 9.0, 15.0),
        streets.walker("walker", 14.4, 1.3),
    ]
    streets.write(folder / "tracks.csv", tracks)
    out = folder / "out"
    done = ended(
        *("stand-in", folder / "street.sumocfg", "--tracks", folder / "tracks.csv"),
        *("--vehicle", "my own", "--controller", "aeb", "--out", out),
    )
    assert "1 encounters, 0 in which the people could react" in done.stdout
    return out


@pytest.mark.long
@pytest.mark.sumo
def test_everybody_else_is_where_they_were_recorded(driven: Path) -> None:
    seen = pd.read_parquet(driven / "run" / "neighbours.parquet")
    recorded = pd.read_csv(driven / "scenario" / "vehicles.csv")
    for name in ("lead", "opposite"):
        mine, there = recorded[recorded["vehicle"] == name], seen[seen["object_id"] == name]
        assert len(there) > 100
        assert np.interp(there["time_s"], mine["time_s"], mine["x_m"]) == pytest.approx(
            there["x_m"].to_numpy(), abs=0.01
        )
        assert there["y_m"].to_numpy() == pytest.approx(mine["y_m"].iloc[0], abs=0.01)
    walker = seen[seen["object_kind"] == "pedestrian"]
    assert walker["x_m"].to_numpy() == pytest.approx(100.0, abs=1e-3)
    assert np.diff(walker["y_m"]) == pytest.approx(0.13, abs=2e-3)


@pytest.mark.long
@pytest.mark.sumo
def test_the_ego_departs_as_the_recorded_vehicle_did_and_drives_by_itself(driven: Path) -> None:
    egos = pd.read_parquet(driven / "run" / "egos.parquet")
    assert set(egos["ego_id"]) == {"my_own"}
    assert egos["speed_mps"].iloc[0] == pytest.approx(10.0, abs=0.5)
    assert egos["speed_mps"].min() < 5.0, "it brakes for the pedestrian, as the recorded one did not"


@pytest.mark.long
@pytest.mark.sumo
def test_who_met_another_ego_than_they_had_reacted_to_is_marked(driven: Path) -> None:
    (row,) = read_csv(driven / "stand_in.csv")
    assert (row["could_react"], float(row["off_m"]) > 2.0) == ("0", True)


@pytest.mark.long
@pytest.mark.sumo
def test_an_ego_departs_although_sumo_would_find_it_too_near_to_the_car_ahead(tmp_path: Path) -> None:
    networks.street(tmp_path)
    networks.configure(tmp_path)
    # When it comes into view at 10 m/s, the other car is 6.4 m ahead, at 4 m/s, and stays 3 s more.
    tracks = [
        streets.car("lead", 4.0, begin_s=8.4, duration_s=4.6),
        streets.car("own", 10.0, begin_s=10.0, duration_s=8.0),
    ]
    streets.write(tmp_path / "tracks.csv", tracks)
    ended(
        *("stand-in", tmp_path / "street.sumocfg", "--tracks", tmp_path / "tracks.csv"),
        *("--vehicle", "own", "--controller", "aeb", "--out", tmp_path / "out"),
    )
    egos = pd.read_parquet(tmp_path / "out" / "run" / "egos.parquet")
    assert egos["time_s"].iloc[0] == pytest.approx(5.0, abs=0.21), "5 s after the scenario's begin"
    assert egos["speed_mps"].iloc[0] == pytest.approx(10.0, abs=1.0)


PLAIN = """description = "street"
duration_s = 60.0
[network]
nodes = "n.nod.xml"
edges = "e.edg.xml"
connections = ["c.con.xml"]
[demand]
routes = ["none.rou.xml"]
additional = ["types.add.xml"]
vehicles_per_hour = 1.0
pedestrians_per_hour = 1.0
[[egos.routes]]
edges = "e1 e2"
"""


@pytest.mark.long
@pytest.mark.sumo
def test_the_written_scenario_runs_afterwards_whatever_the_vehicle_is_called(tmp_path: Path) -> None:
    networks.street(tmp_path)
    (tmp_path / "scenario.toml").write_text(PLAIN)
    (tmp_path / "none.rou.xml").write_text("<routes/>")
    (tmp_path / "types.add.xml").write_text('<additional><vType id="a"/></additional>')
    name = 'my "own" \\ car'
    streets.write(tmp_path / "tracks.csv", [streets.car(name, 10.0, begin_s=1.0, duration_s=8.0)])
    ended(
        *("stand-in", tmp_path, "--tracks", tmp_path / "tracks.csv", "--vehicle", name),
        *("--controller", "constant_speed", "--out", tmp_path / "out"),
    )
    written = tmp_path / "out" / "scenario"
    assert library.load(str(written)).description.endswith(f"in the place of {name}")
    ended("run", written, "--controller", "constant_speed", "--out", tmp_path / "again")


@pytest.mark.sumo
def test_a_drive_with_too_little_recorded_says_why(tmp_path: Path) -> None:
    networks.street(tmp_path)
    networks.configure(tmp_path)
    streets.write(tmp_path / "tracks.csv", [streets.car("own", 10.0, begin_s=1.0, duration_s=8.0)])
    with room(20_000):
        done = ended(
            *("stand-in", tmp_path / "street.sumocfg", "--tracks", tmp_path / "tracks.csv"),
            *("--vehicle", "own", "--controller", "constant_speed", "--out", tmp_path / "out"),
            code=3,
        )
    assert done.stderr == "cosim: the recording could not be written: File too large\n"


def test_an_ego_that_drives_as_recorded_is_met_by_people_who_could_react(tmp_path: Path) -> None:
    (tmp_path / OWN).write_text("time_s,x_m,y_m\n0.0,0.0,0.0\n10.0,100.0,0.0\n")
    time = np.arange(50.0, 60.0, 0.1)
    egos = pd.DataFrame({"time_s": time, "front_x_m": 10.0 * (time - 50.0) + 2.25, "front_y_m": 1.0})
    egos = egos.assign(length_m=4.5, heading_rad=0.0)
    row = {"encounter_id": "1", "ped_id": "p", "t_end_s": "55", "min_dist_m": "3", "severity": "none"}
    (met,) = met_people(tmp_path, egos, [row])
    assert (met.number, met.pedestrian, met.distance) == (1, "p", 3.0)
    assert met.off_m == pytest.approx(1.0)
    assert met.could_react


@pytest.mark.long
def test_bad_recordings_and_vehicles_are_refused(tmp_path: Path, driven: Path) -> None:
    site = driven.parent
    said = ended(
        *("stand-in", site / "street.sumocfg", "--tracks", site / "tracks.csv"),
        *("--vehicle", "nobody", "--out", tmp_path / "out"),
        code=2,
    ).stderr
    assert "'nobody': no such vehicle in the tracks" in said
    assert not (tmp_path / "out").exists()  # so that the mended command finds its folder free
    path = tmp_path / "vehicles.csv"
    path.write_text(HEADER + "a,passenger,e1,1,0,0,0,5,4.5,1.8\na,passenger,e1,0.5,0,0,0,5,4.5,1.8\n")
    with pytest.raises(ScenarioError, match=r"row 3: time_s of 'a' is 0.5, expected time to go on"):
        read_recorded_vehicles(path)
    path.write_text(HEADER.replace("width_m", "wide") + "a,passenger,e1,1,0,0,0,5,4.5,1.8\n")
    with pytest.raises(ScenarioError, match="column 'width_m' is missing"):
        read_recorded_vehicles(path)
    path.write_text(HEADER + "a,passenger,e1,soon,0,0,0,5,4.5,1.8\n")
    with pytest.raises(ScenarioError, match="row 2: time_s is 'soon'; expected a number"):
        read_recorded_vehicles(path)
