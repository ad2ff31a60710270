"""Test protocols as tables and as scenarios, without SUMO."""

from __future__ import annotations

import math
import re

import pytest

from sumo_scenarios import library
from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.pedestrian_tables import LineTable
from sumo_scenarios.suites import build, tables
from sumo_scenarios.suites.case import Case, cases, find, reference_of

EVERY = [case for suite in tables.names() for case in cases(suite)]
RIGHT_30 = find("suite:fmvss127/crossing_right_25_30kmh")


@pytest.mark.parametrize("suite", tables.names())
def test_cases_of_a_suite_have_different_names(suite: str) -> None:
    names = [case.name for case in cases(suite)]
    assert len(set(names)) == len(names) > 0


@pytest.mark.parametrize("case", EVERY, ids=lambda case: case.reference)
def test_a_reference_loads_as_any_scenario_does(case: Case) -> None:
    scenario = library.load(case.reference)
    assert re.fullmatch(r"[A-Za-z0-9_.]+", scenario.name), "it becomes the name of a folder"
    assert find(case.reference) == case
    assert reference_of(scenario.name) == case.reference
    assert len(scenario.pedestrians) == 1
    assert scenario.duration_s > scenario.warmup_s + build.APPROACH_S


@pytest.mark.parametrize("case", EVERY, ids=lambda case: case.reference)
def test_the_ego_is_on_its_way_for_four_seconds_before_anything_can_happen(case: Case) -> None:
    assert build.APPROACH_S >= 4.0
    if case.group.motion == "crossing":
        assert case.group.start_distance_m is not None
        assert build.walking_time(case, case.group.start_distance_m) <= build.APPROACH_S - 2.0


def test_walking_times_by_hand() -> None:
    speed = 5.0 / 3.6
    assert build.walking_time(RIGHT_30, 1.0) == pytest.approx(2.0 / speed)
    assert build.walking_time(RIGHT_30, 3.0) == pytest.approx(2.0 / speed + 2.0 / speed)
    assert build.walking_time(RIGHT_30, 0.25) == pytest.approx(1.0 / speed)


def test_the_pedestrian_of_a_case_is_the_protocols() -> None:
    (pedestrian,) = library.load(RIGHT_30.reference).pedestrians
    assert isinstance(pedestrian, LineTable)
    assert pedestrian.from_m[1] == -4.0
    assert pedestrian.start.ego_speed_mps == pytest.approx(30.0 / 3.6)
    assert math.dist(pedestrian.from_m, pedestrian.to_m) == 8.0


@pytest.mark.parametrize(
    ("reference", "said"),
    [
        ("suite:fmvs127/x", "did you mean 'fmvss127'"),
        ("suite:fmvss127/crossing_rigt_25_30kmh", "did you mean 'crossing_right_25_30kmh'"),
        ("suite:fmvss127", "expected one case of the suite, for instance suite:fmvss127/crossing_right"),
        ("suite:", "no such suite"),
    ],
)
def test_what_is_no_case_is_told_in_one_line(reference: str, said: str) -> None:
    with pytest.raises(ScenarioError, match=re.escape(said)) as told:
        library.load(reference)
    assert "\n" not in str(told.value)
