"""Corners of a polyline made round."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analysis.polylines import arc_lengths
from cosim.arrays import FloatArray
from cosim.sumo.corners import DEVIATION, rounded
from cosim.sumo.path import Path


def turn(radius: float, angle: float, chords: int) -> FloatArray:
    """Return a turn between two straights as SUMO draws it, with points on the true curve."""
    angles = np.linspace(0.0, angle, chords + 1)
    circle = radius * np.column_stack([np.sin(angles), 1.0 - np.cos(angles)])
    onward = circle[-1] + 40.0 * np.array([math.cos(angle), math.sin(angle)])
    return np.concatenate([[[-40.0, 0.0]], circle, [onward]])


@pytest.mark.parametrize("radius", [8.0, 12.0, 20.0])
def test_the_chords_of_a_turn_become_a_curve_about_as_tight_as_the_turn(radius: float) -> None:
    drawn = turn(radius, 0.5 * math.pi, 4)
    assert np.abs(Path.rounded(drawn).curvature).max() < 1.2 / radius
    # SUMO's chords themselves are smoothed within a few metres only.
    assert radius < 12.0 or np.abs(Path(drawn).curvature).max() > 1.3 / radius


def test_a_slight_corner_between_long_chords_slows_nobody_down() -> None:
    line = np.array([[0.0, 0.0], [40.0, 0.0], [40.0 + 40.0 * math.cos(0.17), 40.0 * math.sin(0.17)]])
    comfortable = 3.0
    assert math.sqrt(comfortable / np.abs(Path.rounded(line).curvature).max()) > 13.9
    assert math.sqrt(comfortable / np.abs(Path(line).curvature).max()) < 9.0


def test_what_is_straight_stays_as_it_is() -> None:
    line = np.array([[0.0, 0.0], [30.0, 0.1], [70.0, 0.3]])
    knots = arc_lengths(line)
    same, stations = rounded(line, knots)
    assert same is line
    assert stations is knots


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.floats(0.2, 40.0), st.floats(-2.2, 2.2)), min_size=2, max_size=12))
def test_any_line_keeps_its_ends_and_stations_and_is_left_by_little(
    chords: list[tuple[float, float]],
) -> None:
    lengths, turns = np.array(chords).T
    heading = np.cumsum(turns)
    steps = lengths[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    line = np.concatenate([[[0.0, 0.0]], np.cumsum(steps, axis=0)])
    points, knots = rounded(line, arc_lengths(line))
    assert points[[0, -1]] == pytest.approx(line[[0, -1]])
    assert knots[[0, -1]] == pytest.approx(arc_lengths(line)[[0, -1]])
    assert (np.diff(knots) > 0.0).all()
    starts, along = line[:-1], np.diff(line, axis=0)
    rest = points[:, None, :] - starts
    share = np.clip((rest * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
    away = np.hypot(*np.moveaxis(rest - share[..., None] * along, 2, 0)).min(axis=1)
    assert away.max() <= DEVIATION + 0.05
