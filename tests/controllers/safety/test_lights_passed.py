"""An ego knows that it is in a junction with traffic lights after it has passed one."""

from __future__ import annotations

from dataclasses import replace

from controllers.interface import Perception, Signal, SignalState
from controllers.safety.lights_passed import WITHIN, LightsPassed
from tests.controllers.scenes import ego, perception


def _at(x: float, *lines: float) -> Perception:
    """Return what is seen with the rear axle at a place, and with lights at lines ahead of it [m]."""
    lights = [Signal(str(line), line, SignalState.GREEN) for line in lines]
    return perception(replace(ego(), x=x), signals=lights)


def test_without_any_light_it_is_in_no_such_junction() -> None:
    assert not LightsPassed().look(_at(0.0))


def test_it_is_in_the_junction_from_the_line_on_and_for_some_way() -> None:
    lights = LightsPassed()
    assert not lights.look(_at(0.0, 20.0)), "the line is ahead"
    assert lights.look(_at(18.0, 2.0)), "its front has passed the line"
    assert lights.look(_at(20.0 + WITHIN - 1.0))
    assert not lights.look(_at(20.0 + WITHIN + 1.0))


def test_before_the_next_light_it_has_left_the_junction() -> None:
    lights = LightsPassed()
    lights.look(_at(18.0, 2.0))
    assert lights.look(_at(30.0, WITHIN + 5.0)), "the next one is far"
    assert not lights.look(_at(40.0, WITHIN - 5.0))


def test_a_light_that_is_far_ahead_is_not_remembered() -> None:
    lights = LightsPassed()
    assert not lights.look(_at(0.0, WITHIN + 5.0))
    assert not lights.look(_at(WITHIN + 5.0))
