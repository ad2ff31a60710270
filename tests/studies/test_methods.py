"""The table of the methods in traffic, on runs that can be checked by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.errors import StudyError
from analysis.recording.reading import read_run
from analysis.study.design import read_study
from cosim.batches.study import study_of
from studies.methods.__main__ import FILES, batches, studies
from studies.methods.answer import front, sentences
from studies.methods.page import write_page
from studies.methods.rows import Row, people_at_once, pooled, rows
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
    row = "| aeb | 2 of 2 |  | 4 | **1** | 0 | 25.0% (0.6% … 80.6%) | 0.50 | 1 | 17.5 | 3.0 |"
    assert row in first
    assert (
        "1. **How much was run.** 5 runs: 2 conditions, 2 seeds; the smallest cell has 0 encounters" in first
    )
    assert (page.parent / "study-papers.png").exists()
    told = "\nWhat we read in it.\n\n## What was found"
    page.write_text(first.replace("\n## What was found", told).replace("80.6", "99.9"))
    write_page(study, page)
    assert page.read_text() == first.replace(
        "\n## What was found", "\nWhat we read in it.\n\n## What was found"
    )
    with pytest.raises(StudyError, match="no runs"):
        write_page(tmp_path / "nothing", page)


def test_the_front_is_what_nothing_beats_in_both_and_references_are_not_on_it() -> None:
    def row(preventable: int, delay: float) -> Row:
        return Row("", 1, 1, None, 100, preventable, None, None, 0, delay, None, 0, None, preventable)

    found = front({"a": row(0, 10.0), "b": row(2, 5.0), "c": row(2, 6.0), "sumo": row(0, 1.0)})
    assert found == ["a", "b"]


def test_what_the_sentences_say_follows_from_the_rows(tmp_path: Path) -> None:
    """0 of 1,000 has an upper bound of 0.30 per 100, one-sided (Clopper and Pearson)."""
    met = {"min_ttc_s": 2.0}
    for seed in (1, 2, 3):
        for label, delay in (("vo_mpc", 10.0 + seed), ("aeb", 5.0 + 1.1 * seed)):
            numbers = {"ego_delay_mean_s": delay, "n_plans_near_ped": 10, "method_applies_share": 0.5}
            acts = {"method_acts_where_applies_share": 0.4 if label == "aeb" else 1.0}
            folder = tmp_path / f"{label}{seed}"
            write_study_run(folder, label, seed, numbers={**numbers, **acts}, encounters=[met] * 2)
    study = read_study(sorted(tmp_path.iterdir()))
    rows_of = {label: pooled(study, label) for label in study.all_labels()}
    size, contacts, _, fronts, acting = sentences(study, rows_of, 6)
    assert "6 runs" in size
    assert "fewer than the 150" in size
    assert contacts == "**Contacts.** No method touched anybody."
    assert "Beaten by no other method in both: `aeb`; `vo_mpc` is not among them" in fronts
    assert "`aeb` -4.8 s" in fronts
    assert "at least 40 % of the plans (`aeb`); below 50 %: aeb" in acting
    sure = Row("", 1, 1, None, 1000, 0, None, None, 0, 1.0, None, 0, None)
    told = sentences(study, {"vo_mpc": sure}, 6)[2]
    assert "0.30 per 100, so that it is shown" in told
    assert "from 598 encounters on" in told
    for count, shown in ((597, "not shown"), (598, "is shown")):
        row = Row("", 1, 1, None, count, 0, None, None, 0, 1.0, None, 0, None)
        assert shown in sentences(study, {"vo_mpc": row}, 6)[2]


def test_of_a_study_that_was_stopped_only_what_everybody_drove_is_pooled(tmp_path: Path) -> None:
    met, few, many = {"min_ttc_s": 2.0}, {"pedestrians_per_hour": 100.0}, {"pedestrians_per_hour": 700.0}
    for label in ("aeb", "sumo"):
        write_study_run(tmp_path / f"{label}1", label, 1, setting=few, encounters=[met])
    write_study_run(tmp_path / "aeb2", "aeb", 2, setting=few, encounters=[met] * 10)
    write_study_run(tmp_path / "aeb3", "aeb", 1, setting=many, encounters=[met] * 100)
    study = read_study(sorted(tmp_path.iterdir()))
    assert [pooled(study, label).encounters for label in ("aeb", "sumo")] == [1, 1]


def test_all_studies_are_run_with_one_seed_before_the_next(tmp_path: Path) -> None:
    content = {"scenarios": ["a"], "controllers": ["aeb"], "seeds": "1-2"}
    tables = {
        "first": study_of(content, "first"),
        "second": study_of({**content, "seeds": "2-3"}, "second"),
    }
    found = [
        (folder.relative_to(tmp_path).as_posix(), table.seeds) for folder, table in batches(tmp_path, tables)
    ]
    assert found == [
        ("seed_1/first", [1]),
        ("seed_2/first", [2]),
        ("seed_2/second", [2]),
        ("seed_3/second", [3]),
    ]


def test_busy_is_the_middle_level_of_every_study_file() -> None:
    files = [file for file in FILES if file.suffix == ".toml"]
    assert len(files) == 6
    for table in studies(Path(), files, busy=True, seeds="7").values():
        assert [len(values) for values in table.vary.values()] == [1]
        assert table.seeds == "7"


@pytest.mark.sumo
def test_the_network_that_nobody_tuned_for_is_the_same_at_every_level(tmp_path: Path) -> None:
    made = studies(tmp_path, [Path("untuned_network")], busy=False, seeds=None)
    towns = [Path(table.scenarios[0]).parent for table in made.values()]
    networks = {(town / "town.net.xml").read_bytes() for town in towns}
    people = [(town / "people.rou.xml").read_text().count("<person ") for town in towns]
    assert list(made) == ["untuned_network_light", "untuned_network_busy", "untuned_network_crowded"]
    assert len(networks) == 1
    assert people == sorted(set(people))
    assert all(len(table.controllers) == 15 and table.seeds == "9301-9305" for table in made.values())
