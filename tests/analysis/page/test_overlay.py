"""What of a controller's overlay is drawn, and where."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from analysis.page.overlay import drawings, to_world

EAST = [value for x in range(90, 221, 5) for value in (float(x), 2.0)]
"""The axis of an ego whose rear axle is at (100, 2), as the recorder writes it."""


def drawn(horizon: int = 4, **values: list[float | None]) -> list[dict[str, object]]:
    return drawings(json.dumps({"reference_line_m": EAST, **values}), horizon)


def test_points_of_conflict_carry_the_times_at_which_somebody_is_in_the_way() -> None:
    (one,) = drawn(
        conflict_along=[20.0], conflict_across=[-1.0], conflict_enter_s=[2.31], conflict_leave_s=[4.0]
    )
    assert one == {"name": "conflict", "kind": "points", "at": [120.0, 1.0], "label": ["2.3–4.0 s"]}


def test_a_path_is_a_line_and_several_of_the_plans_length_are_several_lines() -> None:
    two = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0]
    lines = drawn(horizon=2, candidate_paths_m=list(two))
    assert [one["kind"] for one in lines] == ["line", "line"]
    assert [one["at"] for one in lines] == [[100.0, 2.0, 101.0, 2.0], [100.0, 3.0, 101.0, 3.0]]
    assert len(drawn(horizon=3, candidate_0=list(two))) == 1


def test_ellipses_are_closed_outlines_of_seventeen_points_each() -> None:
    turn = np.linspace(0.0, 2.0 * math.pi, 17)
    ring = np.column_stack((np.cos(turn), np.sin(turn))).ravel().tolist()
    found = drawn(obstacle_ellipses_m=[*ring, *ring])
    assert [(one["kind"], one["name"]) for one in found] == [("outline", "obstacle ellipses")] * 2


def test_undefined_points_and_times_are_not_drawn_and_an_old_recording_draws_nothing() -> None:
    assert drawn(obstacles=[None, 1.0], some_time_s=[1.0, 2.0]) == []
    assert drawings(json.dumps({"path": [0.0, 0.0, 1.0, 0.0]}), 2) == []
    assert drawings("", 2) == []


@pytest.mark.parametrize(("along", "across"), [(0.0, 0.0), (33.0, -2.0), (70.0, 3.0), (-8.0, 1.0)])
def test_in_a_bend_a_point_lies_on_the_circle_that_the_axis_follows(along: float, across: float) -> None:
    radius = 60.0
    turn = np.arange(-10.0, 121.0, 5.0) / radius
    axis = np.column_stack((radius * np.sin(turn), radius * (1.0 - np.cos(turn))))
    ((x, y),) = to_world(np.array([[along, across]]), axis)
    at = along / radius
    exact = ((radius - across) * math.sin(at), radius - (radius - across) * math.cos(at))
    # A chord of 5 m lies 5² / (8 · 60) = 0.052 m inside its arc.
    assert math.hypot(x - exact[0], y - exact[1]) < 0.13
