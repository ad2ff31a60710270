"""Small networks of the zoo, driven from end to end."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from cosim.cli import main as cosim
from studies.zoo import town
from studies.zoo.__main__ import main
from studies.zoo.catalog import QUICK, chosen
from studies.zoo.driving import TOWN

SEED = 1
SMALL = ("grid-short", "grid-left-hand", "random-short", "roundabouts", "refuges", "rilsa1")
OTHERS = tuple(name for name in QUICK if name not in SMALL)
DURATION_S = 60.0


@pytest.fixture(scope="module", params=SMALL)
def driven(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    """Drive through a network, and return its name and the folder."""
    name: str = request.param
    folder = tmp_path_factory.mktemp(name)
    few = ["--networks", name, "--controllers", "vo_mpc", "--runs", "1", "--jobs", "1"]
    short = ["--duration-s", "40", "--ego-share", "0.4"]
    assert main(["all", str(SEED), *few, *short, "--out", str(folder)]) == 0
    return name, folder


@pytest.mark.sumo
def test_a_small_network_is_driven_to_its_end_and_counted(driven: tuple[str, Path]) -> None:
    name, folder = driven
    with (folder / "networks.csv").open() as file:
        (row,) = csv.DictReader(file)
    assert (row["network"], row["driver"], row["valid runs"]) == (name, "vo_mpc", "1 of 1")
    assert f"### {name}" in (folder / "zoo.md").read_text("utf-8")


@pytest.mark.sumo
def test_what_inspect_calls_good_runs_to_its_end(driven: tuple[str, Path], tmp_path: Path) -> None:
    name, folder = driven
    (recipe,) = chosen([name])
    inspected_and_run(town.make(recipe, SEED, DURATION_S, folder / name / TOWN), tmp_path)


@pytest.mark.sumo
@pytest.mark.slow
@pytest.mark.parametrize("name", OTHERS)
def test_what_inspect_calls_good_runs_to_its_end_elsewhere(name: str, tmp_path: Path) -> None:
    (recipe,) = chosen([name])
    inspected_and_run(town.make(recipe, SEED, DURATION_S, tmp_path / TOWN), tmp_path)


def inspected_and_run(configuration: Path, folder: Path) -> None:
    assert cosim(["inspect", str(configuration)]) == 0
    driving = ["--controller", "sumo", "--ego-share", "0.3", "--seed", str(SEED)]
    words = ["run", str(configuration), *driving, "--duration-s", f"{DURATION_S:g}"]
    assert cosim([*words, "--set", "warmup_s=5", "--out", str(folder / "run")]) == 0
