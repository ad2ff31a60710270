"""Why SUMO's state differs from the plant's."""

from dataclasses import dataclass
from typing import Any, cast

import pytest

from analysis.recording.columns import INTERVENTIONS
from cosim.sumo.intervention import Cause, cause_of
from cosim.sumo.placement import Executed, Placement
from sumo_scenarios.model import Egos

from .conftest import OpenWorld, drive


@dataclass(frozen=True)
class Told:
    """What is known of a vehicle that was told to drive 5 m/s."""

    is_astray: bool = False
    moved_by: float = 0.0

    def asked_speed(self, name: str) -> float:
        return 5.0

    def astray(self, name: str) -> bool:
        return self.is_astray

    def strayed(self, name: str) -> float:
        return self.moved_by


def cause(told: Told, away: float = 0.0, speed: float = 5.0, lane: str = "a_0", in_bend: bool = False) -> Any:
    executed = Executed(away, 0.0, speed, lane)
    return cause_of(cast(Placement, told), "ego", (0.0, 0.0), executed, in_bend)


def test_a_step_that_went_as_it_should_has_none() -> None:
    assert cause(Told(), away=0.015, speed=5.09) is None
    assert cause(Told(moved_by=0.01), away=0.01, in_bend=True) is None


@pytest.mark.parametrize(
    ("told", "seen", "expected"),
    [
        (Told(is_astray=True), {}, Cause.WAY_LOST),
        (Told(is_astray=True), {"in_bend": True}, Cause.TIGHT_BEND),
        (Told(moved_by=1.0), {"away": 1.0, "in_bend": True}, Cause.TIGHT_BEND),
        (Told(moved_by=1.0), {"away": 1.0}, Cause.OFF_LANE),
        (Told(), {"away": 1.0, "lane": ""}, Cause.OFF_LANE),
        (Told(), {"lane": ""}, Cause.OFF_LANE),
        (Told(), {"away": 0.5, "speed": 2.0}, Cause.HELD),
        (Told(), {"away": 0.5}, Cause.POSITION),
        (Told(), {"away": 0.5, "in_bend": True}, Cause.POSITION),
        (Told(), {"speed": 6.0}, Cause.SPEED),
    ],
)
def test_every_other_step_has_one(told: Told, seen: dict[str, Any], expected: Cause) -> None:
    assert cause(told, **seen) is expected


def test_the_causes_are_those_that_the_analysis_counts() -> None:
    assert set(Cause) == set(INTERVENTIONS)


@pytest.mark.sumo
def test_an_ego_on_a_lane_that_was_closed_to_it_is_on_none(open_world: OpenWorld) -> None:
    """SUMO puts it where it was told, on no lane: nobody sees it there."""
    closed = (
        '<rerouter id="works" edges="am"><interval begin="1" end="60">'
        '<closingLaneReroute id="mj_1" disallow="all"/><closingLaneReroute id="mj_2" disallow="all"/>'
        "</interval></rerouter>"
    )
    car = '<vehicle id="v" type="car" depart="0" departPos="120" departSpeed="8"><route edges="am mj jb"/></vehicle>'
    world = open_world(car, Egos(vehicles=("v",)), duration_s=8.0, additional=closed)
    egos = [one.egos[0] for one in drive(world) if one.egos]
    nowhere = [one for one in egos if not one.lane]
    assert nowhere
    assert {one.intervention_cause for one in nowhere} == {Cause.OFF_LANE}
