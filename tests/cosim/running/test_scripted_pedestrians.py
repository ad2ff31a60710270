"""Whole runs with pedestrians whom SUMO does not have: recorded, judged, and the same for every controller."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cosim.cli import main
from sumo_scenarios.library import LIBRARY
from tests.cosim.cli.test_cli import refused

pytestmark = pytest.mark.sumo

ROAD = f"""
description = "mine"
duration_s = 40.0
warmup_s = 2.0
step_s = 0.1
[network]
nodes = "{LIBRARY}/jaywalk_arterial/nodes.nod.xml"
edges = "{LIBRARY}/jaywalk_arterial/edges.edg.xml"
types = "{LIBRARY}/jaywalk_arterial/types.typ.xml"
[demand]
routes = ["{LIBRARY}/jaywalk_arterial/demand.rou.xml"]
additional = ["{LIBRARY}/road_users/vehicles.add.xml", "{LIBRARY}/road_users/pedestrians.add.xml"]
vehicles_per_hour = 200.0
pedestrians_per_hour = 100.0
[rates]
vehicles = {{ of = "vehicles_per_hour", share = 1.0 }}
sidewalk_pedestrians = {{ of = "pedestrians_per_hour", share = 0.1 }}
[egos]
count = 1
depart_lane = "1"
[[egos.routes]]
edges = "east"
"""
# The road runs east; the right lane's middle is at y = −4.88 m, the kerbs at −6.5 and 6.5 m.
LINE = 'kind = "line"\nfrom_m = [{x}.0, -7.0]\nto_m = [{x}.0, 7.0]\nspeed_mps = 1.4\nstart = {{ ego_arrival_s = 4.0 }}\n'
BEHAVIOURS = {
    "steady": LINE.format(x=150),
    "hesitating": LINE.format(x=150) + 'manners = [{ kind = "hesitating", after_m = 3.0, pause_s = 2.0 }]\n',
    "running": LINE.format(x=150) + 'manners = [{ kind = "running", speed_mps = 3.0, ego_within_s = 3.0 }]\n',
    "turning_back": LINE.format(x=150)
    + 'manners = [{ kind = "turning_back", after_m = 2.5, pause_s = 0.5 }]\n',
    "social_force": LINE.format(x=150) + 'manners = [{ kind = "social_force" }]\n',
    "group": LINE.format(x=150) + "group = { size = 3 }\n",
    "stopping": LINE.format(x=150) + "stop_after_m = 0.4\nstay_s = 5.0\n",
    "along": 'kind = "line"\nlane = "east_1"\nfrom_m = [150.0, 0.5]\nto_m = [250.0, 0.5]\nspeed_mps = 1.4\n'
    "start = { ego_distance_m = 60.0 }\n",
    "protocol": 'kind = "line"\nlane = "east_1"\nfrom_m = [200.0, -4.0]\nto_m = [200.0, 4.0]\nspeed_mps = 1.389\n'
    "acceleration_distance_m = 1.0\nstart = { overlap = 0.5, ego_speed_mps = 13.89 }\n",
    "jaywalk": 'kind = "jaywalk"\nedge = "east"\nopposite = "west"\nsection_m = [100.0, 300.0]\nspeed_mps = 1.4\n'
    "start = { per_hour = 1800.0, accepted_gap_s = 4.0 }\ngoal_along_m = { uniform = [-20.0, 20.0] }\n",
    "trajectory": 'kind = "trajectory"\nfile = "recorded.csv"\n',
}
# All over the road and whoever comes.
BLIND = (
    BEHAVIOURS["jaywalk"].replace(", accepted_gap_s = 4.0", "").replace("1.4", "{ uniform = [0.8, 2.0] }")
    + 'manners = [{ kind = "steady" }, { kind = "hesitating", after_m = { uniform = [0.5, 9.0] }, pause_s = 1.0 }]\n'
)
CONTROLLERS = ("vo_mpc", "aeb", "sumo")


def recording(folder: Path, seed: int = 3) -> list[list[float]]:
    """Write the track of somebody who wanders about the road, in uneven steps, and return it."""
    generator = np.random.default_rng(seed)
    times = np.cumsum(generator.uniform(0.04, 0.5, 120)).round(3)
    place = np.array([120.0, -6.0]) + np.cumsum(generator.normal([0.1, 0.08], 0.12, (120, 2)), axis=0)
    rows: list[list[float]] = np.column_stack([times, place.round(4)]).tolist()
    with (folder / "recorded.csv").open("w", newline="") as file:
        csv.writer(file).writerows([["time_s", "x_m", "y_m"], *rows])
    return rows


def scenario(folder: Path, *rows: str, road: str = ROAD) -> Path:
    """Write a scenario with these rows of [[pedestrians]], named by their number."""
    tables = "".join(f'[[pedestrians]]\nname = "p{number}"\n{row}' for number, row in enumerate(rows))
    (folder / "scenario.toml").write_text(road + tables)
    return folder


def people(out: Path) -> pd.DataFrame:
    """Return the rows of scripted pedestrians."""
    table = pd.read_parquet(out / "neighbours.parquet")
    return table[table.object_type.isin(["line", "jaywalk", "crossing", "trajectory"])]


def ran(folder: Path, controller: str, *more: str) -> Path:
    out = folder / f"out-{controller}-{len(list(folder.glob('out-*')))}"
    assert main(["run", str(folder), "--controller", controller, "--out", str(out), *more]) == 0
    return out


@pytest.mark.long
@pytest.mark.parametrize("step_s", ["0.05", "0.1", "0.25"])
def test_a_recorded_trajectory_replays_to_the_millimetre(tmp_path: Path, step_s: str) -> None:
    rows = np.array(recording(tmp_path))
    out = ran(
        scenario(tmp_path, BEHAVIOURS["trajectory"]),
        "sumo",
        "--set",
        f"step_s={step_s}",
        "--duration-s",
        "16",
    )
    found = people(out)
    local = found.time_s.to_numpy() - 2.0  # the warm-up
    off = np.hypot(
        found.x_m - np.interp(local, rows[:, 0], rows[:, 1]),
        found.y_m - np.interp(local, rows[:, 0], rows[:, 2]),
    )
    assert off.max() < 1e-6
    # The pedestrian is present at every step while the ego is within 80 m.
    assert np.diff(found.time_s) == pytest.approx(float(step_s), abs=1e-6)
    assert len(found) > 10.0 / float(step_s)


@pytest.fixture(scope="module")
def together(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return what gives the run of a controller among all behaviours, and people who do not look."""
    folder = tmp_path_factory.mktemp("together")
    recording(folder)
    scenario(folder, *BEHAVIOURS.values(), BLIND)
    return cache(lambda controller: ran(folder, controller, "--duration-s", "28"))


