"""Distances of a car on a path, with shapely as the other judge."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import Point, Polygon, box

from controllers.geometry.path_clearance import beyond_edges, disc_clearances, vehicles_met
from controllers.interface import Body
from tests.controllers.scenes import Car, vehicles

BODY = Body()
PLACE = st.floats(-12.0, 12.0)
HEADING = st.floats(-0.8, 0.8)


def _outline(along: float, across: float, heading: float) -> Polygon:
    shape = box(-BODY.rear_overhang, -0.5 * BODY.width, BODY.front, 0.5 * BODY.width)
    return affinity.translate(affinity.rotate(shape, heading, (0.0, 0.0), use_radians=True), along, across)


@given(PLACE, PLACE, HEADING, PLACE, PLACE, st.floats(0.1, 1.0))
def test_the_distance_to_a_disc_is_that_of_shapely(
    along: float, across: float, heading: float, x: float, y: float, radius: float
) -> None:
    path = (np.full((1, 1), along), np.full((1, 1), across), np.full((1, 1), heading))
    disc = (np.full((1, 1), x), np.full((1, 1), y), np.full((1, 1), radius))
    found = disc_clearances(*path, BODY, *disc)
    outline, centre = _outline(along, across, heading), Point(x, y)
    inside = outline.exterior.distance(centre) if outline.contains(centre) else 0.0
    expected = outline.distance(centre) - inside - radius
    assert found[0, 0, 0] == pytest.approx(expected, abs=1e-9)


def test_paths_instants_and_discs_each_have_their_axis() -> None:
    paths, instants, discs = 2, 3, 4
    along = np.arange(6.0).reshape(instants, paths)
    across, heading = np.zeros((instants, paths)), np.zeros((instants, paths))
    x = np.arange(12.0).reshape(discs, instants)
    found = disc_clearances(along, across, heading, BODY, x, x + 5.0, np.full((discs, instants), 0.25))
    assert found.shape == (instants, paths, discs)
    one = np.array([[along[2, 1]]])
    alone = disc_clearances(
        one, 0.0 * one, 0.0 * one, BODY, x[3:, 2:], x[3:, 2:] + 5.0, np.full((1, 1), 0.25)
    )
    assert found[2, 1, 3] == pytest.approx(alone[0, 0, 0])


@given(st.floats(-6.0, 6.0), HEADING)
def test_what_juts_out_is_what_shapely_finds_beyond_the_edges(across: float, heading: float) -> None:
    found = beyond_edges(np.array([across]), np.array([heading]), BODY, -3.0, 3.5)
    _, lowest, _, highest = _outline(0.0, across, heading).bounds
    assert found[0] == pytest.approx(max(highest - 3.5, -3.0 - lowest), abs=1e-9)


@pytest.mark.parametrize(
    ("car", "met"),
    [
        (Car(40.0, 0.0, 0.0), True),
        (Car(40.0, 3.5, 0.0), False),
        (Car(40.0, 0.0, 25.0), False),
        (Car(-10.0, 0.0, 20.0), True),
        (Car(5.0, 4.0, 10.0, -1.0), True),
        (Car(5.0, 4.0, 10.0, 0.5), False),
        (Car(60.0, 0.0, -10.0, heading_error=math.pi), True),
    ],
)
def test_vehicles_are_met_that_keep_their_velocities(car: Car, met: bool) -> None:
    times = np.linspace(0.0, 4.0, 41)
    along = 10.0 * times[:, None]
    nothing = np.zeros_like(along)
    found = vehicles_met(times, along, nothing, nothing, BODY, vehicles([car]), 0.3)
    assert found.shape == (1, 1)
    assert bool(found[0, 0]) == met
