"""Metrics of the ride and of the controller, on rides that can be worked out by hand."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.encounters.moments import stopping_distance
from analysis.metrics import injury_risk_mm2025, injury_risk_rosen2009
from analysis.metrics.deadlock import Stand, first_stand
from analysis.recording.columns import INTERVENTIONS
from analysis.results.analyse import analyse_run
from tests.analysis.recorded import ZEBRA, Ego, Motion, Person, line, write_run


def summary(folder: Path, ego: Ego, *persons: Person, **keys: Any) -> dict[str, Any]:
    return dict(analyse_run(write_run(folder, [ego], persons, **keys)).run)


def recorded(**columns: Callable[[float], Any]) -> Ego:
    return Ego(line(0, 0, 10, 0), columns=columns)


def stops(at: float, until: float) -> Motion:
    """Return 10 m/s, standing between two instants."""
    return lambda t: (10.0 * (t if t < at else at if t < until else t - until + at), 0.0)


def test_delay_is_the_time_lost_against_the_limit(tmp_path: Path) -> None:
    run = summary(tmp_path, recorded(speed_limit_mps=lambda t: 12.5))
    assert run["ego_time_loss_s"] == pytest.approx(10.0 - 100.0 / 12.5)
    assert run["ego_mean_speed_mps"] == pytest.approx(10.0)
    assert run["ego_dist_km"] == pytest.approx(0.1)


def test_without_a_recorded_limit_there_is_no_delay(tmp_path: Path) -> None:
    assert "ego_time_loss_s" not in summary(tmp_path, recorded(speed_limit_mps=lambda t: None))


def test_a_lane_change_counts_once_it_is_kept(tmp_path: Path) -> None:
    def lane(t: float) -> int:
        return 0 if t < 2 else 1 if t < 3 else 0 if t < 5 else 1

    assert summary(tmp_path, recorded(lane_number=lane))["n_lane_changes"] == 1


def test_a_lane_change_soon_after_the_ego_appears_counts(tmp_path: Path) -> None:
    soon = recorded(lane_number=lambda t: 0 if t < 1.5 else 1)
    assert summary(tmp_path, soon)["n_lane_changes"] == 1


def test_decisions_unsolved_plans_interventions_and_slack_are_counted(tmp_path: Path) -> None:
    def when(start: float, end: float, inside: Any, outside: Any) -> Callable[[float], Any]:
        return lambda t: inside if start - 1e-9 <= t < end - 1e-9 else outside

    ego = recorded(
        rule=when(1.0, 2.0, "lane_change", "straight"),
        solved=when(3.0, 3.5, False, True),
        plan_status=when(3.0, 3.5, "comfort_stop", "ok"),
        intervention=when(5.0, 5.3, True, False),
        slack_m=when(6.0, 7.0, 0.06, 0.04),
    )
    run = summary(tmp_path, ego, Person(line(32.5, -4, 0, 1.25)))
    assert (run["n_straight"], run["n_lane_change"], run["n_autonomous"]) == (91, 10, 0)
    assert run["n_plans"] == 101
    assert run["n_solver_fail"] == 5
    assert run["n_interventions"] == 3
    assert run["slack_share"] == pytest.approx(10 / 101)


def test_interventions_are_counted_by_cause(tmp_path: Path) -> None:
    def cause(t: float) -> str | None:
        return "tight_bend" if 5.0 <= t < 5.25 else "held" if 6.0 <= t < 6.15 else None

    ego = recorded(intervention=lambda t: cause(t) is not None, intervention_cause=cause)
    run = summary(tmp_path, ego, Person(line(32.5, -4, 0, 1.25)))
    counts = {name: run[f"n_interventions_{name}"] for name in INTERVENTIONS}
    assert counts == {**dict.fromkeys(INTERVENTIONS, 0), "tight_bend": 3, "held": 2}
    assert run["n_interventions"] == 5


def test_plans_that_the_last_check_replaced_are_counted(tmp_path: Path) -> None:
    ego = recorded(plan_status=lambda t: "shielded" if 3.0 - 1e-9 <= t < 3.5 - 1e-9 else "ok")
    assert summary(tmp_path, ego)["n_shielded"] == 5


def _solved(status: str, t: float) -> bool:
    return not 2.0 <= t < 2.2 or status == "ok"


def _status(status: str, t: float) -> str:
    return status


def test_a_fallback_within_an_encounter_is_its_status(tmp_path: Path) -> None:
    for status, expected in (("comfort_stop", "infeasible"), ("time_limit", "timeout"), ("ok", "ok")):
        ego = Ego(
            line(-21.2, 0, 10, 0),
            columns={
                "solved": partial(_solved, status),
                "plan_status": partial(_status, status),
            },
        )
        folder = write_run(tmp_path / status, [ego], [Person(line(32.5, -4, 0, 1.25))])
        assert analyse_run(folder).encounters[0]["controller_status"] == expected


def test_only_a_pedestrian_who_changes_sides_is_a_side_change(tmp_path: Path) -> None:
    classes = [
        "",
        "behind=a ahead=",
        "behind=a|b ahead=",
        "behind=b ahead=a",
        "behind= ahead=b|a",
        "behind= ahead=b",
        "",
        "behind=b ahead=",
        "",
    ]

    def passing(t: float) -> str:
        return classes[min(int(t + 1e-6), len(classes) - 1)]

    # a goes ahead, b goes ahead, and b behind again although no plan in between named them.
    assert summary(tmp_path, recorded(passing=passing))["side_changes"] == 3


def test_hard_braking_is_counted_by_manoeuvre_and_jerk_over_its_window(tmp_path: Path) -> None:
    ego = recorded(acceleration_mps2=lambda t: -5.0 if 2.0 <= t < 3.0 or 5.0 <= t < 5.2 else 0.0)
    run = summary(tmp_path, ego, Person(line(60, -4, 0, 0.8)))
    assert run["n_hard_brake"] == 2
    assert run["max_decel_mps2"] == 5.0
    report = analyse_run(tmp_path)
    # 5 m/s² within the window of 0.2 s.
    assert report.encounters[0]["ego_max_abs_jerk_mps3"] == pytest.approx(25.0)


def test_a_stop_with_the_body_over_the_crossing_is_counted(tmp_path: Path) -> None:
    on = summary(tmp_path / "on", Ego(stops(3.0, 6.0)))
    before = summary(tmp_path / "before", Ego(stops(2.5, 6.0)))
    brief = summary(tmp_path / "brief", Ego(stops(3.0, 3.6)))
    assert [run["n_stopped_on_crossing"] for run in (on, before, brief)] == [1, 0, 0]


@pytest.mark.parametrize(
    ("until", "gap", "kind", "expected"),
    [(50.0, None, "zebra", 0), (70.0, None, "zebra", 1), (70.0, 5.0, "zebra", 0), (70.0, None, "signal", 0)],
)
def test_a_long_stand_is_a_deadlock_where_the_road_is_free(
    tmp_path: Path, until: float, gap: float | None, kind: str, expected: int
) -> None:
    ego = Ego(stops(2.5, until), columns={"gap_ahead_m": lambda t: gap})
    area = {**ZEBRA, "crossing_kind": kind}
    found = summary(tmp_path, ego, duration=80.0, step=0.5, areas=[area])
    assert found["deadlock"] == expected
    assert (found["deadlock_where"] is not None) == bool(expected)


def test_the_distance_from_a_long_crossing_is_that_from_its_nearest_point(tmp_path: Path) -> None:
    """The ego waits for a red light 39.5 m from the middle of the crossing, and 44 m from its ends."""
    ego = Ego(stops(0.0, 70.0), columns={"gap_ahead_m": lambda t: None})
    area = {**ZEBRA, "crossing_kind": "signal", "shape_m": [[39.5, -20.0], [39.5, 20.0]]}
    assert summary(tmp_path, ego, duration=80.0, step=0.5, areas=[area])["deadlock"] == 0


def test_a_deadlock_says_who_when_and_where(tmp_path: Path) -> None:
    ego = Ego(stops(2.5, 70.0), columns={"gap_ahead_m": lambda t: None})
    found = summary(tmp_path, ego, duration=80.0, step=0.5, areas=[ZEBRA])
    assert re.fullmatch(
        rf"ego ego, \d+\.\d to 69\.\d s, at crossing {ZEBRA['name']}", found["deadlock_where"]
    ), found["deadlock_where"]
    stand = first_stand(found["deadlock_where"])
    assert stand is not None
    assert (stand.ego_id, stand.end_s, stand.place) == ("ego", 69.5, f"at crossing {ZEBRA['name']}")
    assert str(stand) == found["deadlock_where"]


def test_the_first_of_several_stands_is_read_whatever_egos_are_called() -> None:
    first = Stand("a, 1 to 2 s, on lane x", 5.0, 70.5, "on lane in, 0")
    assert first_stand(f"{first}; {Stand('b', 6.0, 80.0, 'at crossing c')}") == first
    assert first_stand("") is None


def test_control_time_percentiles_come_from_the_timing_file(tmp_path: Path) -> None:
    run = summary(tmp_path, recorded())
    assert (run["compute_p50_ms"], run["compute_p99_ms"]) == (1.0, 1.0)


def test_the_risk_perception_coefficient_is_way_over_speed(tmp_path: Path) -> None:
    write_run(tmp_path, [Ego(line(-21.2, 0, 10, 0))], [Person(line(32.5, -4, 0, 1.25))])
    (row,) = analyse_run(tmp_path).encounters
    # From 0.9 s on, 4.22 s before the area, until its entry at 5.12 s: k falls from 4.22 to 0.02.
    assert row["k_mean_s"] == pytest.approx((4.22 + 0.02) / 2, abs=1e-6)


@pytest.mark.parametrize(
    ("speed_kmh", "fatal", "mais3"), [(30, 0.015, 0.147), (50, 0.083, 0.413), (80, 0.574, 0.854)]
)
def test_injury_risks_are_those_of_their_tables(speed_kmh: float, fatal: float, mais3: float) -> None:
    assert injury_risk_rosen2009.risk(speed_kmh) == pytest.approx(fatal, abs=6e-4)
    assert injury_risk_mm2025.risk(speed_kmh, 75.0) == pytest.approx(mais3, abs=6e-4)


def test_the_careful_driver_stops_within_the_published_distances() -> None:
    speeds = np.array([20.0, 30.0, 40.0, 50.0, 60.0]) / 3.6
    needed = stopping_distance(speeds, 0.75, 7.59, 0.6)
    assert needed == pytest.approx([7.8, 13.2, 19.7, 27.2, 35.7], abs=0.06)
    assert needed / speeds == pytest.approx([1.40, 1.59, 1.77, 1.96, 2.14], abs=0.006)


def test_a_slow_ego_stops_while_the_braking_still_rises() -> None:
    speed = np.array([1.0])
    jerk = 7.59 / 0.6
    assert stopping_distance(speed, 0.0, 7.59, 0.6)[0] == pytest.approx(
        (2 / 3) * float(np.sqrt(2 / jerk)), rel=1e-9
    )


def test_a_side_change_is_that_of_the_pedestrian_of_the_encounter(tmp_path: Path) -> None:
    ego = recorded(passing=lambda t: "behind=a|b ahead=" if t < 2.0 else "behind=a ahead=b")
    people = [Person(line(32.5, -4, 0, 1.25), name="a"), Person(line(32.5, -5, 0, 1.25), name="b")]
    rows = analyse_run(write_run(tmp_path, [ego], people)).encounters
    assert {row["ped_id"]: row["side_changes"] for row in rows} == {"a": 0, "b": 1}


def test_the_stop_of_an_ego_that_came_later_is_counted_as_well(tmp_path: Path) -> None:
    # 2 s after somebody far away was recorded first; it stands over the crossing for 3 s.
    run = summary(tmp_path, Ego(stops(3.0, 6.0), start=2.0), Person(line(32.5, -80, 0, 0)))
    assert run["n_stopped_on_crossing"] == 1


def test_the_part_of_a_method_is_counted_over_the_plans_of_encounters(tmp_path: Path) -> None:
    """Two pedestrians wait where the ego passes; of ten seconds some belong to an encounter."""
    ego = recorded(
        method_stated=lambda t: True,
        method_applies=lambda t: t < 4.0,
        method_acts=lambda t: t < 1.0,
        method_deviates=lambda t: True,
        method_overridden=lambda t: False,
    )
    run = summary(tmp_path, ego, Person(line(40, 3, 0, -0.5)))
    assert run["method_deviates_share"] == pytest.approx(1.0)
    assert run["method_overridden_share"] == pytest.approx(0.0)
    # The encounter begins with the run: 39 plans end before 4 s, 9 of them before 1 s.
    assert run["method_acts_where_applies_share"] == pytest.approx(9 / 39, abs=0.03)
    assert run["method_applies_share"] * run["n_plans_near_ped"] == pytest.approx(39, abs=1)
    assert run["n_plans_near_ped"] > 39


def test_a_controller_without_a_method_has_no_share(tmp_path: Path) -> None:
    run = summary(tmp_path, recorded(), Person(line(40, 3, 0, -0.5)))
    assert "method_applies_share" not in run
