"""A small town: a zebra in the middle of a road, then a junction with signals."""

import subprocess
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

import pytest
import sumo

from controllers.interface import Command, Perception, constant_command
from cosim.step.world import Snapshot
from cosim.sumo.network import Network
from cosim.sumo.network_file import read_network
from cosim.sumo.world import SumoWorld
from sumo_scenarios.library import load, prepare
from sumo_scenarios.model import Egos

NODES = """<nodes>
<node id="a" x="0" y="0"/><node id="m" x="150" y="0" type="priority"/>
<node id="j" x="300" y="0" type="traffic_light"/><node id="b" x="500" y="0"/>
<node id="s" x="300" y="-200"/><node id="n" x="300" y="200"/>
</nodes>"""
EDGES = """<edges>
<edge id="am" from="a" to="m" numLanes="2" speed="13.89"/><edge id="ma" from="m" to="a" numLanes="2" speed="13.89"/>
<edge id="mj" from="m" to="j" numLanes="3" speed="13.89"/><edge id="jm" from="j" to="m" numLanes="2" speed="13.89"/>
<edge id="jb" from="j" to="b" numLanes="2" speed="13.89"/><edge id="bj" from="b" to="j" numLanes="2" speed="13.89"/>
<edge id="js" from="j" to="s" numLanes="1" speed="8.33"/><edge id="sj" from="s" to="j" numLanes="1" speed="8.33"/>
<edge id="jn" from="j" to="n" numLanes="1" speed="8.33"/><edge id="nj" from="n" to="j" numLanes="1" speed="8.33"/>
</edges>"""
CONNECTIONS = """<connections><crossing node="m" edges="mj jm" priority="{zebra}" width="4"/></connections>"""
TYPES = '<vType id="car" vClass="passenger" sigma="0" speedDev="0"/>'


def build(folder: Path, zebra: bool = True, further: Sequence[str] = ()) -> Path:
    """Return the town's network file, made by netconvert with further options."""
    for name, text in (("n.nod", NODES), ("n.edg", EDGES), ("n.con", CONNECTIONS.format(zebra=zebra))):
        (folder / f"{name}.xml").write_text(text)
    target = folder / "town.net.xml"
    inputs: list[str | Path] = [
        "-n",
        folder / "n.nod.xml",
        "-e",
        folder / "n.edg.xml",
        "-x",
        folder / "n.con.xml",
    ]
    options: list[str | Path] = [
        "--sidewalks.guess",
        "--crossings.guess",
        "--no-turnarounds",
        *further,
        "-o",
        target,
    ]
    netconvert = Path(sumo.SUMO_HOME) / "bin" / "netconvert"
    subprocess.run([netconvert, *inputs, *options], check=True, capture_output=True)
    return target


@pytest.fixture(scope="session")
def town_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The town with a zebra."""
    return build(tmp_path_factory.mktemp("town"))


@pytest.fixture(scope="session")
def unmarked_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The town where pedestrians have to wait."""
    return build(tmp_path_factory.mktemp("unmarked"), zebra=False)


@pytest.fixture(scope="session")
def town(town_file: Path) -> Network:
    """The town, read."""
    return read_network(town_file)


@pytest.fixture(scope="session")
def braunschweig() -> Network:
    """The measured intersection that ships with SUMO."""
    folder = Path(sumo.SUMO_HOME) / "tools" / "game" / "fokr_bs_demo"
    return read_network(folder / "fokr_bs.net.xml.gz")


STRAIGHT = Egos(routes=(("am", "mj", "jb"),), count=1)
OpenWorld = Callable[..., SumoWorld]


@pytest.fixture
def open_world(tmp_path: Path, town_file: Path) -> Iterator[OpenWorld]:
    """Open worlds in the town; they are closed after the test."""
    opened: list[SumoWorld] = []

    def open_(
        demand: str,
        egos: Egos,
        *,
        network: Path = town_file,
        step_s: float = 0.1,
        duration_s: float = 60.0,
        warmup_s: float = 0.0,
        seed: int = 1,
        actuation: Literal["hybrid", "move"] = "hybrid",
        gui: bool = False,
        additional: str = "",
        processing: str = "",
        begin_s: float = 0.0,
        state: Path | None = None,
        everybody: bool = False,
    ) -> SumoWorld:
        number = len(opened)
        routes = tmp_path / f"demand{number}.rou.xml"
        routes.write_text(f"<routes>{TYPES}{demand}</routes>")
        further = tmp_path / f"further{number}.add.xml"
        further.write_text(f"<additional>{additional}</additional>")
        loaded = "" if state is None else f'<load-state value="{state}"/>'
        configuration = tmp_path / f"run{number}.sumocfg"
        configuration.write_text(
            f'<configuration><input><net-file value="{network}"/><route-files value="{routes.name}"/>'
            f'<additional-files value="{further.name}"/></input>'
            f'<time><begin value="{begin_s}"/><step-length value="{step_s}"/></time>'
            f"<processing>{processing}</processing>{loaded}</configuration>"
        )
        for other in opened:
            other.close()
        scenario = replace(
            load(str(configuration)),
            egos=egos,
            duration_s=duration_s,
            warmup_s=warmup_s,
            actuation=actuation,
            lateral_resolution_m=0.4 if actuation == "hybrid" else None,
        )
        world = SumoWorld(scenario, prepare(scenario, seed, tmp_path), seed, gui=gui, everybody=everybody)
        opened.append(world)
        return world

    yield open_
    for world in opened:
        world.close()


def keep_lane(perception: Perception, wish: float = 10.0) -> Command:
    """Follow the lane at a wished speed, and stop for nobody."""
    ego, road = perception.ego, perception.road
    curvature = float(road.curvature[min(int(0.3 * ego.speed), 20)])
    softness = min(1.0, 8.0 / max(ego.speed, 1.0))
    steering = ego.body.wheelbase * curvature - softness * (0.9 * ego.heading_error + 0.12 * ego.across)
    limit = float(road.limit[road.limit_along <= ego.body.front + ego.speed].min())
    return constant_command(0.8 * (min(wish, limit) - ego.speed), steering)


def drive(
    world: SumoWorld,
    driver: Callable[[Perception], Command] = keep_lane,
    look: Callable[[Perception], None] = lambda perception: None,
) -> list[Snapshot]:
    """Run to the end and return every snapshot."""
    snapshots = []
    while (perceptions := world.sense()) is not None:
        for perception in perceptions:
            look(perception)
            world.act(perception.ego.name, driver(perception))
        world.advance()
        snapshots.append(world.snapshot())
    return snapshots
