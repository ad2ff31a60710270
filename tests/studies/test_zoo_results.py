"""What the zoo counts, and what it says about it."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import pytest

from studies.zoo import page, results, tables
from studies.zoo.bars import Bar, bars
from studies.zoo.catalog import Plan, chosen
from studies.zoo.results import Run
from studies.zoo.tally import of, shared
from tests.studies import zoo_runs

PLAN = Plan(5, runs=2)
FIRST, SECOND = PLAN.run_seeds()
(TOWN,) = chosen(["grid-short"])


def read(folder: Path) -> list[Run]:
    return results.read(TOWN, PLAN, folder)


def verdicts(runs: list[Run]) -> dict[str, Bar]:
    return {bar.what: bar for bar in bars(runs, [])}


@pytest.fixture
def mixed(tmp_path: Path) -> list[Run]:
    """One contact of vo_mpc, three of sumo, and a failure of each kind."""
    zoo_runs.run(tmp_path, "vo_mpc", FIRST, [zoo_runs.ENCOUNTER])
    zoo_runs.failure(
        tmp_path, "vo_mpc", SECOND, "results/.work/town-4/run could not be analysed: no row; see log"
    )
    undefined = {**zoo_runs.ENCOUNTER, "preventable_r157": "", "impact_speed_kmh": 30.5}
    zoo_runs.run(tmp_path, "sumo", FIRST, [undefined, zoo_runs.ENCOUNTER], ego_time_loss_s=36.0)
    zoo_runs.run(tmp_path, "sumo", SECOND, [zoo_runs.ENCOUNTER], n_entered=60)
    zoo_runs.run(tmp_path, "aeb", FIRST, valid=0, invalid_reason="SUMO teleported 1 egos")
    zoo_runs.ended(tmp_path, 3, "cosim: one line")
    return read(tmp_path)


def test_every_run_that_was_asked_for_is_a_row(mixed: list[Run]) -> None:
    assert [(run.controller, run.seed) for run in mixed] == [
        (controller, seed) for controller in PLAN.controllers for seed in PLAN.run_seeds()
    ]
    reasons = {(run.controller, run.seed): run.reason for run in mixed}
    assert reasons["vo_mpc", FIRST] == ""
    assert reasons["vo_mpc", SECOND] == " could not be analysed: no row; see log"
    assert reasons["aeb", FIRST] == "SUMO teleported 1 egos"
    assert reasons["aeb", SECOND] == "cosim: one line"


@pytest.mark.parametrize("cell", [None, ""], ids=["no column", "an empty cell"])
def test_a_count_that_a_run_does_not_tell_is_not_taken_for_0(tmp_path: Path, cell: str | None) -> None:
    values: dict[str, Any] = {} if cell is None else {"n_unheard_of": cell}
    zoo_runs.run(tmp_path, "vo_mpc", FIRST, **values)
    with pytest.raises(KeyError, match="n_unheard_of"):
        of(read(tmp_path), "vo_mpc").total("n_unheard_of")


def test_runs_that_failed_are_counted_as_failed_and_nowhere_else(mixed: list[Run]) -> None:
    tally = of(mixed, "vo_mpc")
    assert (len(tally.runs), len(tally.valid), tally.entered, len(tally.contacts)) == (2, 1, 50, 1)
    assert of(mixed, "aeb").entered == 0


def test_an_undefined_contact_counts_as_preventable(mixed: list[Run]) -> None:
    tally = of(mixed, "sumo")
    assert (tally.preventable, tally.largest_impact_kmh, tally.entered) == (3, 30.5, 110)


def test_delay_is_the_mean_of_the_egos(mixed: list[Run]) -> None:
    assert of(mixed, "sumo").delay_s == pytest.approx(76.0 / 8)


def test_drivers_are_compared_where_both_have_a_valid_run(mixed: list[Run]) -> None:
    mine, theirs = shared(mixed, "vo_mpc", "sumo")
    assert [run.seed for run in theirs.runs] == [FIRST]
    assert (len(mine.contacts), len(theirs.contacts)) == (1, 2)


def test_bars_say_what_was_measured_and_whether_they_are_met(mixed: list[Run]) -> None:
    found = verdicts(mixed)
    assert found["every run finishes and is analysed and reported"].measured == "2 of 6 failed"
    assert found["0 preventable contacts"].verdict == "**missed**"
    assert found["contacts at most a fifth of those of SUMO's driver, same runs"].measured == "1 against 2"
    assert found["0 deadlocks"].verdict == "met"
    assert not found["mean delay at most 5 % above that of SUMO's driver, same runs"].met  # 10 against 9 s


def test_nothing_is_met_where_nothing_was_measured(tmp_path: Path) -> None:
    zoo_runs.ended(tmp_path, 2, "netgenerate ended with 1")
    runs = read(tmp_path)
    assert {run.reason for run in runs} == {"netgenerate ended with 1"}
    met = [bar.what for bar in bars(runs, []) if bar.met]
    assert met == ["at most 1 run in 50 with an ego that SUMO teleported"]


@pytest.mark.parametrize("kind", ["appeared", "touching_at_start"])
def test_people_who_appeared_are_a_class_of_their_own(tmp_path: Path, kind: str) -> None:
    sudden = {**zoo_runs.ENCOUNTER, "contact_class": kind, "contact_place": "carriageway"}
    zoo_runs.run(tmp_path, "vo_mpc", FIRST, [{**sudden, "preventable_r157": 0}])
    zoo_runs.run(tmp_path, "vo_mpc", SECOND, n_entered=200)
    zoo_runs.ended(tmp_path)
    runs = read(tmp_path)
    assert dict(of(runs, "vo_mpc").classes) == {kind: 1}
    found = verdicts(runs)
    assert found["0 preventable contacts"].met
    assert found["impact speed at most 5 km/h, except with pedestrians who appeared suddenly"].met
    assert found["contacts with pedestrians who appeared suddenly: at most 1 in 200 entered encounters"].met
    assert "carriageway" in page.text([TOWN], PLAN, runs, [], "make zoo", {"vo_mpc": "0" * 40})


def test_interventions_that_tell_their_cause_are_named_and_the_others_counted(tmp_path: Path) -> None:
    causes: dict[str, Any] = {"n_interventions_tight_bend": 2, "n_interventions_off_lane": 3}
    zoo_runs.run(tmp_path, "vo_mpc", FIRST, n_interventions=5, **causes)
    zoo_runs.run(tmp_path, "vo_mpc", SECOND, n_interventions=6, **causes)
    zoo_runs.ended(tmp_path)
    bar = verdicts(read(tmp_path))["0 unexplained interventions"]
    assert bar.measured.startswith("1 besides 4 in")
    assert "6 in" in bar.measured
    assert not bar.met


def test_the_page_has_a_table_a_network_and_a_command_for_each_failure_and_contact(mixed: list[Run]) -> None:
    text = page.text(
        [TOWN], PLAN, mixed, ["sumo-rl is not installed"], "make zoo SEED=7", {"vo_mpc": "0" * 40}
    )
    assert "### grid-short" in text
    assert "SUMO teleported 1 egos" in text
    for run in mixed:
        shown = bool(run.reason) or (run.controller == "vo_mpc" and bool(run.contacts))
        assert (f"`{run.command}`" in text) == shown
    assert "Left out: sumo-rl is not installed." in text


def test_tables_are_written_beside_the_runs(mixed: list[Run], tmp_path: Path) -> None:
    tables.write(tmp_path, mixed)
    with (tmp_path / "contacts.csv").open() as file:
        contacts = list(csv.DictReader(file))
    assert [row["controller"] for row in contacts] == ["vo_mpc", "sumo", "sumo", "sumo"]
    assert contacts[0]["command"] == (
        f"python -m studies.zoo one 5 grid-short --controller vo_mpc --run-seed {FIRST}"
    )
    with (tmp_path / "failures.csv").open() as file:
        assert len(list(csv.DictReader(file))) == 3
    with (tmp_path / "networks.csv").open() as file:
        assert [row["driver"] for row in csv.DictReader(file)] == ["vo_mpc", "aeb", "sumo"]
