"""The numbers that a perception becomes, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from controllers.interface import Signal, SignalState
from controllers.outside.view import FAR, View
from tests.controllers.scenes import FRONT, Car, Walker, ego, golden, perception, straight_road, zebra


def told(seen: np.ndarray, view: View, name: str) -> float:
    return float(seen[view.place(name)])


def test_a_scene_is_told_in_numbers_from_the_front_bumper() -> None:
    view = View(pedestrians=2)
    seen = view.observe(
        perception(
            ego(8.0, across=0.5),
            straight_road(2, 0),
            walkers=[Walker(60.0, -4.0), Walker(33.55, -3.0, 0.0, 1.5, 0, True), Walker(-20.0, 0.0)],
            cars=[Car(30.0, 0.0, 6.0)],
            crossings=[zebra(31.0)],
            signals=[Signal("tl", 43.55, SignalState.RED)],
        )
    )
    expected = {
        "speed_mps": 8.0,
        "across_m": 0.5,
        "speed_limit_mps": 13.89,
        "lane_left": 1.0,
        "lane_right": 0.0,
        "route_end_m": FAR,
        "crossing_stop_line_m": 30.0 - FRONT,
        "crossing_zebra": 1.0,
        "crossing_people": 1.0,
        "signal_stop_line_m": 40.0,
        "signal_red": 1.0,
        "ahead_gap_m": 30.0 - 4.5 - FRONT,
        "ahead_speed_mps": 6.0,
        "behind_gap_m": FAR,
        "behind_speed_mps": 8.0,
        "pedestrian_1_along_m": 30.0,
        "pedestrian_1_across_m": -3.0,
        "pedestrian_1_across_speed_mps": 1.5,
        "pedestrian_1_crossing": 1.0,
        "pedestrian_2_along_m": 60.0 - FRONT,
    }
    assert {name: told(seen, view, name) for name in expected} == pytest.approx(expected, abs=1e-5)


def test_every_scene_is_within_the_bounds_and_nobody_is_zeros() -> None:
    view = View()
    for scene in golden().values():
        seen = view.observe(scene)
        assert seen.dtype == np.float32
        assert (seen >= view.low).all()
        assert (seen <= view.high).all()
    assert not view.observe(golden()["empty road"])[view.place("pedestrian_1_present") :].any()


def test_a_view_without_pedestrians_is_possible_and_a_negative_number_is_not() -> None:
    assert len(View(0)) == len(View(1)) - 7
    with pytest.raises(ValueError, match="at least 0"):
        View(-1)
