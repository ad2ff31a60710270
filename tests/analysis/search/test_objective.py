"""The margin of a run: its sign is that of the check, and it has a slope."""

from __future__ import annotations

from typing import Any

import pytest

from analysis.criteria.criterion import Criterion, judge, row_value
from analysis.criteria.reading import read_criteria
from analysis.search.objective import judge_run, searchable
from tests.analysis.rows_of_runs import encounter, run

NO_CONTACT = Criterion(
    "no preventable contact", "encounter", "collision", "==", 0.0, where={"preventable_r157": 1}
)


def contact(**cells: Any) -> dict[str, str]:
    return encounter(collision=1, preventable_r157=1, impact_speed_kmh=30.0, **cells)


def margin(*encounters: dict[str, str]) -> float:
    found = judge_run([NO_CONTACT], encounters, [run()]).margin
    assert found is not None
    return found


def test_a_contact_is_the_worse_the_faster_it_is() -> None:
    # 30 km/h is three times the scale of 10 km/h: -3 / (1 + 3).
    assert margin(contact()) == pytest.approx(-0.75)
    slow = encounter(collision=1, preventable_r157=1, impact_speed_kmh=10.0)
    assert margin(slow) == pytest.approx(-0.5)
    touched = encounter(collision=1, preventable_r157=1, impact_speed_kmh=0.0)
    assert margin(touched) == -0.01


def test_a_near_miss_is_the_nearer_to_0_the_nearer_it_was() -> None:
    # 1 m is half of the scale of 2 m: 0.5 / 1.5.
    assert margin(encounter(clearance_min_m=1.0)) == pytest.approx(1.0 / 3.0)
    assert margin(encounter(clearance_min_m=0.1)) < margin(encounter(clearance_min_m=0.2))
    assert margin(encounter(clearance_min_m=5.0, min_ttc_s=0.5)) == pytest.approx(0.25)
    assert margin(encounter()) == 1.0


def test_the_worst_encounter_counts() -> None:
    verdict = judge_run([NO_CONTACT], [encounter(clearance_min_m=1.0), contact(ped_id="met")], [run()])
    assert verdict.failed
    assert verdict.facts["ped_id"] == "met"
    assert verdict.criterion == "no preventable contact"


def test_what_nobody_could_have_prevented_is_no_failure_and_leads_away() -> None:
    def late(seen: float) -> dict[str, str]:
        cells = {"max_speed_mps": 15.18, "contact_risk_seen_s": seen}
        return encounter(collision=1, preventable_r157=0, impact_speed_kmh=50.0, **cells)

    # The careful driver needs 0.75 s, half of 0.6 s, and 15.18 / (2 · 7.59) = 1 s: 2.05 s.
    assert margin(late(1.05)) == pytest.approx(0.5)
    assert margin(late(0.05)) > margin(late(1.05))
    assert margin(late(3.0)) == 0.01
    assert judge_run([NO_CONTACT], [late(1.0)], [run()]).unpreventable


def test_an_undefined_preventability_counts_as_preventable() -> None:
    assert margin(encounter(collision=1, preventable_r157="", impact_speed_kmh=30.0)) == pytest.approx(-0.75)


BUMPED = contact(contact_place="carriageway", contact_moved_by="pedestrian", contact_class="ego")


@pytest.mark.parametrize(
    ("metric", "fails"),
    [
        ("n_collisions", True),
        ("n_collisions_preventable", True),
        ("n_collisions_crossing", False),
        ("n_collisions_carriageway", True),
        ("n_collisions_moved_by_ego", False),
        ("n_collisions_moved_by_both", False),
        ("n_collisions_moved_by_pedestrian", True),
        ("n_collisions_class_ego", True),
        ("n_collisions_class_appeared", False),
    ],
)
def test_a_contact_fails_the_criteria_that_count_it(metric: str, fails: bool) -> None:
    criterion = Criterion("none", "run", metric, "==", 0.0)
    row = run(**{metric: int(fails)})
    assert judge(criterion, row_value(criterion, row)).status == ("fail" if fails else "pass")
    verdict = judge_run([criterion], [BUMPED], [row])
    assert verdict.failed == fails
    assert verdict.judged


def test_a_contact_fails_no_criterion_that_does_not_choose_its_encounter() -> None:
    def none(place: str) -> Criterion:
        return Criterion("none", "encounter", "collision", "==", 0.0, where={"contact_place": place})

    assert judge_run([none("crossing")], [BUMPED], [run()]).margin is None
    assert judge_run([none("carriageway")], [BUMPED], [run()]).failed
    # Somebody whom it might have touched there gives the search a slope.
    near = encounter(clearance_min_m=1.0)
    assert judge_run([none("crossing")], [BUMPED, near], [run()]).margin == pytest.approx(1.0 / 3.0)


def test_a_later_contact_of_an_encounter_counts_though_only_the_first_ones_kind_is_told() -> None:
    criterion = Criterion("none", "run", "n_collisions_crossing", "==", 0.0)
    assert judge_run([criterion], [BUMPED], [run(n_collisions_crossing=1)]).failed


def test_a_number_has_its_distance_to_the_threshold() -> None:
    braking = Criterion("braking", "run", "max_decel_mps2", "<=", 9.0, unit="m/s^2")
    for deceleration, expected in ((6.0, 0.5), (9.0, 0.0), (12.0, -0.5)):
        assert judge_run([braking], [], [run(max_decel_mps2=deceleration)]).margin == pytest.approx(expected)
    # However little it is violated, it is negative.
    assert judge_run([braking], [], [run(max_decel_mps2=9.0001)]).margin == -0.01


def test_a_count_without_a_slope_is_far_from_its_threshold_while_it_is_met() -> None:
    stuck = Criterion("no deadlock", "run", "deadlock", "==", 0.0)
    assert judge_run([stuck], [], [run(deadlock=0)]).margin == 1.0
    assert judge_run([stuck], [], [run(deadlock=1)]).margin == pytest.approx(-0.5)


def test_a_metric_is_found_by_its_name_whoever_wrote_it() -> None:
    read = "".join(["dead", "lock"])  # equal to the declared name, but no literal, as one from a file
    assert judge_run([Criterion("no deadlock", "run", read, "==", 0.0)], [], [run(deadlock=0)]).margin == 1.0


def test_an_encounter_that_nobody_could_have_kept_within_a_limit_is_listed_apart() -> None:
    near = Criterion("distance", "encounter", "min_ttc_s", ">=", 1.5, unit="s")
    verdict = judge_run([near], [encounter(min_ttc_s=0.5, preventable_r157=0)], [run()])
    assert verdict.unpreventable
    assert not verdict.failed
    assert judge_run([near], [encounter(min_ttc_s=0.5, preventable_r157=1)], [run()]).failed


def test_nothing_to_judge_has_no_margin() -> None:
    near = Criterion("distance", "encounter", "min_ttc_s", ">=", 1.5, unit="s")
    assert judge_run([near], [encounter()], [run()]).margin is None


def test_a_statistic_of_many_runs_is_not_searched() -> None:
    tables = [
        {
            "scope": "configuration",
            "metric": "min_dist_m",
            "kind": "encounter",
            "statistic": "min",
            "operator": ">=",
            "threshold": 1.0,
        },
        {"scope": "run", "metric": "deadlock", "operator": "==", "threshold": 0},
    ]
    assert [one.metric for one in searchable(read_criteria(tables))] == ["deadlock"]
