"""The numbers of the drivable-area paper's experiments."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

from controllers.drivable_area.costs import SpeedRisk
from controllers.drivable_area.drivable_entropy import EntropyMode
from controllers.drivable_area.quintic_path import PathStart, quintic_paths
from studies.papers.claim import Claim, Status
from studies.papers.drivable_area import experiments
from studies.papers.drivable_area.rides import rides_in
from studies.papers.drivable_area.scenes import (
    GRIP,
    RULES,
    SITUATIONS,
    Situation,
    at_the_table,
    chosen,
    grid,
    nearest,
    possible,
    problem,
    verdict,
)
from tests.studies.papers.holds import HOLDS

SITUATION = MappingProxyType({one.name: one for one in SITUATIONS})
FIGURES = ("candidates", "curvature", "pareto-front", "rides", "several-pedestrians", "speed-profiles")
FEW = tuple(SITUATION[name] for name in ("A1", "A4"))
"""Both distances and both speeds; beside the three pedestrians of A4, no candidate is possible."""
EACH = [pytest.param(one, id=one.name, marks=() if one in FEW else pytest.mark.slow) for one in SITUATIONS]
Results = tuple[list[Claim], Path]


searched = cache(chosen)
driven = cache(rides_in)


@pytest.fixture(scope="module", autouse=True)
def searched_once() -> Iterator[None]:
    """The experiments and the tests ask for the same searches and rides; each is made once."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(experiments, "chosen", searched)
        patch.setattr(experiments, "rides_in", driven)
        yield


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Run all experiments once, the searches and rides in few situations."""
    folder = tmp_path_factory.mktemp("few-figures")
    return experiments.run(folder, FEW), folder


@pytest.fixture(scope="module")
def all_results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Run all experiments once, in all situations."""
    folder = tmp_path_factory.mktemp("figures")
    return experiments.run(folder), folder


@pytest.mark.parametrize(
    ("name", "stops", "gap"),
    [("A1", 10.08, 9.9), ("A2", 15.06, 4.9), ("A3", 10.08, -0.08), ("A4", 15.06, -5.06)],
)
def test_where_braking_stops(name: str, stops: float, gap: float) -> None:
    assert SITUATION[name].braking.distance == pytest.approx(stops, abs=0.006)
    assert SITUATION[name].gap == pytest.approx(gap, abs=0.05)


def test_how_many_candidates_touch_nobody() -> None:
    assert len(grid(SITUATION["A1"])[0]) == 168
    assert [possible(one, 2.4, -1.0) for one in SITUATIONS] == [129, 94, 33, 14]


def test_within_the_grip_none_is_left_at_ten_metres_for_that_start_but_some_for_another() -> None:
    for start, counts in ((2.4, (0, 0)), (3.0, (0, 0)), (1.0, (54, 17))):
        for name, count in zip(("A3", "A4"), counts, strict=True):
            one = SITUATION[name]
            rules = replace(RULES, step=0.02)
            judged = verdict(problem(one, start), replace(rules, walks=1), *grid(one))
            assert int((judged.feasible & (judged.lateral <= GRIP)).sum()) == count
    assert [possible(SITUATION[name], 2.4, -1.0, within_friction=True) for name in ("A3", "A4")] == [0, 0]


@pytest.mark.parametrize(
    ("name", "cost", "lateral"),
    [("A1", 0.0393, 0.60), ("A2", 0.0262, 0.71), ("A3", 0.5163, 9.2), ("A4", 0.4655, 13.8)],
)
def test_curvature_cost_and_lateral_acceleration_of_the_candidates_of_the_table(
    name: str, cost: float, lateral: float
) -> None:
    judged = at_the_table(SITUATION[name])
    assert judged.costs[0, 0] == pytest.approx(cost, abs=1e-4)
    assert judged.lateral[0] == pytest.approx(lateral, abs=0.05)


@pytest.mark.parametrize(("speed_kmh", "shift"), [(40.0, 1.10), (50.0, 0.70)])
def test_steering_alone_shifts_a_car_by_so_much_in_ten_metres(speed_kmh: float, shift: float) -> None:
    _, _, bend = quintic_paths(PathStart(), 10.0, np.array([shift])).at(np.linspace(0.0, 10.0, 2001)[None, :])
    assert np.abs(bend).max() * (speed_kmh / 3.6) ** 2 == pytest.approx(GRIP, rel=0.01)


