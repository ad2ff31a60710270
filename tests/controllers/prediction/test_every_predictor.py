"""What every predictor promises, whoever adds one, and that controllers do what a predictor says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import MappingProxyType
from typing import cast

import numpy as np
import pytest

from controllers import catalog
from controllers.arrays import FloatArray
from controllers.interface import Perception
from controllers.prediction import by_name
from controllers.prediction.forecast import Forecast, Predictor
from cosim.step.loop import run
from cosim.step.toy_road import Motion, ToyPedestrian, ToyRoad
from cosim.step.toy_world import ToyWorld
from tests.controllers.brief_searches import BRIEF_SEARCHES
from tests.controllers.scenes import golden
from tests.controllers.toy_runs import Ride

SCENES = MappingProxyType(golden())
TIMES = np.linspace(0.0, 6.0, 61)
DRIVERS = tuple(name for name in catalog.names() if "predictor" in catalog.parameters(name))
SWEEPING = tuple(name for name in DRIVERS if name in ("vo_mpc", "aeb"))
every_predictor = pytest.mark.parametrize("name", by_name.names())
every_scene = pytest.mark.parametrize("situation", sorted(SCENES))


def _forecasts(name: str, scenes: list[Perception], seed: int = 1) -> list[Forecast]:
    predictor = by_name.build(name, seed=seed)
    return [predictor.predict(scene, TIMES) for scene in scenes]


def _moments(scene: Perception, count: int = 3) -> list[Perception]:
    """Return a scene in which everybody but the ego keeps the velocity for some tenths of a second."""
    people, moments = scene.pedestrians, []
    for index in range(count):
        time = 0.1 * index
        later = replace(
            people,
            along=people.along + (people.along_speed - scene.ego.speed) * time,
            across=people.across + people.across_speed * time,
        )
        moments.append(replace(scene, pedestrians=later, ego=replace(scene.ego, time=time)))
    return moments


def test_the_predictor_that_needs_no_choice_is_one_of_them() -> None:
    assert by_name.CONSTANT_VELOCITY in by_name.names()
    assert by_name.sampled(by_name.CONSTANT_VELOCITY) is None
    with pytest.raises(ValueError, match="no_such_one"):
        by_name.build("no_such_one")


@every_predictor
@every_scene
def test_a_forecast_begins_where_people_are_and_is_finite(name: str, situation: str) -> None:
    for scene, forecast in zip(
        _moments(SCENES[situation]), _forecasts(name, _moments(SCENES[situation])), strict=True
    ):
        people = scene.pedestrians
        shape = (len(people), len(TIMES))
        assert forecast.along.shape == forecast.across.shape == forecast.reach.shape == shape
        np.testing.assert_array_equal(forecast.times, TIMES)
        for values in (forecast.along, forecast.across, forecast.reach):
            assert np.isfinite(values).all()
        assert (forecast.reach >= 0.0).all()
        np.testing.assert_allclose(forecast.along[:, 0], people.along, atol=0.05)
        np.testing.assert_allclose(forecast.across[:, 0], people.across, atol=0.05)


@every_predictor
def test_nobody_is_predicted_to_run_faster_than_people_can(name: str) -> None:
    for scene in SCENES.values():
        (forecast,) = _forecasts(name, [scene])
        along, across = forecast.velocities()
        fastest = np.hypot(scene.pedestrians.along_speed, scene.pedestrians.across_speed)
        assert (np.hypot(along, across) <= np.maximum(fastest, 4.0)[:, None] + 1e-6).all()


@every_predictor
def test_the_same_perceptions_and_seed_give_the_same_forecasts(name: str) -> None:
    scenes = _moments(SCENES["five hundred pedestrians"], 2)
    other = by_name.build(name)
    other.predict(SCENES["pedestrian crosses"], TIMES)
    for first, second in zip(_forecasts(name, scenes), _forecasts(name, scenes), strict=True):
        np.testing.assert_array_equal(first.along, second.along)
        np.testing.assert_array_equal(first.across, second.across)
        np.testing.assert_array_equal(first.reach, second.reach)


@pytest.mark.parametrize("driver", DRIVERS)
@every_predictor
def test_a_controller_keeps_its_promises_with_any_predictor(driver: str, name: str) -> None:
    """Where there is anybody to predict, and then where nobody is left; the crowd is predicted above."""
    controller = catalog.build(driver, predictor=name, **BRIEF_SEARCHES.get(driver, {}))
    met = [scene for scene in SCENES.values() if 0 < len(scene.pedestrians) < 100]
    for index, scene in enumerate([*met, SCENES["empty road"]]):
        seen = replace(scene, ego=replace(scene.ego, time=0.1 * index))
        decision = controller.decide(seen)
        command = controller.plan(seen, decision).command
        limits = seen.ego.drive
        for values in (command.times, command.acceleration, command.steering):
            assert np.isfinite(values).all()
        assert command.acceleration.min() >= -limits.max_deceleration - 1e-6
        assert command.acceleration.max() <= limits.max_acceleration + 1e-6
        assert np.abs(command.steering).max() <= limits.max_steering + 1e-6


@pytest.mark.parametrize("driver", DRIVERS)
def test_a_predictor_that_does_not_exist_is_refused_in_one_line(driver: str) -> None:
    with pytest.raises(
        catalog.CatalogError, match=r"predictor = 'crystal_ball': expected 'constant_velocity'"
    ) as caught:
        catalog.build(driver, predictor="crystal_ball")
    assert "\n" not in str(caught.value)


class Foreseen:
    """A predictor that knows the script, for the road without SUMO."""

    def __init__(self, motion: Motion) -> None:
        self._motion = motion

    def predict(self, perception: Perception, times: FloatArray) -> Forecast:
        """Return what the script says, as the ego on lane 0 sees it."""
        ego = perception.ego
        places = np.array([self._motion(ego.time + time)[:2] for time in times])
        shape = (len(perception.pedestrians), len(times))
        along = np.broadcast_to(places[:, 0] - ego.x, shape)
        across = np.broadcast_to(places[:, 1], shape)
        return Forecast(times, along, across, np.zeros(shape))


def _turning(
    x: float, y: float, before: tuple[float, float], after: tuple[float, float], at: float
) -> Motion:
    """Return the motion of somebody who changes direction at a time."""

    def motion(time: float) -> tuple[float, float, float, float]:
        first, second = min(time, at), max(time - at, 0.0)
        speed = before if time < at else after
        return x + before[0] * first + after[0] * second, y + before[1] * first + after[1] * second, *speed

    return motion


def _drive(driver: str, motion: Motion, speed: float = 12.0, duration: float = 8.0) -> Ride:
    world = ToyWorld(ToyRoad(), [ToyPedestrian("p0", motion)], speed=speed, duration=duration)
    record = Ride()
    run(world, {"ego": catalog.build(driver)}, record)
    return record


def _first_braking(record: Ride, harder_than: float = 1.0) -> float:
    braking = np.flatnonzero(record.commands[:, 0] < -harder_than)
    return 0.1 * float(braking[0]) if len(braking) else float("inf")


Foresight = Callable[[Motion], None]


@pytest.fixture
def foresight(monkeypatch: pytest.MonkeyPatch) -> Foresight:
    """Give all controllers a predictor that knows the script."""

    def give(motion: Motion) -> None:
        def chosen(name: str, *, seed: int = 1) -> Predictor | None:
            return cast(Predictor, Foreseen(motion))

        monkeypatch.setattr(by_name, "sampled", chosen)

    return give


def test_somebody_who_will_turn_onto_the_road_is_yielded_to_before_they_turn(foresight: Foresight) -> None:
    motion = _turning(54.0, -2.6, (-1.2, 0.0), (0.0, 1.3), at=2.0)
    surprised = _drive("vo_mpc", motion)
    foresight(motion)
    warned = _drive("vo_mpc", motion)
    assert _first_braking(surprised) >= 2.0
    assert _first_braking(warned) < 1.0
    assert warned.track[3].min() > surprised.track[3].min() + 1.0
    assert warned.clearance() > 0.8


def test_somebody_who_will_turn_away_is_not_braked_for(foresight: Foresight) -> None:
    motion = _turning(50.0, -6.0, (0.0, 1.3), (1.3, 0.0), at=2.0)
    surprised = _drive("vo_mpc", motion)
    foresight(motion)
    warned = _drive("vo_mpc", motion)
    assert _first_braking(surprised, 0.8) < 2.0
    assert warned.track[3].min() > -0.3


@pytest.mark.parametrize("driver", SWEEPING)
def test_somebody_who_turns_into_the_path_is_braked_for_before_they_turn(
    driver: str, foresight: Foresight
) -> None:
    """Going straight on, the pedestrian would stay beside the ego's path."""
    motion = _turning(31.0, -1.9, (0.6, 0.0), (0.0, 1.0), at=1.6)
    surprised = _drive(driver, motion, 11.0)
    foresight(motion)
    warned = _drive(driver, motion, 11.0)
    assert _first_braking(warned) < _first_braking(surprised) - 0.3
    assert warned.clearance() > max(surprised.clearance(), 0.1)


def test_the_emergency_brake_is_not_triggered_by_somebody_who_will_turn_away(foresight: Foresight) -> None:
    motion = _turning(27.0, -3.4, (0.0, 1.2), (1.5, -0.6), at=1.3)
    surprised = _drive("aeb", motion, 11.0, 4.0)
    foresight(motion)
    warned = _drive("aeb", motion, 11.0, 4.0)
    assert surprised.track[3].min() < -3.0
    assert warned.track[3].min() > -1.0
    assert warned.clearance() > 0.3


@pytest.mark.parametrize("cone", ["vo", "ivo", "hybrid"])
def test_a_collision_cone_follows_the_forecast_too(cone: str, foresight: Foresight) -> None:
    motion = _turning(50.0, -6.0, (0.0, 1.3), (1.3, 0.0), at=2.0)
    foresight(motion)
    world = ToyWorld(ToyRoad(), [ToyPedestrian("p0", motion)], speed=12.0, duration=6.0)
    record = Ride()
    run(world, {"ego": catalog.build("vo_mpc", cone=cone)}, record)
    assert record.track[3].min() > -0.5
    assert all(plan.solved for plan in record.plans)
