"""Trials on a Dask cluster: the same results, files that travel, and addresses at which nobody answers."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from benchmarks.measuring.one_pedestrian import SPACE
from cosim.batches.job import Configuration
from cosim.batches.shipping import common, unpack, unpack_bundle
from cosim.cli import main
from sumo_scenarios import library
from tests.cosim.batches.test_dask_cluster import cluster
from tests.cosim.cli.test_cli import network
from tests.cosim.search.test_falsify import TABLES, arguments

NOWHERE = "tcp://127.0.0.1:1"


def own_scenario(folder: Path) -> Path:
    """Return a copy of a scenario, with all that it names, which no other machine has."""
    shutil.copytree(library.LIBRARY / "jaywalk_arterial", folder / "mine" / "arterial")
    shutil.copytree(library.LIBRARY / "road_users", folder / "mine" / "road_users")
    return folder / "mine" / "arterial"


@pytest.mark.slow
@pytest.mark.sumo
def test_a_search_on_a_cluster_gives_the_same_bytes_as_one_here(tmp_path: Path) -> None:
    (tmp_path / "space.toml").write_text(SPACE)
    scenario = own_scenario(tmp_path)

    def search(out: str, *more: str) -> Path:
        words = [
            str(scenario) if one == "jaywalk_arterial" else one for one in arguments(tmp_path, tmp_path / out)
        ]
        assert main([*words, *more]) == 0
        return tmp_path / out

    here = search("here", "--jobs", "2")
    with cluster(tmp_path / "cluster", {}) as there:
        away = search("away", "--scheduler", there.address)
        shutil.rmtree(next((away / "trials" / "runs").iterdir()))
        assert search("away", "--scheduler", there.address) == away
    for name in (*TABLES, "sensitivity.csv"):
        assert (away / name).read_bytes() == (here / name).read_bytes(), name
    assert (away / "failures").is_dir()


@pytest.mark.slow
@pytest.mark.sumo
def test_an_estimate_on_a_cluster_gives_the_same_bytes_as_one_here(tmp_path: Path) -> None:
    (tmp_path / "space.toml").write_text(SPACE)
    words = [
        "estimate",
        "jaywalk_arterial",
        "--controller",
        "constant_speed",
        "--method",
        "crude",
        "--budget",
        "100",
    ]
    words += ["--variation", "0.9", "--space", str(tmp_path / "space.toml"), "--set", "vehicles_per_hour=0"]
    assert main([*words, "--jobs", "2", "--out", str(tmp_path / "here")]) == 0
    with cluster(tmp_path / "cluster", {}) as there:
        assert main([*words, "--scheduler", there.address, "--out", str(tmp_path / "away")]) == 0
    ours, theirs = ((tmp_path / one / "estimate.csv").read_bytes() for one in ("here", "away"))
    assert ours == theirs


def configuration_of(place: Path) -> Configuration:
    return Configuration("x", str(place), place.name, "aeb", (), (), ())


def test_a_trial_travels_with_its_own_file_only(tmp_path: Path) -> None:
    base = own_scenario(tmp_path)
    trials = tmp_path / "out" / "trials" / "scenarios"
    shared = common(trials, [configuration_of(base)])
    trial = trials / "trial-0001"
    trial.mkdir(parents=True)
    (trial / library.DEFINITION).write_text(
        'description = "x"\nduration_s = 90.0\nbase = "../../../../mine/arterial"\n'
    )
    rest = shared.rest(configuration_of(trial))
    assert rest is not None
    there = tmp_path / "there"
    unpack(rest.archive, there)
    assert [path.name for path in there.rglob("*") if path.is_file()] == [library.DEFINITION]
    unpack(shared.packed(), there)
    place = unpack_bundle(rest, there)
    assert Path(place).is_relative_to(there)
    inputs = [library.prepare(library.load(str(one)), 1, tmp_path / "work").inputs for one in (place, trial)]
    assert inputs[0] == inputs[1]


def test_the_trial_of_a_configuration_travels_without_its_network(tmp_path: Path) -> None:
    (tmp_path / "roads").mkdir()
    town = network(tmp_path / "roads")
    shared = common(tmp_path / "out", [configuration_of(town)])
    assert {"town.sumocfg", "n.net.xml"} <= {path.name for path in shared.files}
    trial = tmp_path / "out" / "trial-0001"
    trial.mkdir(parents=True)
    (trial / library.DEFINITION).write_text(
        'description = "x"\nduration_s = 90.0\nsumocfg = "../../roads/town.sumocfg"\n'
    )
    rest = shared.rest(configuration_of(trial))
    assert rest is not None
    unpack(shared.packed(), tmp_path / "there")
    loaded = library.load(unpack_bundle(rest, tmp_path / "there"))
    assert loaded.sumocfg is not None
    assert loaded.sumocfg.resolve().is_relative_to(tmp_path / "there")


def test_a_built_in_scenario_need_not_travel(tmp_path: Path) -> None:
    shared = common(tmp_path, [Configuration("x", "midblock_zebra", "x", "aeb", (), (), ())])
    assert not shared.files


@pytest.mark.parametrize("command", ["falsify", "estimate"])
def test_a_cluster_and_a_number_of_jobs_exclude_each_other(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [
        command,
        "jaywalk_arterial",
        "--out",
        str(tmp_path / "out"),
        "--jobs",
        "2",
        "--scheduler",
        NOWHERE,
    ]
    assert main(words) == 2
    error = capsys.readouterr().err
    assert "use either --jobs or --scheduler" in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
@pytest.mark.parametrize("command", ["falsify", "estimate"])
def test_an_address_at_which_nobody_answers_is_refused_and_nothing_is_written(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [command, "jaywalk_arterial", "--controller", "aeb", "--out", str(tmp_path / "out")]
    assert main([*words, "--scheduler", NOWHERE]) == 2
    error = capsys.readouterr().err
    assert f"--scheduler {NOWHERE}: no Dask scheduler answers there" in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()