@pytest.mark.long
def test_pedestrians_who_do_not_look_are_the_same_for_every_controller(
    together: Callable[[str], Path],
) -> None:
    blind = (f"p{list(BEHAVIOURS).index('trajectory')}", f"p{len(BEHAVIOURS)}")
    tracks = []
    for controller in CONTROLLERS:
        found = people(together(controller))
        found = found[found.object_id.str.partition("#")[0].isin(blind)]
        keys = zip(found.object_id.tolist(), found.time_s.round(3).tolist(), strict=True)
        places = zip(found.x_m.tolist(), found.y_m.tolist(), strict=True)
        tracks.append(dict(zip(keys, places, strict=True)))
    first = tracks[0]
    for other in tracks[1:]:
        # Only who is near the ego is recorded, and that depends on the controller.
        both = first.keys() & other.keys()
        assert len(both) > 300
        assert all(first[key] == other[key] for key in both)
    assert len({name for name, _ in first}) > 5


@pytest.mark.long
def test_the_same_run_twice_has_the_same_bytes_and_another_seed_other_people(tmp_path: Path) -> None:
    folder = scenario(tmp_path, BEHAVIOURS["jaywalk"] + 'manners = [{ kind = "social_force" }]\n')
    one, two = (ran(folder, "aeb", "--duration-s", "18") for _ in range(2))
    other = ran(folder, "aeb", "--duration-s", "18", "--seed", "2")
    assert people(one).object_id.nunique() > 3
    for name in ("neighbours.parquet", "egos.parquet", "encounters.csv"):
        assert (one / name).read_bytes() == (two / name).read_bytes()
    assert not people(one).x_m.reset_index(drop=True).equals(people(other).x_m.reset_index(drop=True))


