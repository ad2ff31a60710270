"""The table of the methods in traffic, on runs that can be checked by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.errors import StudyError
from analysis.recording.reading import read_run
from analysis.study.design import read_study
from studies.methods.page import write_page
from studies.methods.rows import people_at_once, rows
from tests.analysis.recorded import Ego, Person, line, write_run
from tests.analysis.study.study_folders import write_study_run


def _study(folder: Path) -> Path:
    few, many = {"pedestrians_per_hour": 100.0}, {"pedestrians_per_hour": 700.0}
    met, touched = {"min_ttc_s": 2.0}, {"min_ttc_s": 0.5, "collision": True, "n_collisions": 1}
    numbers = {"ego_delay_mean_s": 10.0, "p95_abs_jerk_mps3": 2.0, "compute_p95_ms": 4.0, "n_solver_fail": 1}
    longer = {**numbers, "ego_count": 3, "ego_delay_mean_s": 20.0, "p95_abs_jerk_mps3": 4.0}
    write_study_run(folder / "a1", "aeb", 1, setting=few, numbers=numbers, encounters=[met, touched])
    write_study_run(folder / "a2", "aeb", 2, setting=few, numbers=longer, encounters=[met, met])
    write_study_run(folder / "s1", "sumo", 1, setting=few, encounters=[{**met, "entered": False}])
    write_study_run(folder / "s2", "sumo", 2, setting=few, invalid="teleported", encounters=[touched])
    write_study_run(folder / "m1", "sumo", 1, setting=many, encounters=[met] * 5)
    return folder


def test_runs_of_one_method_and_demand_make_one_row(tmp_path: Path) -> None:
    folder = _study(tmp_path)
    study = read_study(sorted(folder.iterdir()))
    few, many = study.conditions
    aeb, sumo = rows(study, few)
    assert (aeb.method, aeb.runs, aeb.valid) == ("aeb", 2, 2)
    assert (aeb.encounters, aeb.contacts, aeb.short_ttc) == (4, 1, 1)
    # Clopper and Pearson for 1 of 4.
    assert aeb.contact_share is not None
    assert (aeb.contact_share.low, aeb.contact_share.high) == pytest.approx((0.0063, 0.8059), abs=5e-5)
    assert aeb.least_ttc == 0.5
    assert aeb.delay == pytest.approx((1 * 10.0 + 3 * 20.0) / 4)
    assert aeb.jerk == 3.0
    assert (aeb.unsolved, aeb.control_ms) == (2, 4.0)
    # Whoever neither enters nor is touched is not met, and an invalid run is counted but not used.
    assert (sumo.runs, sumo.valid, sumo.encounters, sumo.contacts) == (2, 1, 0, 0)
    assert sumo.contact_share is None
    assert [row.method for row in rows(study, many)] == ["sumo"]


def test_people_are_counted_near_an_ego_that_is_near_a_crossing(tmp_path: Path) -> None:
    # The crossing is at x = 32.5; the front is within 45 m of it from t = 1.075 s on.
    ego = Ego(line(-25.5, 0.0, 10.0, 0.0))
    beside = Person(line(-25.5, 3.0, 10.0, 0.0), "beside")
    at_the_crossing = Person(line(32.5, 0.0, 0.0, 0.0), "standing")
    leaves = Person(line(32.5, 2.0, 0.0, 0.0), "leaves", end=4.5)
    folder = write_run(tmp_path / "run", [ego], [beside, at_the_crossing, leaves])
    # The standing person is within 45 m from 1.075 s on as well: 3 people at 2, 3 and 4 s, then 2.
    assert people_at_once(read_run(folder)) == pytest.approx((3 * 3 + 6 * 2) / 9)
    far = write_run(tmp_path / "far", [Ego(line(200.0, 0.0, 10.0, 0.0))], [beside])
    assert people_at_once(read_run(far)) is None


def test_the_tables_replace_those_of_before_and_leave_the_text_above(tmp_path: Path) -> None:
    study, page = _study(tmp_path / "study"), tmp_path / "page.md"
    write_page(study, page)
    first = page.read_text()
    assert first.startswith("# The methods of the papers in traffic\n")
    assert "| aeb | 2 of 2 |  | 4 | **1** | 25.0% (0.6% … 80.6%) | 0.50 | 1 | 17.5 | 3.0 | 2 | 4.0 |" in first
    page.write_text(
        first.replace("\n## Tables", "\nWhat we read in it.\n\n## Tables").replace("80.6", "99.9")
    )
    write_page(study, page)
    assert page.read_text() == first.replace("\n## Tables", "\nWhat we read in it.\n\n## Tables")
    with pytest.raises(StudyError, match="no runs"):
        write_page(tmp_path / "nothing", page)
