"""Small networks of the zoo: made, and driven from end to end."""

from __future__ import annotations

import csv
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from cosim.cli import main as cosim
from studies.zoo import town
from studies.zoo.__main__ import main
from studies.zoo.catalog import QUICK, chosen
from studies.zoo.driving import RESULTS, TOWN

pytestmark = pytest.mark.long

SEED = 1
SMALL = ("grid-short", "grid-left-hand", "random-short", "roundabouts", "refuges", "rilsa1")
OTHERS = tuple(name for name in QUICK if name not in SMALL)
COUNTED = "grid-short"
DURATION_S = 60.0
"""Of the longer runs [s]."""
SHORT_S = 20.0
"""Of the others; long enough for some cars to set out [s]."""
WARMUP_S = 5.0
"""Not recorded [s]."""
Towns = Callable[[str, int], Path]


@pytest.fixture(scope="module")
def zoo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a zoo of one small network, driven by the command."""
    folder = tmp_path_factory.mktemp("zoo")
    few = ["--networks", COUNTED, "--controllers", "vo_mpc", "--runs", "1", "--jobs", "1"]
    short = ["--duration-s", f"{SHORT_S:g}", "--ego-share", "0.6"]
    assert main(["all", str(SEED), *few, *short, "--out", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def towns(tmp_path_factory: pytest.TempPathFactory) -> Towns:
    """Return the short town of a name and a seed, as its configuration; each is made once."""

    @cache
    def made(name: str, seed: int) -> Path:
        return town_of(name, seed, tmp_path_factory.mktemp(name) / TOWN)

    return made


def town_of(name: str, seed: int, folder: Path) -> Path:
    (recipe,) = chosen([name])
    return town.make(recipe, seed, SHORT_S, folder)


def content(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.sumo
@pytest.mark.parametrize(
    "name",
    [
        "random-short",
        "rilsa1",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("refuges", "rilsa3")),
    ],
)
def test_a_seed_makes_the_same_bytes(name: str, towns: Towns, tmp_path: Path) -> None:
    one = content(towns(name, SEED).parent)
    assert one == content(town_of(name, SEED, tmp_path / "same").parent)


@pytest.mark.sumo
@pytest.mark.slow
@pytest.mark.parametrize("name", ["refuges", "rilsa3"])
def test_another_seed_makes_another_town(name: str, towns: Towns) -> None:
    assert content(towns(name, SEED).parent) != content(towns(name, SEED + 1).parent)


@pytest.mark.sumo
def test_another_seed_makes_another_network_and_other_traffic(towns: Towns) -> None:
    one = content(towns("random-short", SEED).parent)
    other = content(towns("random-short", SEED + 1).parent)
    assert all(one[name] != other[name] for name in ("town.net.xml", "cars.rou.xml", "people.rou.xml"))


@pytest.mark.sumo
def test_avenues_with_a_median_have_crossings_in_two_parts(towns: Towns) -> None:
    net = (towns("refuges", SEED).parent / "town.net.xml").read_text()
    arms = 1 * 4 + 4 * 3 + 4 * 2
    assert net.count('function="crossing"') > arms


@pytest.mark.sumo
def test_cars_and_people_have_the_names_that_random_trips_gives_them(towns: Towns) -> None:
    folder = towns("roundabouts", SEED).parent
    assert "<roundabout" in (folder / "town.net.xml").read_text()
    assert '<vehicle id="0"' in (folder / "cars.rou.xml").read_text()
    assert '<person id="0"' in (folder / "people.rou.xml").read_text()


@pytest.mark.sumo
def test_a_small_network_is_driven_to_its_end_and_counted(zoo: Path) -> None:
    row = only_row(zoo / "networks.csv")
    assert (row["network"], row["driver"], row["valid runs"]) == (COUNTED, "vo_mpc", "1 of 1")
    assert f"### {COUNTED}" in (zoo / "zoo.md").read_text("utf-8")


@pytest.mark.sumo
def test_the_network_that_the_zoo_drove_is_one_that_inspect_calls_good(zoo: Path) -> None:
    (configuration,) = (zoo / COUNTED / TOWN).glob("*.sumocfg")
    assert cosim(["inspect", str(configuration)]) == 0
    (run,) = (zoo / COUNTED / RESULTS / "runs").iterdir()
    row = only_row(run / "runs.csv")
    assert row["valid"] == "1"
    moved(row)


@pytest.mark.sumo
@pytest.mark.parametrize("name", [name for name in SMALL if name != COUNTED])
def test_what_inspect_calls_good_is_driven_to_its_end(name: str, towns: Towns, tmp_path: Path) -> None:
    moved(inspected_and_run(towns(name, SEED), tmp_path, "vo_mpc", SHORT_S, ego_share=0.6))


@pytest.mark.sumo
@pytest.mark.slow
@pytest.mark.parametrize("name", SMALL + OTHERS)
def test_what_inspect_calls_good_runs_to_its_end_for_a_minute(name: str, tmp_path: Path) -> None:
    (recipe,) = chosen([name])
    configuration = town.make(recipe, SEED, DURATION_S, tmp_path / TOWN)
    inspected_and_run(configuration, tmp_path, "sumo", DURATION_S, ego_share=0.3)


def only_row(table: Path) -> dict[str, str]:
    with table.open() as file:
        (row,) = csv.DictReader(file)
    return row


def moved(row: dict[str, str]) -> None:
    assert int(row["ego_count"]) >= 3
    assert float(row["ego_dist_km"]) > 0.1


def inspected_and_run(
    configuration: Path, folder: Path, controller: str, duration_s: float, ego_share: float
) -> dict[str, str]:
    """Inspect a configuration, drive in it to the end, and return the row of the run."""
    assert cosim(["inspect", str(configuration)]) == 0
    driving = ["--controller", controller, "--ego-share", f"{ego_share:g}", "--seed", str(SEED)]
    words = ["run", str(configuration), *driving, "--duration-s", f"{duration_s - WARMUP_S:g}"]
    assert cosim([*words, "--set", f"warmup_s={WARMUP_S:g}", "--out", str(folder / "run")]) == 0
    row = only_row(folder / "run/runs.csv")
    assert row["valid"] == "1"
    assert float(row["duration_s"]) == pytest.approx(duration_s - WARMUP_S, abs=0.11)
    return row
