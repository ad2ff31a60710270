"""The geometry of every case in SUMO: an ego that keeps its speed hits the pedestrian as the protocol says."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from analysis.protocols.impact import Impact, Measured, measure
from analysis.recording.reading import RecordedRun, read_run
from cosim.running.request import RunRequest
from cosim.running.simulation import run
from cosim.suites import judging
from cosim.suites.judging import Case, cases, judge, names
from sumo_scenarios.suites.build import place_of, walking_time

pytestmark = pytest.mark.sumo

OBSTRUCTED = "suite:fmvss127/obstructed_child_30kmh"
SOME = (
    "suite:fmvss127/crossing_right_25_10kmh",
    "suite:fmvss127/crossing_left_50_60kmh",
    OBSTRUCTED,
    "suite:fmvss127/stationary_55kmh",
    "suite:fmvss127/along_path_65kmh",
    "suite:euroncap2026/cpfa_90_40kmh",
    "suite:euroncap2026/cpta_far_20_20kmh",
    "suite:unr157/crossing_5kmh",
    "suite:false_reactions/along_the_kerb_50kmh",
    "suite:false_reactions/stops_before_the_lane_40kmh",
)
BESIDE = ("no_false_stop", "no_false_braking")


def driven(case: Case, folder: Path, controller: str = "constant_speed") -> RecordedRun:
    result = run(RunRequest(case.reference, controller, out=folder))
    assert result.valid, result.invalid_reason
    return read_run(folder)


@pytest.fixture(scope="module")
def steadily(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return what gives the folder of a case that an ego drives through at its speed; each is driven once."""
    folder = tmp_path_factory.mktemp("cases")

    @cache
    def drive(reference: str) -> Path:
        (case,) = cases(reference)
        driven(case, folder / case.name)
        return folder / case.name

    return drive


def person(recorded: RecordedRun) -> dict[str, np.ndarray]:
    here = recorded.neighbours.texts["object_kind"].equal("pedestrian")
    return {name: values[here] for name, values in recorded.neighbours.numbers.items()}


def assert_geometry(case: Case, folder: Path) -> None:
    recorded, measured = read_run(folder), measure(folder)
    speed = case.ego_speed_kmh / 3.6
    egos = recorded.egos.numbers
    assert np.abs(egos["speed_mps"] - speed).max() < 0.1 / 3.6
    walker = person(recorded)
    walking = np.hypot(walker["x_speed_mps"], walker["y_speed_mps"])
    assert walking.max() == pytest.approx(case.group.pedestrian_speed_kmh / 3.6, abs=0.1 / 3.6)
    if case.group.motion != "standing":
        assert_full_speed_in_time(case, walker, walking)
    # In any case, the ego has approached steadily for four seconds before it arrives.
    arrives = np.interp(place_of(case), egos["route_position_m"], egos["time_s"])
    assert arrives - egos["time_s"][0] >= 4.0
    if case.group.rule in BESIDE:
        assert_beside(case, measured, recorded)
        return
    impact = measured.impact
    assert impact is not None
    assert impact.side == "front"
    along = case.group.pedestrian_speed_kmh if case.group.motion == "along" else 0.0
    assert 3.6 * impact.speed == pytest.approx(case.ego_speed_kmh - along, abs=0.1)
    assert case.group.overlap is not None
    overlap = impact.overlap(case.group.comes_from == "left")
    assert overlap * impact.ego_width == pytest.approx(case.group.overlap * impact.ego_width, abs=0.02)
    if case.group.motion in ("crossing", "turning"):
        assert case.group.start_distance_m is not None
        assert_walks_to_the_point(case, walker, walking, impact)
    else:
        begins = walker["time_s"][0] if case.group.motion == "standing" else set_off(walker, walking)
        assert impact.time - begins >= 4.0, "the pedestrian is ahead for that long"


def assert_walks_to_the_point(
    case: Case, walker: dict[str, np.ndarray], walking: np.ndarray, impact: Impact
) -> None:
    """Check the walking time; one who sets off farther away than is recorded has begun to accelerate."""
    assert case.group.start_distance_m is not None
    assert case.group.overlap is not None
    takes = walking_time(case, case.group.start_distance_m - (0.5 - case.group.overlap) * impact.ego_width)
    if walking[0] == 0.0:
        assert impact.time - set_off(walker, walking) == pytest.approx(takes, abs=0.11)
        return
    full = case.group.pedestrian_speed_kmh / 3.6
    assert walking[0] < 0.999 * full
    # With constant acceleration v^2 / 2 s, the speed w is reached after 2 s w / v^2.
    since = 2.0 * case.group.acceleration_distance_m * walking[0] / full**2
    assert impact.time - walker["time_s"][0] == pytest.approx(takes - since, abs=0.01)