@pytest.mark.long
@pytest.mark.parametrize("controller", CONTROLLERS)
def test_all_behaviours_together_end_well_with_a_controller(
    together: Callable[[str], Path], controller: str
) -> None:
    out = together(controller)
    seen = {name.partition("#")[0] for name in people(out).object_id}
    assert seen == {f"p{number}" for number in range(len(BEHAVIOURS) + 1)}
    encounters = pd.read_csv(out / "encounters.csv")
    assert len(encounters) > 0
    assert encounters.crossing_id.isna().all()


@pytest.mark.slow
@pytest.mark.parametrize("controller", CONTROLLERS)
@pytest.mark.parametrize("behaviour", BEHAVIOURS)
def test_every_behaviour_ends_well_with_every_kind_of_controller(
    tmp_path: Path, behaviour: str, controller: str
) -> None:
    recording(tmp_path)
    found = people(ran(scenario(tmp_path, BEHAVIOURS[behaviour]), controller))
    speed = np.hypot(found.x_speed_mps, found.y_speed_mps)
    assert speed.max() > 0.5
    fastest = 3.1 if behaviour in ("running", "social_force", "trajectory") else 1.5
    assert behaviour == "trajectory" or speed.max() < fastest


@pytest.mark.long
def test_an_ego_that_looks_at_nobody_is_met_where_the_row_says(tmp_path: Path) -> None:
    """The geometry of a protocol, through SUMO and the recorder: 50 % of the front at 50 km/h."""
    road = ROAD.replace("vehicles_per_hour = 200.0", "vehicles_per_hour = 0.0")
    for overlap in (0.25, 0.5):
        row = (
            BEHAVIOURS["protocol"].replace("overlap = 0.5", f"overlap = {overlap}").replace("200.0", "100.0")
        )
        out = ran(scenario(tmp_path, row, road=road), "constant_speed", "--duration-s", "15")
        egos, found = pd.read_parquet(out / "egos.parquet"), people(out)
        both = egos.merge(found, on="time_s")
        gap = 100.0 - 0.25 - both.front_x_m.to_numpy()
        after = int(np.argmax(gap <= 0.0))
        share = gap[after - 1] / (gap[after - 1] - gap[after])
        y = np.interp(share, [0.0, 1.0], both.y_m.to_numpy()[after - 1 : after + 1])
        middle = np.interp(share, [0.0, 1.0], both.front_y_m.to_numpy()[after - 1 : after + 1])
        assert y == pytest.approx(middle - 0.9 + overlap * 1.8, abs=0.02)
        assert both.speed_mps[after] * 3.6 == pytest.approx(13.89 * 3.6, abs=0.1)
        assert pd.read_csv(out / "encounters.csv").collision.tolist() == [1]
        # A controller that looks does not touch them: pedestrians unknown to SUMO are perceived.
        seeing = ran(tmp_path, "aeb", "--duration-s", "15")
        assert pd.read_csv(seeing / "encounters.csv").collision.tolist() == [0]


