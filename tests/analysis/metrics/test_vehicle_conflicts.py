"""Conflicts between egos and other vehicles, and the rear-end risk of who drives behind."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from analysis.files import read_csv
from analysis.results.analyse import RunReport, analyse_run
from tests.analysis.recorded import Ego, Motion, Vehicle, line, write_run


def judged(folder: Path, ego: Ego, *vehicles: Vehicle, **keys: Any) -> tuple[RunReport, list[dict[str, str]]]:
    report = analyse_run(write_run(folder, [ego], [], list(vehicles), **keys))
    return report, read_csv(folder / "vehicle_conflicts.csv")


def test_a_vehicle_that_closes_in_on_the_ego_from_behind_is_a_follower(tmp_path: Path) -> None:
    # 25.5 m between the bumpers at first, 6 m/s of closing speed: after 3 s there are 7.5 m left.
    report, (row,) = judged(tmp_path, Ego(line(30, 0, 4, 0)), Vehicle(line(0, 0, 10, 0)), duration=3.0)
    assert row["kind"] == "followed"
    assert (row["ego_id"], row["vehicle_id"]) == ("ego", "car")
    assert float(row["min_ttc_s"]) == pytest.approx(7.5 / 6.0, abs=1e-6)
    assert float(row["t_min_ttc_s"]) == pytest.approx(3.0)
    assert float(row["drac_max_mps2"]) == pytest.approx(6.0**2 / (2.0 * 7.5), abs=1e-6)
    assert float(row["t_start_s"]) == pytest.approx((25.5 - 18.0) / 6.0, abs=0.051), "where the TTC is 3 s"
    assert row["pet_s"] == ""
    assert report.run["n_follower_conflicts"] == 1
    assert report.run["n_follower_ttc_lt_1p5"] == 1
    assert report.run["n_follower_drac_gt_3p4"] == 0
    assert report.run["follower_min_ttc_s"] == pytest.approx(1.25, abs=1e-6)
    assert report.run["follower_max_drac_mps2"] == pytest.approx(2.4, abs=1e-6)
    assert report.run["n_vehicle_conflicts_following"] == 0


def test_an_ego_that_brakes_hard_exports_its_risk_to_the_vehicle_behind(tmp_path: Path) -> None:
    def braking(t: float) -> tuple[float, float]:
        return 20.0 + 10.0 * t - 0.5 * 5.0 * t * t, 0.0

    # The gap of 5.5 m shrinks by 2.5 t², at a closing speed of 5 t.
    report, (row,) = judged(tmp_path, Ego(braking), Vehicle(line(10, 0, 10, 0)), duration=1.0)
    assert row["kind"] == "followed"
    assert float(row["min_ttc_s"]) == pytest.approx(3.0 / 5.0, rel=1e-3)
    assert float(row["drac_max_mps2"]) == pytest.approx(5.0**2 / (2.0 * 3.0), rel=1e-3)
    assert float(row["ego_max_decel_mps2"]) == pytest.approx(5.0, rel=1e-3)
    assert report.run["n_follower_drac_gt_3p4"] == 1


def test_an_ego_behind_a_slower_vehicle_is_no_follower_of_itself(tmp_path: Path) -> None:
    report, (row,) = judged(tmp_path, Ego(line(0, 0, 10, 0)), Vehicle(line(30, 0, 4, 0)), duration=3.0)
    assert row["kind"] == "following"
    assert float(row["drac_max_mps2"]) == pytest.approx(2.4, abs=1e-6)
    assert report.run["n_vehicle_conflicts_following"] == 1
    assert report.run["n_follower_conflicts"] == 0
    assert report.run["follower_min_ttc_s"] is None
    assert report.run["follower_max_drac_mps2"] is None


def test_a_vehicle_behind_at_the_same_speed_is_in_no_conflict(tmp_path: Path) -> None:
    report, rows = judged(tmp_path, Ego(line(30, 0, 8, 0)), Vehicle(line(20, 0, 8, 0)), duration=3.0)
    assert rows == []
    assert report.run["n_follower_conflicts"] == 0


def test_a_vehicle_that_drifts_towards_the_ego_beside_it_is_beside(tmp_path: Path) -> None:
    # 3.2 − 1.8 m between the flanks, 1 m/s.
    _, (row,) = judged(tmp_path, Ego(line(0, 0, 8, 0)), Vehicle(line(0, 3.2, 8, -1)), duration=0.5)
    assert row["kind"] == "beside"
    assert float(row["min_ttc_s"]) == pytest.approx(0.9, abs=1e-6)
    assert row["drac_max_mps2"] == ""


def test_an_oncoming_vehicle_on_the_same_lane_is_oncoming(tmp_path: Path) -> None:
    other = Vehicle(line(60, 0, -10, 0), heading=math.pi)
    report, (row,) = judged(tmp_path, Ego(line(0, 0, 10, 0)), other, duration=1.0)
    assert row["kind"] == "oncoming"
    assert float(row["min_ttc_s"]) == pytest.approx((60.0 - 4.5 - 20.0) / 20.0, abs=1e-6)
    assert report.run["n_vehicle_conflicts_oncoming"] == 0, "it is not below 1.5 s"


def crossing(passes_at: float) -> Motion:
    """Northbound at 10 m/s over (50, 0) at a time."""
    return line(50, -10.0 * passes_at, 0, 10)


def test_a_vehicle_that_crosses_soon_after_the_ego_has_a_pet(tmp_path: Path) -> None:
    # The ego's rear leaves the other's lane at x = 50 + 0.9 + 2.25 m, after 5.315 s; the other's front
    # reaches the ego's lane at y = −0.9 − 2.25 m, 0.315 s before it passes the middle.
    other = Vehicle(crossing(7.0), heading=math.pi / 2)
    report, (row,) = judged(tmp_path, Ego(line(0, 0, 10, 0)), other, duration=9.0)
    assert row["kind"] == "crossing"
    assert float(row["pet_s"]) == pytest.approx(7.0 - 0.315 - 5.315, abs=0.11)
    assert row["min_ttc_s"] == ""
    assert report.run["n_vehicle_conflicts_crossing"] == 1
    assert report.run["min_vehicle_pet_s"] == pytest.approx(1.37, abs=0.11)


def test_a_vehicle_that_crosses_much_later_is_in_no_conflict(tmp_path: Path) -> None:
    other = Vehicle(crossing(10.0), heading=math.pi / 2)
    report, rows = judged(tmp_path, Ego(line(0, 0, 10, 0)), other, duration=12.0)
    assert rows == []
    assert report.run["min_vehicle_pet_s"] is None


def test_a_collision_course_with_a_crossing_vehicle_has_the_time_to_the_touch(tmp_path: Path) -> None:
    # Both reach the middle at 5 s; their bodies touch 0.315 s before.
    other = Vehicle(crossing(5.0), heading=math.pi / 2)
    _, (row,) = judged(tmp_path, Ego(line(0, 0, 10, 0)), other, duration=3.0)
    assert row["kind"] == "crossing"
    assert float(row["min_ttc_s"]) == pytest.approx(5.0 - 0.315 - 3.0, abs=1e-6)
    assert row["pet_s"] == ""
