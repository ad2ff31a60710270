"""Everybody is judged as an ego is: a car that drives like the ego has the ego's numbers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from analysis.files import read_csv
from analysis.results.analyse import analyse_run
from analysis.results.exposure_rows import EXPOSURE
from analysis.results.traffic_rows import TRAFFIC_ENCOUNTERS
from tests.analysis.recorded import Ego, Motion, Person, line, write_run, write_traffic

OWN = {
    "traffic_encounter_id",
    "vehicle_id",
    "is_ego",
    "controller",
    "encounter_id",
    "passage_id",
    "vehicle_class",
}


def braking(t: float) -> tuple[float, float]:
    """Return 10 m/s, from 1 s on braked with 2 m/s^2: it comes to stand on the crossing."""
    gone = max(0.0, min(t, 6.0) - 1.0)
    return 10.0 * min(t, 1.0) + 10.0 * gone - gone**2, 0.0


PERSONS = (
    Person(line(32.5, -4, 0, 1.25), name="crosses"),
    Person(line(32.5, -4.5, 0, 1.6), name="is_hit"),
    Person(line(32.5, -4, 0, 0), name="waits", phase=lambda t: "waiting"),
    Person(line(34.0, 6.0, 0, -0.7), name="comes_later", phase=lambda t: "waiting" if t < 3 else "crossing"),
    Person(line(20.0, -8, 0, 1.0), name="jaywalks", crossing=None, phase=lambda t: "walking"),
    Person(line(90.0, -4, 0, 1.25), name="far", crossing=None, phase=lambda t: "walking"),
)


def rows_of(folder: Path, motion: Motion) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return the rows of an ego and of a car that drives like it, in one run."""
    ego = Ego(motion)
    write_run(folder, [ego], PERSONS)
    write_traffic(folder, [replace(ego, name="car")], PERSONS)
    analyse_run(folder)
    rows = read_csv(folder / TRAFFIC_ENCOUNTERS.file)
    return [row for row in rows if row["is_ego"] == "1"], [row for row in rows if row["is_ego"] == "0"]


@pytest.mark.parametrize("motion", [line(0, 0, 10, 0), braking, line(5, 0.5, 6, 0)])
def test_a_car_that_drives_like_the_ego_has_the_ego_s_numbers(tmp_path: Path, motion: Motion) -> None:
    egos, cars = rows_of(tmp_path, motion)
    assert [row["ped_id"] for row in egos] == [row["ped_id"] for row in cars]
    assert len(egos) >= 3
    for own, other in zip(egos, cars, strict=True):
        assert (own["controller"], other["controller"]) == ("scripted", "sumo")
        for name in own.keys() - OWN:
            try:
                assert float(own[name]) == pytest.approx(float(other[name]), abs=2e-6), name
            except ValueError:
                assert own[name] == other[name], name


def test_egos_have_the_values_of_encounters_csv(tmp_path: Path) -> None:
    egos, _ = rows_of(tmp_path, line(0, 0, 10, 0))
    listed = {row["encounter_id"]: row for row in read_csv(tmp_path / "encounters.csv")}
    for row in egos:
        shared = row.keys() & listed[row["encounter_id"]].keys()
        assert len(shared) > 60
        assert {name: row[name] for name in shared} == {
            name: listed[row["encounter_id"]][name] for name in shared
        }


def test_recording_everybody_changes_nothing_of_an_ego(tmp_path: Path) -> None:
    write_run(tmp_path / "egos", [Ego(braking)], PERSONS)
    analyse_run(tmp_path / "egos")
    rows_of(tmp_path / "everybody", braking)
    for name in ("encounters.csv", "runs.csv", "vehicle_overlaps.csv"):
        assert (tmp_path / "egos" / name).read_bytes() == (tmp_path / "everybody" / name).read_bytes()


def test_who_uses_a_crossing_is_counted_whether_they_meet_or_not(tmp_path: Path) -> None:
    rows_of(tmp_path, line(0, 0, 10, 0))
    (row,) = read_csv(tmp_path / EXPOSURE.file)
    assert (row["n_vehicles"], row["n_cyclists"], row["n_red_light_walkers"]) == ("2", "0", "0")
    assert row["n_pedestrians"] == "3"  # two who cross, and the one who comes later
    assert float(row["vehicle_speed_mean_mps"]) == pytest.approx(10.0)
    assert float(row["length_m"]) > 5.0


def test_a_run_without_other_vehicles_has_pedestrians_on_its_crossings(tmp_path: Path) -> None:
    ego = Ego(line(0, 0, 10, 0))
    write_run(tmp_path, [ego], PERSONS)
    write_traffic(tmp_path, [], PERSONS)
    analyse_run(tmp_path)
    (row,) = read_csv(tmp_path / EXPOSURE.file)
    assert (row["n_vehicles"], row["n_pedestrians"]) == ("1", "3")
    assert {one["is_ego"] for one in read_csv(tmp_path / TRAFFIC_ENCOUNTERS.file)} == {"1"}