def test_the_grid_says_the_same_of_nearness_as_the_closed_form_of_a_straight_ride() -> None:
    one = SITUATION["A1"]
    # At constant speed in the lane: both move straight, 1.55 m against 2.4 m − 1.25 m/s · t.
    relative = np.array([one.speed, 1.25])
    start = np.array([-20.0, 1.55 - 2.4])
    closed = abs(start[0] * relative[1] - start[1] * relative[0]) / np.hypot(*relative)
    near = nearest(one, np.array([2.4]), -1.0, reacts=False)[0]
    assert near == pytest.approx(closed, abs=0.01)


@pytest.mark.slow
def test_the_readings_of_the_distance_cost(results: Results) -> None:
    claims = {claim.experiment: claim for claim in results[0] if claim.experiment.startswith("cost_d, ")}
    for form, fit in (
        (SpeedRisk.METRES_PER_SECOND, -0.84),
        (SpeedRisk.KILOMETRES_PER_HOUR, 0.95),
        (SpeedRisk.SQUARED, -0.16),
        (SpeedRisk.STOPPING_DISTANCE, 0.58),
    ):
        claim = claims[f"cost_d, v_s as {form.value}"]
        assert float(claim.our_value.removeprefix("R² = ")) == pytest.approx(fit, abs=0.015)
    assert claims["cost_d, v_s as m/s"].paper_value == "3.06 / 2.99 / 2.26 / 2.04 m"
    assert "the pedestrian is not in danger" in claims["cost_d, v_s as km/h"].why


@pytest.mark.long
@pytest.mark.parametrize("one", EACH)
@pytest.mark.parametrize("mode", EntropyMode)
def test_the_search_stops_where_it_can_and_touches_nobody(mode: EntropyMode, one: Situation) -> None:
    found = searched(one, mode)
    assert found is not None
    front, judged, best = found
    assert front.looked_at == 32 * 25
    assert judged.feasible.all()
    assert judged.meetings.clearance[best] > 0.0
    if one.distance == 20.0:
        assert front.genes[best] == pytest.approx([1.55, 0.0], abs=0.05)


@pytest.mark.long
@pytest.mark.parametrize("one", EACH)
def test_the_closed_loops(one: Situation) -> None:
    rides = driven(one)
    brakes, loose, strict = (ride.impact_speed for ride in (rides.brake, rides.loose, rides.strict))
    assert loose is None
    if one.distance == 20.0:
        assert brakes is None
        assert strict is None
    else:
        assert brakes is not None
        assert strict is not None
        assert strict < brakes


@pytest.mark.slow
@pytest.mark.parametrize("which", ["results", "all_results"])
def test_no_claim_lacks_a_status_or_a_reason_and_every_figure_is_there(
    which: str, request: pytest.FixtureRequest
) -> None:
    claims, folder = request.getfixturevalue(which)
    assert {claim.paper for claim in claims} == {"002"}
    assert len({(claim.experiment, claim.claim) for claim in claims}) == len(claims)
    for claim in claims:
        assert claim.our_value
        if claim.status not in HOLDS:
            assert claim.why, claim
    assert sorted(path.name for path in folder.iterdir()) == [f"002-{name}.png" for name in FIGURES]


@pytest.mark.slow
def test_a_second_run_gives_the_same_bytes(
    all_results: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    claims, folder = all_results
    monkeypatch.setattr(experiments, "chosen", chosen)  # not what the first run has found
    monkeypatch.setattr(experiments, "rides_in", rides_in)
    assert experiments.run(tmp_path) == claims
    for path in folder.iterdir():
        assert path.read_bytes() == (tmp_path / path.name).read_bytes()


@pytest.mark.slow
def test_what_the_paper_says_is_sorted_as_it_came_out(results: Results) -> None:
    status = {(claim.experiment, claim.claim): claim.status for claim in results[0]}
    assert (
        status["12 · 14 candidates", "Many candidates in A1 and A2, some in A3, few in A4."] is Status.FITTED
    )
    assert status["A2, candidate of Table 2", "cost_c"] is Status.FITTED
    assert status["A3, candidate of Table 2", "cost_c"] is Status.FITTED
    for name in ("A1", "A4"):
        assert status[f"{name}, candidate of Table 2", "cost_c"] is Status.NOT_REPRODUCED
    for name in SITUATION:
        assert status[f"{name}, candidate of Table 2", "cost_s"] is Status.NOT_REPRODUCED
        better = status[f"{name}, Table 2", "By its weighted cost the method is better than AEB."]
        assert better is (Status.NOT_REPRODUCED if name in ("A1", "A2") else Status.ARITHMETIC)
