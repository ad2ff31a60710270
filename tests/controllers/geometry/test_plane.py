"""The route frame in a plane, against the curve of the road itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from controllers.arrays import FloatArray
from controllers.geometry.plane import to_plane
from tests.controllers.scenes import straight_road

MIDDLE, SPREAD, TURN = 9.0, 3.0, -0.5 * np.pi
FINE = 1e-3


def _curvature(along: FloatArray) -> FloatArray:
    """Return that of a right-angled turn to the right."""
    bump = np.exp(-(((along - MIDDLE) / SPREAD) ** 2))
    return np.asarray(TURN / (SPREAD * np.sqrt(np.pi)) * bump)


def _driven(begin: float, way: float) -> tuple[float, float, float]:
    """Return where the centre line leads from a place on, and its heading there, in fine steps."""
    along = np.arange(begin, begin + way, FINE) + 0.5 * FINE
    heading = np.cumsum(_curvature(along)) * FINE
    return float(np.cos(heading).sum() * FINE), float(np.sin(heading).sum() * FINE), float(heading[-1])


@pytest.mark.parametrize("begin", [0.0, 4.5, 8.0, 9.0, 11.5])
def test_a_turn_ends_where_the_road_does_wherever_in_it_the_ego_is(begin: float) -> None:
    told = _curvature(begin + np.arange(40.0))
    road = replace(straight_road(), curvature=told, curvature_step=1.0)
    for way in (5.0, 12.0, 20.0):
        ((x, y),), (heading,) = to_plane(road, np.array([way]), np.zeros(1))
        true_x, true_y, true_heading = _driven(begin, way)
        assert np.hypot(x - true_x, y - true_y) < 0.15
        assert heading == pytest.approx(true_heading, abs=0.03)
