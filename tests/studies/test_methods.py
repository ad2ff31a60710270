"""The table of the methods in traffic, on runs that can be checked by hand."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analysis.errors import StudyError
from analysis.files import write_json
from analysis.recording.reading import read_run
from analysis.study.design import study_of_runs
from cosim.batches.study import study_of
from studies.methods.__main__ import FILES, LEVELS, batches, studies, write_plan
from studies.methods.against import against, needed, power, upper_bound
from studies.methods.answer import front, sentences
from studies.methods.page import write_page
from studies.methods.people import people_at_once
from studies.methods.rows import Row, balanced, pooled, rows
from studies.methods.table import driven, read_table
from tests.analysis.recorded import Ego, Person, line, write_run
from tests.analysis.study.study_folders import write_study_run


def _study(folder: Path) -> Path:
    few, many = {"pedestrians_per_hour": 100.0}, {"pedestrians_per_hour": 700.0}
    met, touched = {"min_ttc_s": 2.0}, {"min_ttc_s": 0.5, "collision": True, "n_collisions": 1}
    # Touched twice in one encounter, which counts once.
    touched |= {"preventable_r157": True, "n_collisions": 2}
    numbers = {"ego_delay_mean_s": 10.0, "p95_abs_jerk_mps3": 2.0, "compute_p95_ms": 4.0}
    numbers |= {"n_solver_fail": 1, "n_plans": 10, "n_collisions_preventable": 2}
    longer = {**numbers, "ego_count": 3, "ego_delay_mean_s": 20.0, "p95_abs_jerk_mps3": 4.0}
    write_study_run(folder / "a1", "aeb", 1, setting=few, numbers=numbers, encounters=[met, touched])
    write_study_run(folder / "a2", "aeb", 2, setting=few, numbers=longer, encounters=[met, met])
    write_study_run(folder / "s1", "sumo", 1, setting=few, encounters=[{**met, "entered": False}])
    write_study_run(folder / "s2", "sumo", 2, setting=few, invalid="teleported", encounters=[touched])
    write_study_run(folder / "m1", "sumo", 1, setting=many, encounters=[met] * 5)
    return folder


def test_runs_of_one_method_and_demand_make_one_row(tmp_path: Path) -> None:
    folder = _study(tmp_path)
    study = study_of_runs(driven(folder))
    few, many = study.conditions
    aeb, sumo = rows(study, few)
    assert (aeb.method, aeb.runs, aeb.valid) == ("aeb", 2, 2)
    assert (aeb.encounters, aeb.contacts, aeb.preventable, aeb.short_ttc) == (4, 1, 1, 1)
    # Clopper and Pearson for 1 of 4.
    assert aeb.contact_share is not None
    assert (aeb.contact_share.low, aeb.contact_share.high) == pytest.approx((0.0063, 0.8059), abs=5e-5)
    assert aeb.least_ttc == 0.5
    assert aeb.delay == pytest.approx((1 * 10.0 + 3 * 20.0) / 4)
    assert aeb.jerk == 3.0
    assert (aeb.solved, aeb.control_ms) == (0.9, 4.0)
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


def test_the_page_says_the_answer_first_and_what_it_rests_on(tmp_path: Path) -> None:
    study, page = _study(tmp_path / "study"), tmp_path / "page.md"
    planned = {"seed_1/busy/one": 3, "seed_2/busy/one": 3, "seed_1/busy/rules_as_printed": 1}
    write_json(study / "plan.json", {"runs": planned})
    write_page(study, page)
    first = page.read_text()
    headings = [line for line in first.splitlines() if line.startswith("#")]
    assert headings[:3] == ["# The methods of the papers in traffic", "## The answer", "## What it rests on"]
    # The run with many pedestrians was driven by one method alone, and is not counted.
    size = (
        "1. **How much was run.** 4 runs of the 6 of the whole study: 1 condition, 2 seeds; the smallest cell"
    )
    assert size in first
    assert "This page counts 4 runs of the 6 of the whole study (seeds" in first
    row = "| aeb | 2 of 2 |  | 4 | **1** | 1 | 25.0% (0.6% … 80.6%) | 0.50 | 1 | 17.5 | 3.0 |"
    assert row in first
    assert (page.parent / "study-papers.png").exists()
    write_page(study, page)
    assert page.read_text() == first
    with pytest.raises(StudyError, match="no runs"):
        write_page(tmp_path / "nothing", page)


@pytest.mark.long
def test_a_page_counts_what_was_driven_elsewhere_under_the_same_conditions(tmp_path: Path) -> None:
    met, few = {"min_ttc_s": 2.0}, {"pedestrians_per_hour": 100.0}
    page, here, there = tmp_path / "page.md", tmp_path / "here", tmp_path / "there"
    for folder, seed, encounters in ((there, 1, 3), (here, 2, 5)):
        for label in ("aeb", "sumo"):
            place = folder / f"seed_{seed}" / "busy" / label
            write_study_run(place, label, seed, setting=few, encounters=[met] * encounters)
        write_page(folder, page)
    table = read_table(page.with_suffix(".csv"))
    assert [(run.folder.as_posix(), run.seed) for run in table] == [
        (f"seed_{seed}/busy/{label}", seed) for seed in (1, 2) for label in ("aeb", "sumo")
    ]
    assert "4 runs: 1 condition, 2 seeds; the smallest cell has 8 encounters" in page.read_text()
    # What is driven again replaces its row; what was driven under other conditions goes.
    write_study_run(here / "seed_2/busy/aeb", "aeb", 2, setting=few, encounters=[met])
    write_page(here, page)
    assert [run.numbers["met"] for run in read_table(page.with_suffix(".csv"))] == [3, 3, 1, 5]
    write_study_run(tmp_path / "other", "aeb", 2, setting={"pedestrians_per_hour": 7.0}, encounters=[met])
    write_page(tmp_path / "other", page)
    assert [run.numbers["met"] for run in read_table(page.with_suffix(".csv"))] == [1]
    page.with_suffix(".csv").write_text("a,b\n1,2\n")
    with pytest.raises(StudyError, match="not a table of runs"):
        write_page(here, page)


def test_a_variant_of_one_method_has_a_table_of_its_own(tmp_path: Path) -> None:
    met, zebra = {"min_ttc_s": 2.0}, tmp_path / "seed_1" / "busy" / "midblock_zebra"
    for label in ("aeb", "vo_paper"):
        write_study_run(zebra / label, label, 1, encounters=[met])
    printed = tmp_path / "seed_1" / "busy" / "rules_as_printed" / "printed"
    write_study_run(printed, "vo_paper", 1, parameters={"rules": "printed"}, encounters=[met] * 3)
    write_page(tmp_path, tmp_path / "page.md")
    whole, aside = (tmp_path / "page.md").read_text().split("## The rules as printed, beside ours")
    assert "2 runs: 1 condition, 1 seed" in whole
    assert "### road, busy\n" in whole
    assert "rules=printed" not in whole
    assert "rules=printed" in aside


def test_non_inferiority_is_shown_from_a_size_on_and_not_by_a_worse_method() -> None:
    """Newcombe (1998), method 10: for 56/70 and 48/80, 95 % two-sided, from 0.0524 to 0.3339."""
    bound = upper_bound(np.array([56.0]), np.array([48.0]), 70, 80, level=0.025)
    assert float(bound[0]) == pytest.approx(0.3339, abs=5e-5)
    assert power(538, 0.0) == 0.0
    assert power(539, 0.0) == 1.0
    assert power(2000, 0.001) < power(4000, 0.001)
    enough = needed(0.001)
    assert power(enough - 100, 0.001) < 0.8
    assert all(power(n, 0.001) >= 0.8 for n in range(enough, enough + 2000, 100)), "a saw, and 900 a tooth"
    assert power(50_000, 0.001) == pytest.approx(1.0), "50 contacts are to be expected"


def test_every_other_method_is_compared_with_ours_in_pairs(tmp_path: Path) -> None:
    for seed in (1, 2, 3):
        for label, delay in (("vo_mpc", 10.0 + seed), ("aeb", 5.0 + 1.1 * seed)):
            numbers, struck = {"ego_delay_mean_s": delay}, label == "aeb"
            met = {"min_ttc_s": 2.0}
            touched = {**met, "collision": struck, "preventable_r157": struck}
            folder = tmp_path / f"{label}{seed}"
            write_study_run(folder, label, seed, numbers=numbers, encounters=[met, touched])
    study = study_of_runs(driven(tmp_path))
    (aeb,) = against(study, {label: pooled(study, label) for label in study.all_labels()})
    assert (aeb.method, aeb.delay.pairs) == ("aeb", 3)
    assert aeb.delay.difference == pytest.approx(-4.8)
    assert aeb.excess == pytest.approx(-50.0)
    assert aeb.bound is not None
    assert aeb.bound > -50.0


def test_the_front_is_what_nothing_beats_in_both_and_references_are_not_on_it() -> None:
    def row(preventable: int, delay: float) -> Row:
        return Row("", 1, 1, None, 100, preventable, None, None, 0, delay, None, None, preventable)

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
    study = study_of_runs(driven(tmp_path))
    rows_of = {label: pooled(study, label) for label in study.all_labels()}
    size, contacts, _, fronts, acting = sentences(study, rows_of, 6, against(study, rows_of), 60)
    assert "6 runs of the 60 of the whole study" in size
    assert "fewer than the 150" in size
    assert contacts == "**Contacts.** No method touched anybody."
    assert "and less delay than `aeb`; `vo_mpc` is not among them" in fronts
    assert "(`sumo` and `septic_lane_change` are references)" in fronts
    assert "`aeb` -4.8 s" in fronts
    assert "at least 40 % of the plans (`aeb`); below 50 %: aeb" in acting
    for count, shown in (
        (400, "`vo_mpc` is not shown to have less than 0.5 per 100 more than `aeb` (+0.67): upper bound"),
        (1200, "is shown to have less than 0.5 per 100 more than every other method"),
    ):
        sure = {label: replace(row, encounters=count) for label, row in rows_of.items()}
        assert shown in sentences(study, sure, 6, against(study, sure))[2]


def test_of_a_study_that_was_stopped_only_what_everybody_drove_is_counted(tmp_path: Path) -> None:
    met, few, many = {"min_ttc_s": 2.0}, {"pedestrians_per_hour": 100.0}, {"pedestrians_per_hour": 700.0}
    for label in ("aeb", "sumo"):
        write_study_run(tmp_path / f"{label}1", label, 1, setting=few, encounters=[met])
    write_study_run(tmp_path / "aeb2", "aeb", 2, setting=few, encounters=[met] * 10)
    write_study_run(tmp_path / "aeb3", "aeb", 1, setting=many, encounters=[met] * 100)
    study = balanced(study_of_runs(driven(tmp_path)))
    assert [pooled(study, label).encounters for label in ("aeb", "sumo")] == [1, 1]


def test_the_answer_says_where_further_seeds_were_driven_beyond_the_whole_study(tmp_path: Path) -> None:
    met, few, many = {"min_ttc_s": 2.0}, {"pedestrians_per_hour": 100.0}, {"pedestrians_per_hour": 700.0}
    for seed, setting in ((1, few), (1, many), (2, many)):
        for label in ("aeb", "vo_mpc"):
            folder = tmp_path / f"{label}{seed}{setting['pedestrians_per_hour']:.0f}"
            write_study_run(folder, label, seed, setting=setting, encounters=[met] * 200)
    study = balanced(study_of_runs(driven(tmp_path)))
    rows_of = {label: pooled(study, label) for label in study.all_labels()}
    (size, *_) = sentences(study, rows_of, 200, against(study, rows_of), 4)
    assert "The 4 runs of the whole study and 2 with further seeds: 2 conditions, 1 to 2 seeds each" in size


def test_a_seed_is_finished_before_the_next_and_a_level_in_it(tmp_path: Path) -> None:
    content = {"scenarios": ["a"], "controllers": ["aeb"], "seeds": "1-2"}
    tables = {
        ("busy", "first"): study_of(content, "first"),
        ("busy", "second"): study_of({**content, "seeds": "2-3"}, "second"),
        ("light", "first"): study_of(content, "first"),
    }
    found = [
        (folder.relative_to(tmp_path).as_posix(), table.seeds) for folder, table in batches(tmp_path, tables)
    ]
    assert found == [
        ("seed_1/busy/first", [1]),
        ("seed_1/light/first", [1]),
        ("seed_2/busy/first", [2]),
        ("seed_2/busy/second", [2]),
        ("seed_2/light/first", [2]),
        ("seed_3/busy/second", [3]),
    ]


def test_the_levels_of_every_study_file_are_run_one_after_the_other(tmp_path: Path) -> None:
    files = [file for file in FILES if file.suffix == ".toml"]
    found = studies(Path(), files, LEVELS, seeds="7")
    assert [level for level, _ in found] == ["busy"] * 6 + ["light"] * 6 + ["crowded"] * 6
    assert all(table.seeds == "7" for table in found.values())
    for name in {name for _, name in found}:
        demand = [found[level, name].vary["pedestrians_per_hour"] for level in LEVELS]
        assert demand == sorted(demand)
        assert all(len(values) == 1 for level in LEVELS for values in found[level, name].vary.values())
    write_plan(tmp_path, found)
    # A part that is run again leaves the plan whole.
    write_plan(tmp_path, studies(Path(), files[:1], ["busy"], seeds="7"))
    assert sum(json.loads((tmp_path / "plan.json").read_text())["runs"].values()) == 3 * (5 * 15 + 1)


@pytest.mark.slow
@pytest.mark.sumo
def test_the_network_that_nobody_tuned_for_is_the_same_at_every_level(tmp_path: Path) -> None:
    made = studies(tmp_path, [Path("untuned_network")], LEVELS, seeds=None)
    towns = [Path(table.scenarios[0]).parent for table in made.values()]
    networks = {(town / "town.net.xml").read_bytes() for town in towns}
    people = [
        (town / "people.rou.xml").read_text().count("<person ") / float(str(table.settings["duration_s"]))
        for town, table in zip(towns, made.values(), strict=True)
    ]
    assert [level for level, _ in made] == ["busy", "light", "crowded"]
    assert len(networks) == 1
    assert people[1] < people[0] < people[2]
    assert all(len(table.controllers) == 15 and table.seeds == "9301-9305" for table in made.values())
