"""The smallest change back to success."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest

from analysis.search.axes import Axis, Point
from analysis.search.shrinking import Change, nearest, smallest_change

AXES = (
    Axis("gap_s", 0.0, 8.0),
    Axis("speed_mps", 0.0, 4.0),
    Axis("pause_s", 0.0, 2.0),
    Axis("side", choices=("left", "right")),
)
FAILING: Point = {"gap_s": 2.0, "speed_mps": 1.0, "pause_s": 0.5, "side": "left"}
PASSING: Point = {"gap_s": 6.0, "speed_mps": 2.0, "pause_s": 1.5, "side": "left"}


def ask(
    passes: Callable[[Point], bool], axes: Sequence[Axis] = AXES, passing: Point = PASSING
) -> tuple[Change | None, int]:
    """Return the change and how many points were tried."""
    asking = smallest_change(axes, FAILING, passing)
    tried = 0
    try:
        wanted = next(asking)
        while True:
            tried += len(wanted)
            wanted = asking.send([passes(one) for one in wanted])
    except StopIteration as stop:
        return stop.value, tried


def test_one_value_suffices_and_is_halved_to_the_boundary() -> None:
    change, tried = ask(lambda point: float(point["gap_s"]) >= 3.0)
    assert change is not None
    assert change.keys == ("gap_s",)
    # From 2 to 6 in five halvings: 4 / 32 wide, around 3.
    assert float(change.failing["gap_s"]) < 3.0 <= float(change.passing["gap_s"])
    assert float(change.passing["gap_s"]) - float(change.failing["gap_s"]) == pytest.approx(0.125)
    assert {key: change.passing[key] for key in ("speed_mps", "pause_s", "side")} == {
        key: FAILING[key] for key in ("speed_mps", "pause_s", "side")
    }
    assert tried == 3 + 5
    assert change.in_words() == "gap_s 3 instead of 2.875"


def test_of_several_values_that_suffice_the_smallest_change_is_taken() -> None:
    # 4 of 8 s, 1 of 4 m/s and 1 of 2 s: the speed changes least.
    change, _ = ask(lambda point: float(point["gap_s"]) > 5.0 or float(point["speed_mps"]) > 1.5)
    assert change is not None
    assert change.keys == ("speed_mps",)


def test_two_values_that_are_both_needed_are_found_and_the_third_is_left_alone() -> None:
    change, _ = ask(lambda point: float(point["gap_s"]) > 3.0 and float(point["speed_mps"]) > 1.2)
    assert change is not None
    assert change.keys == ("gap_s", "speed_mps")
    assert change.passing["pause_s"] == FAILING["pause_s"]


def test_of_a_choice_there_is_no_half_way() -> None:
    change, _ = ask(lambda point: point["side"] == "right", passing={**FAILING, "side": "right"})
    assert change is not None
    assert change.in_words() == "side right instead of left"


def test_points_that_are_the_same_have_no_change() -> None:
    assert ask(lambda point: True, passing=FAILING) == (None, 0)


def test_the_nearest_passing_point_is_the_way_to_go() -> None:
    far = {**PASSING, "side": "right"}
    assert nearest(AXES, FAILING, [far, PASSING]) is PASSING
    assert nearest(AXES, FAILING, []) is None