SIGNALS = f"""
description = "mine"
duration_s = 180.0
warmup_s = 20.0
step_s = 0.1
[network]
nodes = "{LIBRARY}/signalised_junction/nodes.nod.xml"
edges = "{LIBRARY}/signalised_junction/edges.edg.xml"
types = "{LIBRARY}/signalised_junction/types.typ.xml"
connections = ["{LIBRARY}/signalised_junction/connections.con.xml"]
[demand]
routes = ["empty.rou.xml"]
[egos]
count = 1
[[egos.routes]]
edges = "south_in south_approach north_exit north_out"
"""
RED = 'kind = "crossing"\ncrossing = "{crossing}"\nspeed_mps = 1.4\nside = "first"\nstart = {{ time_s = 30.0, signal = "{shows}" }}\n'


@pytest.mark.long
def test_somebody_walks_at_red_and_somebody_at_green(tmp_path: Path) -> None:
    from cosim.running import compose
    from cosim.running.request import RunRequest

    (tmp_path / "empty.rou.xml").write_text("<routes/>")
    composition = compose.compose(RunRequest(str(scenario(tmp_path, road=SIGNALS)), "sumo"))
    network = composition.world.network  # type: ignore[attr-defined]  # a SumoWorld
    crossing = next(c for c in network.crossings.values() if "south_approach" in c.edges)
    composition.close()
    rows = [RED.format(crossing=crossing.name, shows=shows) for shows in ("red", "green")]
    composition = compose.compose(RunRequest(str(scenario(tmp_path, *rows, road=SIGNALS)), "sumo"))
    sumo = composition.world._sumo  # type: ignore[attr-defined]
    begun: dict[str, bool] = {}
    phases: dict[str, list[str]] = {"p0": [], "p1": []}
    try:
        world = composition.world
        while (perceptions := world.sense()) is not None:
            for perception in perceptions:
                driver = composition.drivers[perception.ego.name]
                world.act(perception.ego.name, driver.plan(perception, driver.decide(perception)).command)
            letters = sumo.trafficlight.getRedYellowGreenState(crossing.signal)
            green = any(letters[index] in "gG" for index in crossing.signal_indices)
            world.advance()
            persons = world.snapshot().persons
            for row, name in enumerate(persons.names):
                phases[name].append(persons.phase[row])
                if name not in begun and math.hypot(persons.x_speed[row], persons.y_speed[row]) > 0.0:
                    begun[name] = green
                assert persons.crossing[row] in (None, crossing.name)
            if len(begun) == 2 and all("crossing" in found for found in phases.values()):
                break
    finally:
        composition.close()
    assert begun == {"p0": False, "p1": True}
    for found in phases.values():
        assert found[0] == "waiting"
        assert "crossing" in found


@pytest.mark.parametrize(
    ("row", "words"),
    [
        (BEHAVIOURS["steady"].replace("line", "dance"), ["scenario.toml", "row 1", "dance"]),
        (BEHAVIOURS["along"].replace("east_1", "east_7"), ["no lane 'east_7'"]),
        (BEHAVIOURS["jaywalk"].replace('"west"', '"north"'), ["no edge 'north'"]),
        (BEHAVIOURS["trajectory"], ["recorded.csv", "row 3", "expected time to go on"]),
        (
            BEHAVIOURS["trajectory"].replace("recorded", "outside"),
            ["outside.csv", "at 2 s", "leaves the network"],
        ),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], row: str, words: list[str]
) -> None:
    (tmp_path / "recorded.csv").write_text("time_s,x_m,y_m\n1,100,0\n0.5,100,1\n")
    # 20 m beside the road is near enough, 30 m is not: the sidewalk ends at y = 9 m.
    (tmp_path / "outside.csv").write_text("time_s,x_m,y_m\n0,100,28\n2,100,40\n")
    line = refused(capsys, "run", str(scenario(tmp_path, row)), "--out", str(tmp_path / "out"))
    assert all(word in line for word in words)
    assert not (tmp_path / "out").exists()