def set_off(walker: dict[str, np.ndarray], walking: np.ndarray) -> float:
    """Return the last instant of standing before the walk, so at most a step early."""
    return float(walker["time_s"][max(int(np.argmax(walking > 0.0)) - 1, 0)])


def assert_full_speed_in_time(case: Case, walker: dict[str, np.ndarray], walking: np.ndarray) -> None:
    if walking[0] > 0.0:
        return  # set off farther away than is recorded
    full = np.flatnonzero(walking > 0.999 * walking.max())[0]
    way = np.hypot(walker["x_m"][full] - walker["x_m"][0], walker["y_m"][full] - walker["y_m"][0])
    within = case.group.acceleration_distance_m
    assert within <= 1.5
    # Recorded once a step, so at most a step's way late.
    assert way <= within + 0.1 * walking.max() + 1e-6


def assert_beside(case: Case, measured: Measured, recorded: RecordedRun) -> None:
    assert measured.impact is None
    walker, egos = person(recorded), recorded.egos.numbers
    middle = egos["front_y_m"].mean()
    nearest = np.abs(walker["y_m"] - middle).min() - 0.25 - 0.5 * egos["width_m"][0]
    assert nearest == pytest.approx(case.group.beside_m, abs=0.02)


@pytest.mark.long
@pytest.mark.parametrize("reference", SOME)
def test_they_are_hit_where_the_protocol_says(reference: str, steadily: Callable[[str], Path]) -> None:
    (case,) = cases(reference)
    assert_geometry(case, steadily(reference))


@pytest.mark.slow
@pytest.mark.parametrize("name", names())
def test_they_are_hit_where_the_protocol_says_in_every_case(name: str, tmp_path: Path) -> None:
    for case in cases(name):
        driven(case, tmp_path / case.name)
        assert_geometry(case, tmp_path / case.name)


@pytest.mark.long
def test_parked_cars_stand_one_metre_beside_the_ego_and_before_them(steadily: Callable[[str], Path]) -> None:
    (case,) = cases(OBSTRUCTED)
    recorded = read_run(steadily(OBSTRUCTED))
    cars = recorded.neighbours.texts["object_kind"].equal("vehicle")
    numbers = {key: values[cars] for key, values in recorded.neighbours.numbers.items()}
    fronts = sorted(set(numbers["x_m"].round(3)))
    assert fronts[1] == pytest.approx(place_of(case) - 1.0, abs=0.01)
    assert fronts[1] - 4.5 - fronts[0] == pytest.approx(1.0, abs=0.01)
    egos = recorded.egos.numbers
    gap = egos["front_y_m"].mean() - numbers["y_m"] - 0.5 * egos["width_m"][0] - 0.5 * numbers["width_m"]
    assert np.allclose(gap, 1.0, atol=0.01)


def test_a_parked_car_hides_the_child_until_it_is_nearly_in_the_lane(steadily: Callable[[str], Path]) -> None:
    recorded = read_run(steadily(OBSTRUCTED))
    assert recorded.sensing is not None
    told, time = recorded.sensing.flags["told"], recorded.sensing.numbers["time_s"]
    walker, middle = person(recorded), recorded.egos.numbers["front_y_m"].mean()
    hidden_until = time[told].min()
    across = middle - np.interp(hidden_until, walker["time_s"], walker["y_m"])
    # The sensor's line past the corner at 1.9 m is 2.0 to 2.3 m off the walk; the edge of the disc shows first.
    assert 1.7 < across < 2.6


@pytest.mark.long
def test_the_same_case_is_the_same_run(tmp_path: Path) -> None:
    (case,) = cases("suite:fmvss127/crossing_right_25_30kmh")
    folders = [tmp_path / name for name in ("one", "other")]
    described = [run(RunRequest(case.reference, "aeb", out=folder)).description for folder in folders]
    assert described[0]["run_id"] == described[1]["run_id"]
    tables = [(folder / "egos.parquet").read_bytes() for folder in folders]
    assert tables[0] == tables[1]


@pytest.mark.long
def test_verdicts_of_a_driver_who_does_nothing_and_of_one_who_stops(tmp_path: Path) -> None:
    (case,) = cases("suite:euroncap2026/cpna_25_40kmh")
    for controller, colour, passed in (("constant_speed", "red", False), ("vo_mpc", "green", True)):
        driven(case, tmp_path / controller, controller)
        verdict = judge(tmp_path / controller, case)
        assert (verdict.colour, verdict.passed, verdict.counts) == (colour, passed, not passed)
        assert verdict.preventable
    assert judging.label("euroncap2026").startswith("after Euro NCAP")
