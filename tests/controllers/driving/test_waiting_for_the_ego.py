"""Who stands at a merge and waits for the ego."""

from __future__ import annotations

import pytest

from controllers.driving.waiting_for_the_ego import LONG_PATIENCE, PATIENCE, WaitingForTheEgo, in_queue
from controllers.interface import Signal, SignalState
from tests.controllers.scenes import Car, Walker, ego, perception

MERGING = Car(9.0, -1.4, length=2.0, width=0.7)


def _waits_from(*cars: Car, people: tuple[Walker, ...] = (), line: float = 60.0) -> float:
    """Return when the first car is taken for one that waits for the ego; inf for never within 30 s [s]."""
    watched = WaitingForTheEgo()
    for second in range(30):
        state = ego(0.0, time=float(second))
        seen = perception(state, None, people, cars, signals=[Signal("tl", line, SignalState.RED)])
        if watched.look(seen)[0]:
            return float(second)
    return float("inf")


def test_whoever_stands_with_nothing_ahead_waits_for_the_ego() -> None:
    assert _waits_from(MERGING) == PATIENCE


@pytest.mark.parametrize(
    "because",
    [{"cars": (Car(15.0, -1.4),)}, {"people": (Walker(11.0, -2.0),)}, {"line": 9.5}],
    ids=["vehicle", "pedestrian", "light"],
)
def test_something_ahead_may_be_why_for_longer(because: dict[str, object]) -> None:
    cars = because.pop("cars", ())
    assert _waits_from(MERGING, *cars, **because) == LONG_PATIENCE  # type: ignore[misc, arg-type]


def test_whoever_drives_or_is_behind_or_comes_across_does_not() -> None:
    for car in (Car(9.0, -1.4, 1.0), Car(-1.0, -1.4), Car(9.0, -1.4, heading_error=1.5)):
        assert _waits_from(car) == float("inf")


def test_a_queue_is_in_the_lane() -> None:
    seen = perception(ego(0.0), None, (), (MERGING, Car(9.0, 0.3)))
    assert in_queue(seen, 0.0).tolist() == [False, True]
