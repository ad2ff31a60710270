"""How long a run is, as it is asked for."""

from __future__ import annotations

import pytest

from cosim.running.compose import inputs_of
from cosim.running.request import RunRequest


@pytest.mark.parametrize(("settings", "whole"), [({}, 180.0), ({"warmup_s": "5"}, 65.0)])
def test_the_duration_that_is_asked_for_is_what_is_recorded(settings: dict[str, str], whole: float) -> None:
    asked = inputs_of(RunRequest("midblock_zebra", "sumo", settings=settings, duration_s=60.0))
    assert asked.duration_s == whole == asked.warmup_s + 60.0


def test_the_parameter_of_a_scenario_counts_from_the_beginning() -> None:
    asked = inputs_of(RunRequest("midblock_zebra", "sumo", settings={"duration_s": "180"}))
    assert asked.duration_s == 180.0
