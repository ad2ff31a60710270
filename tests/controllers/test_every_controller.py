"""What every controller of the catalogue promises, whoever adds one."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

import pytest

from controllers import catalog
from controllers.interface import Decision, Perception, Plan
from cosim.conformance import contract
from cosim.conformance.contract import CROWD, INTERVALS, Factory
from tests.controllers.brief_searches import BRIEF_SEARCHES
from tests.controllers.scenes import Walker, ego, golden, perception, straight_road

SCENES = MappingProxyType(golden())
every_controller = pytest.mark.parametrize("name", catalog.names())
every_scene = pytest.mark.parametrize("situation", sorted(SCENES))


def _answers(name: str, scenes: Sequence[Perception]) -> list[tuple[Decision, Plan]]:
    return contract.answers(catalog.build(name), scenes)


def _factory(name: str) -> Factory:
    return lambda: catalog.build(name)


def _brief(name: str) -> Factory:
    """Make a controller that searches less; with its own settings it is asked in all situations."""
    return lambda: catalog.build(name, **BRIEF_SEARCHES.get(name, {}))


@every_controller
@every_scene
def test_a_command_is_finite_and_within_the_limits_of_the_drive(name: str, situation: str) -> None:
    contract.check_situation(_factory(name), situation)


@every_controller
@pytest.mark.parametrize("interval", INTERVALS)
def test_a_command_is_possible_for_any_plan_interval(name: str, interval: float) -> None:
    """Each situation has one of the intervals, for the next controller another one."""
    situations = [situation for situation in SCENES if situation != CROWD]
    first = (INTERVALS.index(interval) + catalog.names().index(name)) % len(INTERVALS)
    contract.check_interval(_brief(name), interval, situations[first :: len(INTERVALS)])


@every_controller
def test_all_situations_in_a_row_are_survived_by_one_object(name: str) -> None:
    contract.check_survival(_brief(name))


@every_controller
def test_the_same_perceptions_give_the_same_answers_whatever_another_object_is_asked(name: str) -> None:
    contract.check_determinism(_brief(name))


@pytest.mark.long
@every_controller
def test_a_second_run_is_like_the_first(name: str) -> None:
    contract.check_runs(_brief(name))


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
@pytest.mark.parametrize("speed", contract.SPEEDS)
def test_extreme_speeds_are_survived(name: str, speed: float) -> None:
    contract.check_speed(_factory(name), speed)


BLIND = frozenset({"constant_speed", "septic_lane_change", "sumo"})
"""They have no method for pedestrians."""


@every_controller
def test_a_method_says_what_its_part_is_with_somebody_before_the_car(name: str) -> None:
    """They stand 6 m before the bumper of a car at 8 m/s: whatever the method, it has to do something."""
    scene = perception(ego(8.0), straight_road(), [Walker(10.0, 0.3)])
    parts = [plan.own for _, plan in _answers(name, contract.moments(scene, 10))]
    if name in BLIND:
        assert parts == [None] * len(parts)
        return
    assert all(part is not None and part.applies and (part.acts or part.overridden) for part in parts)
    # Drivers react after a dead time, which is less than these 0.9 s.
    assert [part.deviates for part in parts[-1:] if part is not None] == [True]


@every_controller
def test_a_method_has_no_part_in_an_empty_street(name: str) -> None:
    scene = perception(ego(8.0), straight_road())
    for _, plan in _answers(name, contract.moments(scene)):
        assert plan.own is None or not (plan.own.applies or plan.own.acts)
