"""What every controller of the catalogue promises, whoever adds one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from types import MappingProxyType

import numpy as np
import pytest

from controllers import catalog
from controllers.interface import Command, Controller, Decision, Perception, Plan
from tests.controllers.scenes import Walker, ego, golden, perception, straight_road

SCENES = MappingProxyType(golden())
CROWD = "five hundred pedestrians"
INTERVALS = (0.05, 0.25, 1.0)
every_controller = pytest.mark.parametrize("name", catalog.names())
every_scene = pytest.mark.parametrize("situation", sorted(SCENES))


def _answers(name: str, scenes: Sequence[Perception]) -> list[tuple[Decision, Plan]]:
    controller = catalog.build(name)
    return [_answer(controller, scene) for scene in scenes]


def _answer(controller: Controller, scene: Perception) -> tuple[Decision, Plan]:
    decision = controller.decide(scene)
    return decision, controller.plan(scene, decision)


def _in_a_row() -> list[Perception]:
    """Return all situations as one object meets them, that of the crowd last."""
    scenes = [scene for situation, scene in SCENES.items() if situation != CROWD] + [SCENES[CROWD]]
    return [replace(scene, ego=replace(scene.ego, time=0.1 * index)) for index, scene in enumerate(scenes)]


@cache
def _alone(name: str) -> Sequence[tuple[Decision, Plan]]:
    """Return what one object answers to all situations in a row while there is no other."""
    return tuple(_answers(name, _in_a_row()))


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
@pytest.mark.parametrize("interval", INTERVALS)
def test_a_command_is_possible_for_any_plan_interval(name: str, interval: float) -> None:
    """Each situation has one of the intervals, for the next controller another one."""
    situations = [situation for situation in SCENES if situation != CROWD]
    first = (INTERVALS.index(interval) + catalog.names().index(name)) % len(INTERVALS)
    for situation in situations[first :: len(INTERVALS)]:
        scene = SCENES[situation]
        seen = replace(scene, ego=replace(scene.ego, plan_interval=interval))
        for _, plan in _answers(name, [seen]):
            _assert_possible(plan.command, seen)


@every_controller
def test_all_situations_in_a_row_are_survived_by_one_object(name: str) -> None:
    for (_, plan), scene in zip(_alone(name), _in_a_row(), strict=True):
        _assert_possible(plan.command, scene)


@every_controller
def test_the_same_perceptions_give_the_same_answers_whatever_another_object_is_asked(name: str) -> None:
    """Without the crowd; the other object is asked something else in between."""
    scenes = _in_a_row()[:-1]
    controller, other = catalog.build(name), catalog.build(name)
    for index, scene in enumerate(scenes):
        if index % 3 == 0:
            _answer(other, scenes[-1 - index])
        (wanted, plan), (again, second) = _alone(name)[index], _answer(controller, scene)
        assert wanted == again
        assert (plan.status, plan.solved, plan.passing) == (second.status, second.solved, second.passing)
        np.testing.assert_array_equal(plan.command.acceleration, second.command.acceleration)
        np.testing.assert_array_equal(plan.command.steering, second.command.steering)


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


BLIND = frozenset({"constant_speed", "septic_lane_change", "sumo"})
"""They have no method for pedestrians."""


@every_controller
def test_a_method_says_what_its_part_is_with_somebody_before_the_car(name: str) -> None:
    """They stand 6 m before the bumper of a car at 8 m/s: whatever the method, it has to do something."""
    scene = perception(ego(8.0), straight_road(), [Walker(10.0, 0.3)])
    parts = [plan.own for _, plan in _answers(name, _moments(scene, 10))]
    if name in BLIND:
        assert parts == [None] * len(parts)
        return
    assert all(part is not None and part.applies and (part.acts or part.overridden) for part in parts)
    # Drivers react after a dead time, which is less than these 0.9 s.
    assert [part.deviates for part in parts[-1:] if part is not None] == [True]


@every_controller
def test_a_method_has_no_part_in_an_empty_street(name: str) -> None:
    scene = perception(ego(8.0), straight_road())
    for _, plan in _answers(name, _moments(scene)):
        assert plan.own is None or not (plan.own.applies or plan.own.acts)
