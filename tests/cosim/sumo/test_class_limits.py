"""Limits of single vehicle classes on an edge hold there only, for the ego that has that class."""

from pathlib import Path

import pytest

from controllers.interface import Perception
from cosim.sumo.network_file import read_network
from sumo_scenarios.model import Egos

from .conftest import OpenWorld, drive

pytestmark = pytest.mark.sumo

TYPES = (
    '<type id="slow"><restriction vClass="passenger" speed="7"/><restriction vClass="bicycle" speed="6"/></type>'
    '<type id="fast"><restriction vClass="passenger" speed="20"/></type>'
)
SIGN = '<variableSpeedSign id="sign" lanes="am_1 am_2"><step time="0" speed="5"/></variableSpeedSign>'


@pytest.fixture(scope="module")
def restricted(tmp_path_factory: pytest.TempPathFactory, town_file: Path) -> Path:
    """The town with other limits for cars: lower ones on the first edge, higher ones on the second."""
    text = town_file.read_text()
    for edge, kind in (("am", "slow"), ("mj", "fast")):
        assert text.count(f'<edge id="{edge}" ') == 1
        text = text.replace(f'<edge id="{edge}" ', f'<edge id="{edge}" type="{kind}" ')
    file = tmp_path_factory.mktemp("restricted") / "town.net.xml"
    file.write_text(text.replace("<edge ", f"{TYPES}<edge ", 1))
    return file


@pytest.mark.parametrize(
    ("kind", "sign", "on_am", "on_mj", "on_jb"),
    [
        ('vClass="passenger"', "", 7.0, 20.0, 13.89),
        ('vClass="passenger"', SIGN, 5.0, 20.0, 13.89),
        ('vClass="delivery"', "", 13.89, 13.89, 13.89),
        ('vClass="bicycle"', "", 20 / 3.6, 20 / 3.6, 20 / 3.6),
    ],
)
def test_an_ego_is_told_the_limits_of_its_class(
    open_world: OpenWorld, restricted: Path, kind: str, sign: str, on_am: float, on_mj: float, on_jb: float
) -> None:
    demand = (
        f'<vType id="its" {kind} speedDev="0" speedFactor="1.1"/>'
        '<vehicle id="v" type="its" depart="0" departPos="100" departLane="1"><route edges="am mj jb"/></vehicle>'
    )
    told: list[list[float]] = []
    egos = Egos(vehicles=("v",))
    world = open_world(demand, egos, network=restricted, duration_s=1.0, additional=sign)

    def look(perception: Perception) -> None:
        road = perception.road
        told.append([float(road.limit[road.limit_along.searchsorted(x, "right") - 1]) for x in (0, 80, 240)])

    snapshots = drive(world, look=look)
    assert told[0] == pytest.approx([on_am, on_mj, on_jb])
    assert snapshots[-1].egos[0].speed_limit == pytest.approx(on_am)


def test_edges_without_a_type_have_no_such_limits(restricted: Path) -> None:
    lanes = read_network(restricted).lanes
    assert lanes["am_1"].class_speeds == {"passenger": 7.0, "bicycle": 6.0}
    assert not lanes["jb_1"].class_speeds
