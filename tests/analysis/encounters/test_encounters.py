"""Encounters whose numbers can be derived by hand, through the files of a recorded run."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from analysis.results.analyse import analyse_run
from analysis.thresholds import Thresholds
from tests.analysis.encounters.analysed import analyse, crosses, only
from tests.analysis.recorded import Ego, Motion, Person, line, write_run

# A car of 4.5 m x 1.8 m at 10 m/s and a disc of 0.25 m at 1.25 m/s that walks up through x = 32.5 m:
# the car is in the area while its centre is between 30 and 35 m, the disc while |y| <= 1.15 m.


def test_an_ego_that_passes_behind_has_the_post_encroachment_time_of_the_strips(tmp_path: Path) -> None:
    row = only(analyse(tmp_path, Ego(line(-21.2, 0, 10, 0)), Person(line(32.5, -4, 0, 1.25))))
    assert row["pet_area_s"] == pytest.approx(1.0, abs=1e-6)
    assert row["pet_status"] == "ok"
    assert row["first_user"] == "ped"
    assert row["et_ped_s"] == pytest.approx(1.84, abs=1e-6)
    assert row["et_ego_s"] == pytest.approx(0.5, abs=1e-6)
    assert row["gap_time_s"] == pytest.approx(1.0, abs=1e-6)
    assert row["min_ttc_s"] is None
    assert row["ttc_status"] == "no_collision_course"
    assert row["min_dist_m"] == pytest.approx(1.26943, abs=1e-5)
    assert row["t_min_dist_s"] == pytest.approx(5.126, abs=1e-3)
    assert row["tadv_min_s"] == pytest.approx(1.0, abs=1e-6)
    assert row["dce_m"] == pytest.approx(1.26943, abs=1e-5)
    assert row["drac_max_mps2"] == 0.0
    assert row["severity"] == "serious"
    assert row["conflict_type"] == "crossing"
    assert (row["x_conflict_m"], row["y_conflict_m"]) == pytest.approx((32.5, 0.0), abs=1e-6)
    # Both are within 45 m of (32.5, 0) from t = 0.87 s on, the ego leaves that range at 9.87 s.
    assert row["t_start_s"] == pytest.approx(0.9)
    assert row["t_end_s"] == pytest.approx(9.85)
    assert row["collision"] is False


def test_an_ego_that_passes_ahead_was_there_first(tmp_path: Path) -> None:
    # Car in the area from 3.0 to 3.5 s, disc from 4.5 s on: PET 1 s.
    row = only(analyse(tmp_path, Ego(line(0, 0, 10, 0)), Person(line(32.5, -1.15 - 4.5 * 1.25, 0, 1.25))))
    assert row["first_user"] == "ego"
    assert row["pet_area_s"] == pytest.approx(1.0, abs=1e-6)
    assert row["gap_time_s"] == pytest.approx(1.0, abs=1e-6)


def test_a_walker_who_reaches_the_side_of_the_car_is_hit_once(tmp_path: Path) -> None:
    report = analyse(tmp_path, Ego(line(0, 0, 10, 0)), Person(line(32.5, -5, 0, 1.25)))
    row = only(report)
    assert row["collision"] is True
    assert row["t_collision_s"] == pytest.approx(3.08, abs=1e-6)
    assert row["n_collisions"] == 1, "ten steps of contact are one collision"
    assert report.run["n_collisions"] == 1
    assert row["impact_side"] == "right"
    assert row["impact_speed_kmh"] == pytest.approx(36.0, abs=1e-6)
    assert row["p_fatal_rosen2009"] == pytest.approx(0.0251, abs=1e-4)
    # eta = −0.460 − 0.6179 − 0.3998 + 0.1392 at 36 km/h and a leading edge of 75 cm.
    assert row["p_mais3_mm2025"] == pytest.approx(0.2078, abs=1e-4)
    assert row["pet_area_s"] == 0.0
    assert row["min_ttc_s"] == 0.0
    assert row["severity"] == "collision"
    assert row["drac_max_mps2"] is None
    assert row["drac_status"] == "collision"
    assert row["min_dist_m"] == 0.0


def test_a_fast_car_does_not_jump_over_a_pedestrian_at_a_step_of_a_second(tmp_path: Path) -> None:
    # Samples at 0 and 1 s: the car is at 8 m and 22 m, the person stands at 15 m between both.
    ego = Ego(line(-6, 0, 14, 0))
    row = only(analyse(tmp_path, ego, Person(line(15.0, 0.0, 0, 0)), step=1.0, duration=4.0))
    assert row["collision"] is True
    # Front at 15 − 0.25 m: −6 + 14 t + 2.25 = 14.75.
    assert row["t_collision_s"] == pytest.approx(18.5 / 14, abs=1e-6)
    assert row["impact_side"] == "front"


def test_an_ego_that_sumo_turns_round_within_a_step_sweeps_nobody_from_the_road(tmp_path: Path) -> None:
    """SUMO does so with an ego handed back to it on a lane that is drawn against its way."""
    turned = {"heading_rad": lambda t: 0.0 if t < 2.0 else math.pi}
    ego = Ego(line(0, 0, 2, 0), columns=turned)
    beside = Person(line(4.0 + 0.5 * 4.5, 1.6, 0, 0))
    assert analyse(tmp_path, ego, beside, duration=4.0).run["n_collisions"] == 0


def test_contacts_further_apart_than_two_seconds_are_two_collisions(tmp_path: Path) -> None:
    def to_and_fro(t: float) -> tuple[float, float]:
        return (10.0, -1.0) if t < 2.0 or t > 6.0 else (10.0, -5.0)

    ego = Ego(lambda t: (8.0 + 0.2 * t, 0.0))
    report = analyse(tmp_path, ego, Person(to_and_fro, phase=lambda t: "crossing"))
    assert report.run["n_collisions"] >= 2


def test_a_pedestrian_who_walks_into_a_standing_car_is_no_collision(tmp_path: Path) -> None:
    row = only(analyse(tmp_path, Ego(line(32.5, 0, 0, 0)), Person(line(32.5, -5, 0, 1.25))))
    assert row["collision"] is False
    assert row["contact_standing"] is True
    assert row["impact_speed_kmh"] is None
    assert row["ego_stopped"] is True


def test_a_person_waiting_at_the_kerb_is_no_conflict(tmp_path: Path) -> None:
    # Stands still, then walks towards the road and stops short of it: a collision course never counted.
    def to_the_kerb(t: float) -> tuple[float, float]:
        return 32.5, min(-5.0 + 1.5 * t, -2.6)

    phase = crosses(1e9, 1e9, waits_from=0.0)
    row = only(analyse(tmp_path, Ego(line(-21.2, 0, 10, 0)), Person(to_the_kerb, phase=phase)))
    assert row["severity"] == "none"
    assert row["entered"] is False
    assert row["clearance_min_m"] is None
    assert row["min_dist_m"] == pytest.approx(2.6 - 0.9 - 0.25, abs=1e-6)
    assert row["ttc_status"] == "not_entered"
    assert row["pet_status"] == "no_crossing"
    assert row["first_user"] == "none"
    assert row["min_ttc_s"] is None
    assert row["yielded"] is False, "the pedestrian stood there in time for the ego to stop"


def test_a_jaywalker_counts_throughout_wherever_they_came_from(tmp_path: Path) -> None:
    # On the crossing of a side street for the first second, then across the road away from any crossing.
    person = Person(line(32.5, -4, 0, 1.25), crossing="side", phase=crosses(0.0, 1.0))
    row = only(analyse(tmp_path, Ego(line(-21.2, 0, 10, 0)), person, areas=()))
    assert not row["crossing_id"]
    assert row["clearance_min_m"] == pytest.approx(1.26943, abs=1e-5)
    assert row["tadv_min_s"] == pytest.approx(1.0, abs=1e-6)


def test_what_happens_on_another_crossing_is_no_part_of_the_encounter(tmp_path: Path) -> None:
    # They stand ahead of the ego on the crossing of a street that it never reaches, run back to the zebra
    # and cross behind the ego, which is on the zebra until 3.5 s; they enter its way at 2 + 3.85 / 1.25 s.
    def motion(t: float) -> tuple[float, float]:
        share = min(max(t - 1.0, 0.0), 1.0)
        return 60.0 - 27.5 * share, -5.0 * share + 1.25 * max(t - 2.0, 0.0)

    def crossing(t: float) -> str:
        return "side" if t < 1.5 else "zebra"

    def phase(t: float) -> str:
        return "walking" if 1.0 < t < 2.0 else "crossing"

    person = Person(motion, crossing=crossing, phase=phase)
    row = only(analyse(tmp_path, Ego(line(0, 0, 10, 0), end=5.0), person))
    assert row["crossing_id"] == "zebra"
    assert row["pet_area_s"] == pytest.approx(1.58, abs=1e-6)
    assert row["ttc_status"] == "no_collision_course", "they stood in the way elsewhere"
    assert row["min_ttc_1d_s"] is None


def test_a_passer_by_on_the_sidewalk_is_no_encounter(tmp_path: Path) -> None:
    person = Person(line(0, -4, 1.3, 0), crossing=None, phase=lambda t: "walking")
    assert analyse(tmp_path, Ego(line(0, 0, 10, 0)), person).encounters == []


def test_an_encounter_still_open_at_the_end_is_censored(tmp_path: Path) -> None:
    report = analyse(tmp_path, Ego(line(0, 0, 10, 0)), Person(line(32.5, -5, 0, 1.25)), duration=2.0)
    row = only(report)
    assert row["censored"] is True
    assert row["pet_status"] == "censored"
    # At t = 2 s both are 1.08 s from contact, if they go on.
    assert row["min_ttc_s"] == pytest.approx(1.08, abs=1e-6)


def test_a_jaywalker_away_from_crossings_is_an_encounter_in_which_the_ego_has_priority(
    tmp_path: Path,
) -> None:
    person = Person(line(32.5, -4, 0, 1.25), crossing=None, phase=lambda t: "walking")
    row = only(analyse(tmp_path, Ego(line(-21.2, 0, 10, 0)), person, areas=()))
    assert row["pet_area_s"] == pytest.approx(1.0, abs=1e-6)
    assert row["priority"] == "ego"
    assert row["crossing_id"] == ""
    assert row["passage_id"] == ""


def test_one_who_walks_ahead_of_the_ego_is_longitudinal_and_followed_by_the_gap(tmp_path: Path) -> None:
    def slows_down(t: float) -> tuple[float, float]:
        return 6.0 * min(t, 4.0) + max(t - 4.0, 0.0), 0.0

    person = Person(line(30, 0, 1.0, 0), crossing=None, phase=lambda t: "walking")
    row = only(analyse(tmp_path, Ego(slows_down), person, areas=(), duration=12.0))
    assert row["conflict_type"] == "longitudinal"
    # At 3.9 s, the last instant at 6 m/s: front at 25.65 m, disc from 33.65 m on, 5 m/s closer.
    assert row["min_ttc_s"] == pytest.approx(1.6, abs=1e-6)
    assert row["min_ttc_1d_s"] == pytest.approx(1.6, abs=1e-6)
    assert row["drac_max_mps2"] == pytest.approx(5.0**2 / (2 * 8.0), abs=1e-6)


def test_an_ego_that_turns_before_the_area_is_turning(tmp_path: Path) -> None:
    def bend(t: float) -> tuple[float, float]:
        import math

        angle = min(0.5 * t, math.pi / 2)
        straight = max(t - math.pi, 0.0) * 5.0
        return 10.0 * math.sin(angle), 10.0 * (1 - math.cos(angle)) + straight

    person = Person(line(4, 18, 1.2, 0))
    row = only(analyse(tmp_path, Ego(bend), person, areas=(), duration=8.0))
    assert row["conflict_type"] == "turning"
    assert row["ego_max_lat_accel_mps2"] == pytest.approx(2.5, rel=0.02)


def test_evasive_action_begins_with_the_step_that_brakes(tmp_path: Path) -> None:
    # 10 m/s until 3 s; what SUMO has for a step is written at its end, here first at 3.5 s with 8.75 m/s.
    ego = Ego(
        lambda t: (10.0 * t - 1.25 * max(t - 3.0, 0.0) ** 2 - 27.0, 0.0),
        columns={"acceleration_mps2": lambda t: -2.5 if t > 3.0 else 0.0},
    )
    walk = Person(line(32.5, -6.0, 0, 1.25), phase=crosses(0.8, 8.8, waits_from=0.0))
    row = only(analyse(tmp_path, ego, walk, step=0.5, duration=6.5))
    assert (row["evasive_status"], row["evasive_t_s"]) == ("braked", 3.0)
    assert row["conflicting_speed_mps"] == pytest.approx(10.0, abs=1e-3)


@pytest.mark.parametrize(("ego_ends", "ped_ends"), [(3.2, 1e9), (1e9, 4.0)])
def test_who_were_never_in_the_area_together_are_censored_and_not_interleaved(
    tmp_path: Path, ego_ends: float, ped_ends: float
) -> None:
    """The recording of the first ends inside it, long before the second enters."""
    ego = Ego(line(0, 0, 10, 0) if ego_ends < 10.0 else line(-40, 0, 10, 0), end=ego_ends)
    person = Person(line(32.5, -8.0 if ego_ends < 10.0 else -5.0, 0, 1.25), end=ped_ends)
    row = only(analyse(tmp_path, ego, person, duration=12.0))
    assert (row["pet_area_s"], row["pet_status"]) == (None, "censored")


def test_while_nothing_was_recorded_nobody_moved_through_the_area(tmp_path: Path) -> None:
    """No ego was there from 3.6 to 5.6 s; a pedestrian who waited before is beyond the road afterwards."""
    phase = crosses(5.0, 1e9, waits_from=0.0)
    seen = [
        Person(line(32.5, -4.0, 0, 0), phase=phase, end=3.6),
        Person(line(32.5, 4.0, 0, 0), phase=phase, start=5.6),
    ]
    egos = [
        Ego(line(0, 0, 10, 0), name="first", end=3.6),
        Ego(line(-120, 0, 10, 0), name="second", start=5.6),
    ]
    report = analyse_run(write_run(tmp_path, egos, seen, duration=20.0))
    assert [row["pet_area_s"] for row in report.encounters] == [None, None]
    assert report.run["n_pet_defined"] == 0


def test_one_who_steps_out_late_could_not_have_been_spared(tmp_path: Path) -> None:
    # The pedestrian stands 0.85 m beside the ego's path until 2.4 s and is struck at 3.08 s, too soon to react.
    def steps_out(t: float) -> tuple[float, float]:
        return 32.5, -2.0 + 1.25 * max(t - 2.4, 0.0)

    person = Person(steps_out, phase=crosses(2.4, 9.0))
    row = only(analyse(tmp_path, Ego(line(0, 0, 10, 0)), person))
    assert row["collision"] is True
    assert row["preventable_r157"] == 0.0
    assert row["late_entry"] == 1.0


def test_thresholds_move_the_severity_without_another_simulation(tmp_path: Path) -> None:
    write_run(tmp_path, [Ego(line(-21.2, 0, 10, 0))], [Person(line(32.5, -4, 0, 1.25))])
    assert analyse_run(tmp_path).encounters[0]["severity"] == "serious"
    lenient = Thresholds(severity_pet_serious_s=0.9, severity_pet_severe_s=0.5)
    assert analyse_run(tmp_path, lenient).encounters[0]["severity"] == "slight"


@pytest.mark.parametrize("step", [0.05, 0.1, 0.25, 1.0])
def test_any_step_length_gives_nearly_the_same_numbers(tmp_path: Path, step: float) -> None:
    def brakes(t: float) -> tuple[float, float]:
        return -21.2 + 10.0 * t - 0.4 * t * t, 0.0

    row = only(analyse(tmp_path, Ego(brakes), Person(line(32.5, -4, 0, 1.25)), step=step, duration=12.0))
    # The front reaches 32.25 m where −21.2 + 10 t − 0.4 t² = 30, the disc has left at 4.12 s.
    arrival = (10.0 - (100.0 - 1.6 * 51.2) ** 0.5) / 0.8
    assert row["pet_area_s"] == pytest.approx(arrival - 4.12, abs=0.002)


def test_each_person_and_ego_meet_apart(tmp_path: Path) -> None:
    egos = [Ego(line(-21.2, 0, 10, 0), name="one"), Ego(line(0, 3.2, 10, 0), name="two")]
    persons = [Person(line(32.5, -4, 0, 1.25), name=name) for name in ("a", "b")]
    write_run(tmp_path, egos, persons)
    report = analyse_run(tmp_path)
    assert sorted((row["ego_id"], row["ped_id"]) for row in report.encounters) == [
        ("one", "a"),
        ("one", "b"),
        ("two", "a"),
        ("two", "b"),
    ]
    assert report.run["n_passages"] == 2
    assert report.run["ped_count"] == 2


def moved(motion: Motion, turn: float, dx: float, dy: float) -> Motion:
    """Return the motion turned about the origin and shifted."""
    from math import cos, sin

    def there(t: float) -> tuple[float, float]:
        x, y = motion(t)
        return cos(turn) * x - sin(turn) * y + dx, sin(turn) * x + cos(turn) * y + dy

    return there


def test_a_turned_and_shifted_world_gives_the_same_report(tmp_path: Path) -> None:
    ego, person = line(-21.2, 0, 10, 0), line(32.5, -4, 0.1, 1.25)
    rows = [
        only(
            analyse(
                tmp_path / str(turn),
                Ego(moved(ego, turn, 5 * turn, -90 * turn)),
                Person(moved(person, turn, 5 * turn, -90 * turn)),
                areas=(),
            )
        )
        for turn in (0.0, 2.2)
    ]
    for name, value in rows[0].items():
        if isinstance(value, float) and not name.startswith(("x_", "y_")):
            assert rows[1][name] == pytest.approx(value, abs=1e-5), name
