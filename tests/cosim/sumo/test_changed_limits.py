"""Limits that change during a run are those that egos are told of, and that are recorded."""

import pytest

from controllers.interface import Perception
from sumo_scenarios.model import Egos

from .conftest import STRAIGHT, OpenWorld, drive

pytestmark = pytest.mark.sumo

SIGN = (
    '<variableSpeedSign id="sign" lanes="am_1 am_2">'
    '<step time="0" speed="5"/><step time="4" speed="9"/></variableSpeedSign>'
)
CALIBRATOR = (
    '<calibrator id="works" edge="mj" pos="0"><flow begin="0" end="60" speed="4"/></calibrator>'
    '<calibrator id="more" lane="jb_1" pos="0"><flow begin="0" end="60" speed="4"/></calibrator>'
)


def test_a_variable_speed_sign_is_told_and_recorded(open_world: OpenWorld) -> None:
    told: dict[float, float] = {}

    def look(perception: Perception) -> None:
        told[round(perception.ego.time, 3)] = float(perception.road.limit[0])

    snapshots = drive(open_world("", STRAIGHT, duration_s=6.0, additional=SIGN), look=look)
    recorded = {round(one.time, 3): one.egos[0].speed_limit for one in snapshots if one.egos}
    assert (told[3.0], told[5.0]) == (5.0, 9.0)
    assert (recorded[3.0], recorded[5.0]) == (5.0, 9.0)


def test_so_is_the_speed_of_a_calibrator_and_where_it_begins(open_world: OpenWorld) -> None:
    told: list[tuple[float, ...]] = []
    car = '<vehicle id="v" type="car" depart="0" departPos="60" departSpeed="8"><route edges="am mj jb"/></vehicle>'
    world = open_world(car, Egos(vehicles=("v",)), duration_s=3.0, additional=CALIBRATOR)
    drive(world, look=lambda perception: told.append(tuple(perception.road.limit.tolist())))
    assert told[-1][0] == pytest.approx(13.89)
    assert 4.0 in told[-1]
