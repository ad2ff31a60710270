"""What every controller of the catalogue promises, whoever adds one."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from controllers import catalog
from controllers.interface import Command, Decision, Perception, Plan
from tests.controllers.scenes import ego, golden, perception, straight_road

SCENES = MappingProxyType(golden())
every_controller = pytest.mark.parametrize("name", catalog.names())
every_scene = pytest.mark.parametrize("situation", sorted(SCENES))


def _answers(name: str, scenes: list[Perception]) -> list[tuple[Decision, Plan]]:
    controller = catalog.build(name)
    answers = []
    for scene in scenes:
        decision = controller.decide(scene)
        answers.append((decision, controller.plan(scene, decision)))
    return answers


def _moments(scene: Perception, count: int = 3) -> list[Perception]:
    """Return the same scene a few plan intervals long, so that a controller's memory is used."""
    interval = scene.ego.plan_interval
    return [replace(scene, ego=replace(scene.ego, time=index * interval)) for index in range(count)]


def _assert_possible(command: Command, scene: Perception) -> None:
    drive = scene.ego.drive
    assert len(command.times) == len(command.acceleration) == len(command.steering) >= 1
    assert abs(command.times[0]) < 1e-9
    assert (np.diff(command.times) > 0.0).all()
    for values in (command.times, command.acceleration, command.steering):
        assert np.isfinite(values).all()
    assert command.acceleration.min() >= -drive.max_deceleration - 1e-6
    assert command.acceleration.max() <= drive.max_acceleration + 1e-6
    assert np.abs(command.steering).max() <= drive.max_steering + 1e-6


@every_controller
@every_scene
def test_a_command_is_finite_and_within_the_limits_of_the_drive(name: str, situation: str) -> None:
    scene = SCENES[situation]
    for decision, plan in _answers(name, _moments(scene)):
        _assert_possible(plan.command, scene)
        assert isinstance(decision.target_lane, int)
        assert scene.road.lane(decision.target_lane) is not None
        assert len(plan.along) == len(plan.across) == len(plan.speed) == len(plan.times)


@every_controller
@pytest.mark.parametrize("interval", [0.05, 0.25, 1.0])
def test_a_command_is_possible_for_any_plan_interval(name: str, interval: float) -> None:
    for scene in SCENES.values():
        seen = replace(scene, ego=replace(scene.ego, plan_interval=interval))
        for _, plan in _answers(name, [seen]):
            _assert_possible(plan.command, seen)


@every_controller
def test_all_situations_in_a_row_are_survived_by_one_object(name: str) -> None:
    scenes = [
        replace(scene, ego=replace(scene.ego, time=0.1 * index))
        for index, scene in enumerate(SCENES.values())
    ]
    for (_, plan), scene in zip(_answers(name, scenes), scenes, strict=True):
        _assert_possible(plan.command, scene)


@every_controller
def test_the_same_perceptions_give_the_same_answers(name: str) -> None:
    scenes = [_moments(scene, 2)[1] for scene in SCENES.values()]
    for (wanted, plan), (again, second) in zip(_answers(name, scenes), _answers(name, scenes), strict=True):
        assert wanted == again
        assert (plan.status, plan.solved, plan.passing) == (second.status, second.solved, second.passing)
        np.testing.assert_array_equal(plan.command.acceleration, second.command.acceleration)
        np.testing.assert_array_equal(plan.command.steering, second.command.steering)


@every_controller
def test_two_objects_share_no_memory(name: str) -> None:
    scenes = list(SCENES.values())
    catalog_first = catalog.build(name)
    for scene in scenes:
        catalog_first.plan(scene, catalog_first.decide(scene))
    (decision, plan), (again, second) = _answers(name, scenes[:1])[0], _answers(name, scenes[:1])[0]
    assert decision == again
    np.testing.assert_array_equal(plan.command.acceleration, second.command.acceleration)


@every_controller
def test_a_controller_tells_what_it_is_and_what_can_be_set(name: str) -> None:
    assert catalog.describe(name).endswith(".")
    given = catalog.parameters(name)
    catalog.build(name, seed=3, **given)
    texts = {key: "none" if value is None else str(value) for key, value in given.items()}
    assert catalog.parse(name, texts) == dict(given)


@every_controller
def test_an_unknown_parameter_is_refused_in_one_line(name: str) -> None:
    with pytest.raises(catalog.CatalogError, match="no parameter 'no_such_thing'") as caught:
        catalog.build(name, no_such_thing=1)
    assert "\n" not in str(caught.value)


@every_controller
@pytest.mark.parametrize("speed", [0.0, 0.01, 40.0])
def test_extreme_speeds_are_survived(name: str, speed: float) -> None:
    scene = perception(ego(speed), straight_road(3, 1))
    for _, plan in _answers(name, _moments(scene)):
        _assert_possible(plan.command, scene)
