"""The reference driver brakes after the reaction time, as hard as the performance model says."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from controllers import catalog
from controllers.interface import Controller, Perception
from tests.controllers.scenes import Walker, ego, perception

SPEED = 50.0 / 3.6
STEP = 0.1


def scene(time: float, along: float, across: float, across_speed: float, speed: float = SPEED) -> Perception:
    """Return an ego at a time, and one pedestrian so far ahead of its rear axle."""
    walker = Walker(along=along, across=across, across_speed=across_speed)
    return perception(ego(speed=speed, time=time), walkers=[walker])


def commands(driver: Controller, scenes: list[Perception]) -> list[float]:
    """Return the mean acceleration over each plan interval that is commanded [m/s^2]."""
    found = []
    for one in scenes:
        command = driver.plan(one, driver.decide(one)).command
        within = command.times < one.ego.plan_interval - 1e-9
        found.append(float(np.mean(command.acceleration[within])))
    return found


def standing_ahead(times: np.ndarray, distance: float) -> list[Perception]:
    """Return a pedestrian who stands in the path while the ego comes at constant speed."""
    return [scene(float(time), distance - SPEED * float(time), 0.0, 0.0) for time in times]


def test_they_brake_after_their_reaction_and_not_before() -> None:
    times = np.arange(0.0, 1.6, STEP)
    asked = commands(catalog.build("careful_driver"), standing_ahead(times, 50.0))
    begun = [time for time, value in zip(times, asked, strict=True) if value < -1.0]
    # Perceived at once: the contact is 46 m or 3.3 s away.
    assert begun[0] == pytest.approx(0.75, abs=STEP)
    assert max(asked[:7]) > -1.0


def test_the_car_brakes_as_the_performance_model_does() -> None:
    driver, speed, braking, along = catalog.build("careful_driver"), SPEED, 0.0, 50.0
    lag = ego().drive.drive_lag
    for k in range(20):
        one = scene(STEP * k, along, 0.0, 0.0, speed)
        one = replace(one, ego=replace(one.ego, acceleration=-braking))
        command = driver.plan(one, driver.decide(one)).command
        assert command.acceleration.min() >= -8.0, "within the drive"
        for value in command.acceleration[command.times < STEP - 1e-9]:
            braking += (-float(value) - braking) * (1.0 - np.exp(-0.05 / lag))
            speed, along = speed - 0.05 * braking, along - 0.05 * speed
        model = 0.774 * 9.80665 * np.clip((STEP * (k + 1) - 0.75) / 0.6, 0.0, 1.0)
        # From about 4 m/s^2 on, the drive's limit of 8 m/s^2 lets the rest of the ramp come a little later.
        assert model - (0.05 if model < 4.0 else 1.3) <= braking <= model + 0.01
    assert braking == pytest.approx(0.774 * 9.80665, abs=0.01)


def test_a_contact_that_is_far_away_is_no_risk_yet() -> None:
    times = np.arange(0.0, 1.5, STEP)
    asked = commands(
        catalog.build("careful_driver"), standing_ahead(times, 4.0 * SPEED + 3.6 + 1.5 * SPEED + 1.0)
    )
    assert min(asked) > -1.0


@pytest.mark.parametrize(("walked", "risk"), [(0.3, False), (0.5, True)])
def test_somebody_beside_the_path_is_a_risk_once_they_have_moved_across(walked: float, risk: bool) -> None:
    driver = catalog.build("careful_driver", delay_s=0.0)
    speed, steps = 1.4, 5
    step = walked / speed / (steps - 1)
    scenes = [
        # On a collision course: the pedestrian is in the middle of the path when the front arrives.
        scene(k * step, 3.55 + 2.0 * SPEED - SPEED * k * step, -2.8 + speed * k * step, speed if k else 0.0)
        for k in range(steps)
    ]
    because = [driver.decide(one).because for one in scenes]
    assert (because[-1] != "") is risk


def test_somebody_who_comes_into_view_walking_is_a_risk_at_once() -> None:
    seen = scene(0.0, 3.55 + 1.5 * SPEED, -2.0, 1.4)
    assert catalog.build("careful_driver").decide(seen).because == "person0"


def test_somebody_who_walks_along_the_kerb_is_no_risk() -> None:
    driver = catalog.build("careful_driver")
    scenes = [scene(0.1 * k, 40.0 - SPEED * 0.1 * k, -2.2, 0.0) for k in range(20)]
    assert all(driver.decide(one).because == "" for one in scenes)


def test_a_standing_driver_waits_for_whoever_is_ahead() -> None:
    driver = catalog.build("careful_driver")
    scenes = [scene(0.1 * k, 5.5, 0.0, 0.0, speed=0.0) for k in range(5)]
    assert max(commands(driver, scenes)) < 0.0
    gone = scene(0.6, 5.5, 6.0, 1.4, speed=0.0)
    assert commands(driver, [gone])[0] > 0.0


@pytest.mark.parametrize("wrong", [{"delay_s": -0.1}, {"deceleration_g": 0.0}, {"horizon_s": float("inf")}])
def test_what_cannot_be_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        catalog.build("careful_driver", **wrong)
