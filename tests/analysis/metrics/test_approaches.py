"""Metrics of an ego that drives at somebody, or closely past them, on rides that can be worked out by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.results.analyse import RunReport, analyse_run
from tests.analysis.recorded import Ego, Person, line, write_run


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> RunReport:
    """Return 20 m at 10 m/s towards somebody in the lane: TTC is 3.22 s at first, 1.22 s at the end.

    The front begins at 2.25 m, the disc at 34.45 m; the samples are 0.05 s apart.
    """
    folder = tmp_path_factory.mktemp("approach")
    person = Person(line(34.7, 0, 0, 0), phase=lambda t: "crossing")
    return analyse_run(write_run(folder, [Ego(line(0, 0, 10, 0))], [person], duration=2.0))


def test_the_time_to_collision_falls_to_the_end(report: RunReport) -> None:
    (row,) = report.encounters
    assert (row["min_ttc_s"], row["t_min_ttc_s"]) == pytest.approx((1.22, 2.0))
    assert row["t2_min_s"] == pytest.approx(1.22), "on a collision course it is TTC"


def test_time_below_a_limit_counts_by_samples(report: RunReport) -> None:
    (row,) = report.encounters
    # Below 3 s from 0.22 s on: samples 0.25 to 1.95 s. Below 1.5 s from 1.72 s on: samples 1.75 to 1.95 s.
    assert (row["tet_3p0_s"], row["tet_1p5_s"]) == pytest.approx((35 * 0.05, 5 * 0.05))
    # Sums of t − 0.22 s and of t − 1.72 s over these samples.
    assert row["tit_3p0_s2"] == pytest.approx(0.05 * 35 * (1.10 - 0.22))
    assert row["tit_1p5_s2"] == pytest.approx(0.05 * 5 * (1.85 - 1.72))
    assert report.run["tet_1p5_s"] == pytest.approx(0.25)


def test_without_braking_the_smallest_ttc_is_the_instant_of_the_conflict(report: RunReport) -> None:
    (row,) = report.encounters
    assert (row["evasive_status"], row["evasive_t_s"]) == ("none", None)
    assert row["time_to_accident_s"] == pytest.approx(1.22)
    assert row["conflicting_speed_mps"] == pytest.approx(10.0)
    assert row["max_speed_mps"] == pytest.approx(10.0)
    assert row["delta_s_mps"] == pytest.approx(10.0)
    # 1500 kg against 75 kg.
    assert row["delta_v_ped_mps"] == pytest.approx(10.0 * 20 / 21)


def test_the_deceleration_needed_is_to_stop_before_the_pedestrian(report: RunReport) -> None:
    (row,) = report.encounters
    # 12.2 m are left at last, 2.2 m after a reaction time of 1 s.
    assert row["drac_max_mps2"] == pytest.approx(10.0**2 / (2 * 12.2))
    assert row["mdrac_max_mps2"] == pytest.approx(10.0**2 / (2 * 2.2))
    assert (row["mdrac_prt_s"], row["mdrac_status"]) == (1.0, "ok")
    assert (report.run["n_drac_gt_3p4"], report.run["n_mdrac_gt_3p4"]) == (1, 1)


def test_a_conflict_counts_against_way_and_pedestrians(report: RunReport) -> None:
    assert report.run["n_conflicts"] == 1
    # One on 20 m, with one pedestrian.
    assert report.run["conflicts_per_veh_km"] == pytest.approx(50.0)
    assert report.run["conflicts_per_1000_ped"] == pytest.approx(1000.0)


@pytest.mark.parametrize(("speed", "close_passes"), [(10.0, 1), (2.0, 0)])
def test_a_pass_is_close_where_it_is_fast_too(tmp_path: Path, speed: float, close_passes: int) -> None:
    # 0.3 m between the side of the car and the disc.
    person = Person(line(20, -(0.9 + 0.25 + 0.3), 0, 0), phase=lambda t: "crossing")
    report = analyse_run(write_run(tmp_path, [Ego(line(10, 0, speed, 0))], [person]))
    (row,) = report.encounters
    assert row["close_pass_speed_mps"] == pytest.approx(speed)
    assert row["clearance_min_m"] == pytest.approx(0.3)
    assert report.run["n_close_passes"] == close_passes
