"""Who moved into whom, when an ego and a vehicle overlap."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from analysis.results.analyse import analyse_run
from tests.analysis.recorded import Ego, Vehicle, line, write_run


def overlap(folder: Path, ego: Ego, vehicle: Vehicle, **keys: Any) -> dict[str, Any]:
    report = analyse_run(write_run(folder, [ego], [], [vehicle], **keys))
    (row,) = report.overlaps
    assert report.run["n_vehicle_overlaps"] == 1
    assert report.run["n_vehicle_overlaps_ego_closed"] == int(row["closed_by"] == "ego")
    return dict(row)


def test_an_ego_that_runs_into_the_vehicle_ahead_closed_the_gap(tmp_path: Path) -> None:
    row = overlap(tmp_path, Ego(line(0, 0, 10, 0)), Vehicle(line(20, 0, 4, 0)))
    assert row["closed_by"] == "ego"
    # 15.5 m of gap at 6 m/s.
    assert row["t_start_s"] == pytest.approx(15.5 / 6, abs=0.051)
    assert row["ego_closing_mps"] == pytest.approx(10.0, abs=1e-6)
    assert row["other_closing_mps"] == pytest.approx(-4.0, abs=1e-6)


def test_a_vehicle_that_runs_into_the_ego_from_behind_closed_it(tmp_path: Path) -> None:
    row = overlap(tmp_path, Ego(line(0, 0, 4, 0)), Vehicle(line(-20, 0, 10, 0)))
    assert row["closed_by"] == "other"


def test_an_ego_that_drifts_into_a_vehicle_beside_it_closed_it(tmp_path: Path) -> None:
    ego = Ego(lambda t: (8.0 * t, 0.4 * t))
    assert overlap(tmp_path, ego, Vehicle(line(0, 3.2, 8, 0)))["closed_by"] == "ego"


def test_a_vehicle_that_jumps_over_the_lane_line_closed_it(tmp_path: Path) -> None:
    def jumps(t: float) -> tuple[float, float]:
        return 8.0 * t, 3.2 if t < 1.95 else 1.0

    row = overlap(tmp_path, Ego(line(0, 0, 8, 0)), Vehicle(jumps), duration=3.0)
    assert row["closed_by"] == "other"


def test_a_vehicle_that_appears_inside_the_ego_was_closed_by_nobody(tmp_path: Path) -> None:
    row = overlap(tmp_path, Ego(line(0, 0, 8, 0)), Vehicle(line(2, 0, 8, 0), start=1.0), duration=3.0)
    assert row["closed_by"] == "appeared"
    assert row["ego_closing_mps"] is None


def test_vehicles_in_the_next_lane_do_not_overlap(tmp_path: Path) -> None:
    report = analyse_run(
        write_run(tmp_path, [Ego(line(0, 0, 8, 0))], [], [Vehicle(line(0, 3.2, 8, 0))], duration=3.0)
    )
    assert report.overlaps == []


def test_an_ego_that_comes_later_than_the_vehicle_is_met_where_it_is(tmp_path: Path) -> None:
    # At 3 s their middles are 14 m apart: 9.5 m of gap at 6 m/s.
    row = overlap(tmp_path, Ego(line(-12, 0, 10, 0), start=3.0), Vehicle(line(20, 0, 4, 0)))
    assert row["t_start_s"] == pytest.approx(3.0 + 9.5 / 6, abs=0.051)
    assert row["closed_by"] == "ego"
