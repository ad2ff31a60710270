"""Why SUMO's state differs from the plant's."""

from dataclasses import dataclass
from typing import Any, cast

import pytest

from analysis.recording.columns import INTERVENTIONS
from cosim.sumo.intervention import Cause, cause_of
from cosim.sumo.placement import Executed, Placement


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
