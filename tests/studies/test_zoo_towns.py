"""The networks of the zoo, before anybody drives in them."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies.zoo.__main__ import main
from studies.zoo.catalog import QUICK, Plan, all_recipes, chosen
from studies.zoo.driving import Limits, drive, is_done
from studies.zoo.programs import ZooError, call
from studies.zoo.recipe import Recipe
from studies.zoo.results import read


def test_names_are_unique_and_the_quick_ones_exist() -> None:
    names = [recipe.name for recipe in all_recipes()[0]]
    assert len(names) == len(set(names))
    assert len(names) >= 40
    assert [recipe.name for recipe in chosen(QUICK)] == list(QUICK)


def test_seeds_of_runs_are_others_for_each_seed_of_the_zoo() -> None:
    assert Plan(1, runs=5).run_seeds()[:2] == Plan(1, runs=2).run_seeds()
    assert not set(Plan(1, runs=5).run_seeds()) & set(Plan(2, runs=5).run_seeds())


def test_a_name_that_does_not_exist_is_answered_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["all", "1", "--networks", "atlantis"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("zoo: no network 'atlantis'; there are grid-signals, ")
    assert said.count("\n") == 1


@pytest.mark.sumo
def test_a_network_that_cannot_be_made_is_a_row_with_its_reason(tmp_path: Path) -> None:
    recipe = Recipe("broken", "a mistake", lambda folder, rng: call("netgenerate", "--moon", folder=folder))
    drive(recipe, Plan(1), Limits(), tmp_path)
    assert is_done(tmp_path)
    runs = read(recipe, Plan(1), tmp_path)
    assert len(runs) == 6
    assert all("netgenerate ended with 1" in run.reason for run in runs)


@pytest.mark.sumo
def test_a_program_that_hangs_is_ended() -> None:
    with pytest.raises(ZooError, match="was not done after"):
        call("netgenerate", "--grid", "--grid.number=60", folder=Path("/tmp"), limit_s=0.01)


@pytest.mark.sumo
def test_results_of_another_duration_are_not_gone_on_with(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["all", "1", "--networks", "grid-short", "--controllers", "sumo", "--out", str(tmp_path)]
    (tmp_path / "zoo.json").write_text('{"duration_s": 20.0}')
    assert main(words) == 2
    assert "holds results of another" in capsys.readouterr().err
