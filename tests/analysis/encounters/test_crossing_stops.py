"""Stops on a crossing that the driver could have foreseen, on rides that can be worked out by hand.

The ego comes at 10 m/s and stops over the crossing from 3 s on, with its front bumper at 32.25 m; the
crossing reaches from 30.5 m to 34.5 m. With 3 m/s^2 it could last have stopped before it at 1.16 s. Until
its rear has left the crossing, its front gets to 39 m.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.results.analyse import analyse_run
from tests.analysis.recorded import Ego, Person, Vehicle, line, write_run


def foreseeable(folder: Path, *others: Person | Vehicle, until: float = 6.0, start: float = 0.0) -> int:
    """Return how many stops were foreseeable, of the one that there is."""

    def motion(t: float) -> tuple[float, float]:
        return 10.0 * (t if t < 3.0 else 3.0 if t < until else t - until + 3.0), 0.0

    persons = [one for one in others if isinstance(one, Person)]
    vehicles = [one for one in others if isinstance(one, Vehicle)]
    run = analyse_run(write_run(folder, [Ego(motion, start=start)], persons, vehicles)).run
    assert run["n_stopped_on_crossing"] == 1
    return int(run["n_stopped_on_crossing_foreseeable"])


@pytest.mark.parametrize(
    ("x", "y", "expected"), [(36.5, 0.0, 1), (41.0, 0.0, 1), (41.5, 0.0, 0), (36.5, 1.7, 1), (36.5, 1.9, 0)]
)
def test_a_car_that_stood_where_the_ego_had_to_clear_the_crossing_was_to_be_foreseen(
    tmp_path: Path, x: float, y: float, expected: int
) -> None:
    assert foreseeable(tmp_path, Vehicle(line(x, y, 0.0, 0.0))) == expected


@pytest.mark.parametrize(("came", "expected"), [(1.0, 1), (1.4, 0)])
def test_a_car_that_came_to_stand_later_was_not(tmp_path: Path, came: float, expected: int) -> None:
    def motion(t: float) -> tuple[float, float]:
        return 36.5, -10.0 * max(0.0, came - t)

    assert foreseeable(tmp_path, Vehicle(motion)) == expected


@pytest.mark.parametrize(("y", "expected"), [(0.5, 1), (1.1, 1), (1.2, 0)])
def test_a_pedestrian_who_stood_in_the_way_was_to_be_foreseen(
    tmp_path: Path, y: float, expected: int
) -> None:
    assert foreseeable(tmp_path, Person(line(35.0, y, 0.0, 0.0))) == expected


def test_a_pedestrian_with_the_name_of_the_ego_is_somebody_else(tmp_path: Path) -> None:
    """SUMO lets a vehicle and a person share an id; randomTrips.py numbers both from 0."""
    assert foreseeable(tmp_path, Person(line(35.0, 0.5, 0.0, 0.0), name="ego")) == 1


def test_an_ego_that_never_leaves_the_crossing_would_have_gone_straight_on(tmp_path: Path) -> None:
    stays = {"until": 99.0}
    assert foreseeable(tmp_path / "in", Vehicle(line(38.0, 0.0, 0.0, 0.0)), **stays) == 1
    assert foreseeable(tmp_path / "beyond", Vehicle(line(39.5, 0.0, 0.0, 0.0)), **stays) == 0


def test_an_ego_recorded_only_when_it_was_too_late_could_foresee_nothing(tmp_path: Path) -> None:
    assert foreseeable(tmp_path, Vehicle(line(36.5, 0.0, 0.0, 0.0)), start=1.5) == 0
