"""Everybody is judged as an ego is: a car that drives like the ego has the ego's numbers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

import analysis.recording.traffic
from analysis.errors import RecordingError
from analysis.files import read_csv
from analysis.recording.columns import TRAFFIC
from analysis.recording.reading import read_run
from analysis.recording.traffic import Traffic
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


FAR_AWAY = line(0.0, 900.0, 1.0, 0.0)


def rows_of(
    folder: Path, motion: Motion, of_car: Motion | None = None
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return the rows of an ego and of a car in one run; by default, the car drives like the ego."""
    ego = Ego(motion)
    write_run(folder, [ego], PERSONS)
    write_traffic(folder, [replace(ego, name="car", motion=of_car or motion)], PERSONS)
    analyse_run(folder)
    rows = read_csv(folder / TRAFFIC_ENCOUNTERS.file)
    return [row for row in rows if row["is_ego"] == "1"], [row for row in rows if row["is_ego"] == "0"]


@pytest.mark.parametrize("motion", [line(0, 0, 10, 0), braking, line(5, 0.5, 6, 0)])
def test_a_car_that_drives_like_the_ego_has_the_ego_s_numbers(tmp_path: Path, motion: Motion) -> None:
    # In one run, each of two cars in the same place would hide pedestrians from the other.
    egos, _ = rows_of(tmp_path / "ego", motion, FAR_AWAY)
    _, cars = rows_of(tmp_path / "car", FAR_AWAY, motion)
    assert [row["ped_id"] for row in egos] == [row["ped_id"] for row in cars]
    assert len(egos) >= 3
    for own, other in zip(egos, cars, strict=True):
        assert (own["controller"], other["controller"]) == ("scripted", "sumo")
        for name in own.keys() - OWN:
            try:
                assert float(own[name]) == pytest.approx(float(other[name]), abs=2e-6), name
            except ValueError:
                assert own[name] == other[name], name


def test_an_ego_hides_pedestrians_from_others_as_any_vehicle_does(tmp_path: Path) -> None:
    """A car passes somebody who steps out from behind a standing one: the ego, or one of SUMO's."""
    person = Person(line(32.5, -5.2, 0, 1.25))
    stands, drives = line(28.0, -2.4, 0, 0), line(0, 0, 10, 0)
    for name, ego, others in (("ego", stands, [drives]), ("sumo", FAR_AWAY, [drives, stands])):
        folder = write_run(tmp_path / name, [Ego(ego)], [person], duration=8.0)
        write_traffic(folder, [Ego(one, name=f"car{i}") for i, one in enumerate(others)], [person])
        analyse_run(folder)
        rows = read_csv(folder / TRAFFIC_ENCOUNTERS.file)
        (row,) = (row for row in rows if row["vehicle_id"] == "car0")
        assert (row["collision"], row["hidden_before_conflict"], row["preventable_r157"]) == ("1", "1", "0")


def test_egos_have_the_values_of_encounters_csv(tmp_path: Path) -> None:
    egos, _ = rows_of(tmp_path, line(0, 0, 10, 0))
    listed = {row["encounter_id"]: row for row in read_csv(tmp_path / "encounters.csv")}
    assert len(egos) >= 3
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


def long_recording(folder: Path) -> None:
    """Write a run in which cars and pedestrians come and go, in row groups of some ten steps."""
    ego = Ego(line(0, 0, 1.5, 0))
    persons = [
        Person(line(33.0 - 0.5 * n, -4.0 - 1.25 * n, 0, 1.25), name=f"ped.{9 - n}", start=n, end=n + 6.0)
        for n in range(10)
    ]
    cars = [
        Ego(line(-10.0 * n, 0, 10.0, 0), name=f"car.{9 - n}", start=n, end=n + 5.0, width=1.8 + 0.1 * n)
        for n in range(10)
    ]
    write_run(folder, [ego], persons)
    write_traffic(folder, [*cars, Ego(line(60.0, 3.0, 0, 0), name="parked")], persons)
    table = pq.read_table(folder / TRAFFIC.file)
    pq.write_table(table, folder / TRAFFIC.file, row_group_size=40)


@pytest.mark.long
def test_a_recording_judged_in_parts_gives_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    long_recording(tmp_path)
    found = []
    for rows_at_once, least_parts in ((10_000, 1), (200, 3), (1, 10)):
        monkeypatch.setattr(analysis.recording.traffic, "ROWS_AT_ONCE", rows_at_once)
        parts = [
            (len(part.run.egos), len(part.run.neighbours)) for part in Traffic(read_run(tmp_path)).parts()
        ]
        assert len(parts) >= least_parts
        assert min(parts) < max(parts) or least_parts == 1
        analyse_run(tmp_path)
        found.append([(tmp_path / table.file).read_bytes() for table in (TRAFFIC_ENCOUNTERS, EXPOSURE)])
    assert len(read_csv(tmp_path / TRAFFIC_ENCOUNTERS.file)) > 20
    assert found[0] == found[1] == found[2]


def test_a_long_recording_whose_time_goes_backwards_is_refused_with_the_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    long_recording(tmp_path)
    table = pq.read_table(tmp_path / TRAFFIC.file)
    swapped = [*range(40, 80), *range(40), *range(80, len(table))]
    pq.write_table(table.take(swapped), tmp_path / TRAFFIC.file, row_group_size=40)
    monkeypatch.setattr(analysis.recording.traffic, "ROWS_AT_ONCE", 200)
    with pytest.raises(RecordingError, match="row 41: time goes backwards"):
        analyse_run(tmp_path)
    assert not (tmp_path / TRAFFIC_ENCOUNTERS.file).exists()
    assert not (tmp_path / "encounters.csv").exists()
