"""Who let whom go first at a crossing, and how long pedestrians waited, through the files of a recorded run."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.files import read_csv
from analysis.results.analyse import analyse_run
from analysis.results.exposure_rows import EXPOSURE
from tests.analysis.encounters.analysed import analyse, crosses, only
from tests.analysis.recorded import ZEBRA, Ego, Person, line, write_run, write_traffic


def test_where_signals_decide_nobody_yields(tmp_path: Path) -> None:
    area = {**ZEBRA, "crossing_kind": "signal"}
    person = Person(line(32.5, -2.6, 0, 0), phase=crosses(1e9, 1e9, waits_from=0.0))
    report = analyse(tmp_path, Ego(line(-21.2, 0, 10, 0)), person, areas=(area,))
    assert only(report)["yielded"] is None
    assert only(report)["priority"] == "none"
    assert report.run["yieldable"] == 0


def test_a_yielding_ego_is_counted_with_its_delay_braking_and_stop(tmp_path: Path) -> None:
    def brakes(t: float) -> tuple[float, float]:
        # 10 m/s, from 3 s on −2.5 m/s²: stands from 7 s on at x = 23, drives on at 9 s.
        if t < 3.0:
            x = 10.0 * t
        elif t < 7.0:
            x = 10.0 * t - 1.25 * (t - 3.0) ** 2
        else:
            x = 50.0 + max(t - 9.0, 0.0) ** 2
        return x - 27.0, 0.0

    walk = Person(lambda t: (32.5, -6.0 + 1.25 * t), phase=crosses(0.8, 8.8, waits_from=0.0))
    report = analyse(tmp_path, Ego(brakes), walk, duration=15.0)
    row = only(report)
    assert row["yielded"] is True
    assert report.run["yield_rate"] == 1.0
    assert row["ego_stopped"] is True
    assert row["ego_max_decel_mps2"] == pytest.approx(2.5, abs=0.01)
    assert row["evasive_status"] == "braked"
    assert row["evasive_t_s"] == pytest.approx(3.0, abs=0.11)
    assert row["first_user"] == "ped"
    assert row["ped_delay_s"] == pytest.approx(0.0, abs=0.02)
    assert row["preventable_r157"] == 1.0


@pytest.mark.parametrize(
    ("enters_at", "hit"),
    # The ego drives on, in the shared ground from 4.0 to 4.5 s; they are on the crossing from the beginning.
    [(5.0, False), (3.0, True)],
)
def test_who_drives_on_past_or_into_a_pedestrian_did_not_yield(
    tmp_path: Path, enters_at: float, hit: bool
) -> None:
    walk = Person(line(32.5, -1.15 - 1.25 * enters_at, 0, 1.25), phase=crosses(0.0, 9.0))
    row = only(analyse(tmp_path, Ego(line(-10, 0, 10, 0)), walk, duration=12.0))
    assert row["collision"] is hit
    assert row["yielded"] is False


def test_the_waiting_of_a_pedestrian_is_their_delay(tmp_path: Path) -> None:
    def waits(t: float) -> tuple[float, float]:
        return 32.5, -5.0 + (1.25 * t if t < 1.0 else 1.25 if t < 4.0 else 1.25 + 1.25 * (t - 4.0))

    person = Person(waits, phase=crosses(4.0, 10.0, waits_from=0.0))
    row = only(analyse(tmp_path, Ego(line(0, 0, 10, 0)), person, duration=12.0))
    assert row["ped_wait_s"] == pytest.approx(3.0, abs=0.2)
    assert row["ped_delay_s"] == pytest.approx(3.0, abs=0.11)


def test_an_earlier_walk_over_the_crossing_is_no_delay_of_the_next_one(tmp_path: Path) -> None:
    # Waits 10 s, crosses in 8 s, walks on for 1 s, turns and crosses at once, in 8 s.
    turns_s = 19.0

    def walks(t: float) -> tuple[float, float]:
        way = 1.25 * max(min(t, turns_s) - 10.0, 0.0) - 1.25 * max(t - turns_s, 0.0)
        return 32.5, -5.0 + way

    def phase(t: float) -> str:
        if 10.0 <= t <= 18.0 or 20.0 <= t <= 28.0:
            return "crossing"
        return "waiting" if t < 10.0 else "walking"

    # The ego comes for the second walk: at the crossing 26 s after the beginning.
    person = Person(walks, phase=phase)
    folder = write_run(tmp_path, [Ego(line(32.5 - 260.0, 0, 10, 0))], [person], duration=30.0)
    write_traffic(folder, [], [person])
    row = only(analyse_run(folder))
    assert row["ped_wait_s"] == 0.0
    assert row["ped_delay_s"] == pytest.approx(0.0, abs=0.2)
    (used,) = read_csv(folder / EXPOSURE.file)
    assert (used["n_pedestrians"], used["n_ped_delay_defined"]) == ("2", "2")
    assert float(used["ped_delay_sum_s"]) == pytest.approx(10.0, abs=0.3)


def test_an_arrival_for_an_earlier_walk_is_no_chance_to_yield(tmp_path: Path) -> None:
    """They cross before the ego, turn, and step out again when it can no longer stop."""

    def back_and_forth(t: float) -> tuple[float, float]:
        return 32.5, min(-6.0 + 2.0 * max(t - 3.0, 0.0), 6.0) if t < 11.2 else max(
            6.0 - 2.0 * (t - 11.2), -8.0
        )

    def phase(t: float) -> str:
        on_it = abs(back_and_forth(t)[1]) < 5.0
        return "crossing" if on_it else "waiting" if t < 4.0 or 10.9 < t < 12.0 else "walking"

    ego = Ego(line(-20, 0, 4, 0))
    for start in (0.0, 9.5):
        person = Person(back_and_forth, phase=phase, start=start)
        report = analyse(tmp_path / f"{start:g}", ego, person, duration=20.0)
        assert [row["yielded"] for row in report.encounters] == [None]
        assert report.run["yieldable"] == 0


def test_the_delay_of_a_pedestrian_is_that_of_the_last_walk_whatever_encounter_begins_last(
    tmp_path: Path,
) -> None:
    """The ego that stands there all the time meets them on both walks, the other one on the first."""

    def twice(t: float) -> tuple[float, float]:
        there = -8.0 + 1.6 * min(max(t - 4.0, 0.0), 10.0)
        return 32.5, there if t < 30.0 else max(-8.0, 8.0 - 0.8 * (t - 30.0))

    def phase(t: float) -> str:
        return "crossing" if abs(twice(t)[1]) < 5.0 else "walking" if t > 45.0 else "waiting"

    egos = [Ego(line(0, 0, 0, 0), name="stands"), Ego(line(-90, 0, 10, 0), name="passes")]
    report = analyse_run(write_run(tmp_path, egos, [Person(twice, phase=phase)], duration=60.0))
    both, first = report.encounters
    assert (both["ego_id"], first["ego_id"]) == ("stands", "passes")
    assert both["ped_delay_s"] > first["ped_delay_s"] + 10.0
    assert report.run["ped_delay_mean_s"] == pytest.approx(both["ped_delay_s"])
