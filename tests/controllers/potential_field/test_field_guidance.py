"""Steering down a field: it converges, respects limits, and foresees what the plant does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from controllers.interface import Body, Command, RoadAhead
from controllers.potential_field.field import Field, standing
from controllers.potential_field.field_guidance import Guidance, drive
from cosim.step.plant import CAR_DRIVE, Plant
from tests.controllers.scenes import bend, ego, straight_road

ROAD = straight_road(2, 0)
LANE = Field(ROAD.right_edge, ROAD.left_edge, 0.0, np.array([1.75]))
PERSON = standing(*(np.array([value]) for value in (40.0, 1.0, 15.0, 1.83)))


@pytest.mark.parametrize("speed", [3.0, 12.0, 25.0, 35.0])
def test_an_offset_decays_without_overshoot(speed: float) -> None:
    wide = Field(-1000.0, 1000.0, 0.0)
    found = drive(wide, 1, ego(speed, across=0.5), ROAD, np.full(601, speed), 0.05)
    across = found.across[:, 0]
    assert abs(across[-1]) < 0.06 * 0.5 if speed > 10.0 else abs(across[-1]) < 0.12
    assert across.min() > -0.02


@pytest.mark.parametrize("speed", [8.0, 15.0, 25.0])
@pytest.mark.parametrize("heading", [-0.15, 0.0, 0.1])
def test_the_lateral_acceleration_and_the_wheel_stay_within_limits(speed: float, heading: float) -> None:
    sharp = replace(LANE, obstacles=standing(*(np.array([v]) for v in (25.0, 0.2, 2.0, 1.83))))
    guidance = Guidance(lateral_acceleration=3.0)
    found = drive(sharp, 1, ego(speed, heading_error=heading), ROAD, np.full(61, speed), 0.05, guidance)
    bends = np.tan(found.angle[:, 0]) / Body().wheelbase
    assert np.abs(bends).max() * speed**2 <= 3.0 + 1e-9
    assert np.abs(found.angle).max() <= CAR_DRIVE.max_steering


@pytest.mark.parametrize("speed", [6.0, 14.0, 25.0])
def test_the_plant_goes_where_the_drive_says(speed: float) -> None:
    shape = replace(LANE, obstacles=PERSON)
    found = drive(shape, 1, ego(speed), ROAD, np.full(81, speed), 0.05)
    plant = Plant(Body(), CAR_DRIVE, 0.0, 0.0, 0.0, speed)
    command = Command(found.times[:-1], np.zeros(80), found.angle[:, 0])
    plant.follow(command, 0.0, 4.0)
    assert plant.x == pytest.approx(found.along[-1, 0], abs=0.1)
    assert plant.y == pytest.approx(found.across[-1, 0], abs=0.1)
    assert np.abs(found.across).max() > 0.2, "the person is felt"


def test_a_bend_is_followed_in_the_middle_of_the_lane() -> None:
    road: RoadAhead = bend(ROAD, 0.0, 100.0, 150.0)
    wide = Field(-1000.0, 1000.0, 0.0)
    found = drive(wide, 1, ego(12.0), road, np.full(101, 12.0), 0.05)
    assert np.abs(found.across).max() < 0.1


def test_a_standing_car_stays_where_it_is() -> None:
    found = drive(replace(LANE, obstacles=PERSON), 1, ego(0.0), ROAD, np.zeros(21), 0.1)
    assert not found.along.any()
    assert np.isfinite(found.angle).all()
