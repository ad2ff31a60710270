"""The matrix: who is multiplied by what, and names that last."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

import pytest

from cosim.batches.job import Job
from cosim.batches.matrix import Matrix, build_matrix
from cosim.batches.study import read_study
from cosim.errors import InputError
from sumo_scenarios import library
from tests.cosim.batches.studies import write_study
from tests.cosim.cli.test_cli import configuration


def matrix(folder: Path, **keys: Any) -> Matrix:
    file = write_study(folder, **keys)
    return build_matrix(read_study(file), file)


def test_scenarios_controllers_seeds_and_varied_parameters_are_multiplied(tmp_path: Path) -> None:
    found = matrix(
        tmp_path,
        scenarios=["midblock_zebra", "midblock_unmarked"],
        controllers=["sumo", "aeb", "vo_mpc"],
        seeds="1-30",
        vary={"pedestrians_per_hour": [200, 600], "vehicles_per_hour": [400, 1000]},
    )
    assert len(found.configurations) == 2 * 3 * 2 * 2
    assert len({job.name for job in found.jobs()}) == 2 * 3 * 2 * 2 * 30


def test_seeds_vary_slowest_so_that_an_early_end_leaves_pairs(tmp_path: Path) -> None:
    jobs = matrix(tmp_path, controllers=["sumo", "aeb"], seeds="1-3").jobs()
    assert [(job.seed, job.configuration.controller) for job in jobs[:3]] == [
        (1, "sumo"),
        (1, "aeb"),
        (2, "sumo"),
    ]


def test_a_parameter_applies_to_those_that_have_it_and_multiplies_nobody_else(tmp_path: Path) -> None:
    found = matrix(
        tmp_path,
        controllers=["sumo", "aeb", "vo_mpc"],
        set={"friction": 0.5},
        vary={"steps": [10, 20, 30]},
    )
    settings = {
        name: [dict(one.settings) for one in found.configurations if one.controller == name]
        for name in ("sumo", "aeb", "vo_mpc")
    }
    assert settings == {
        "sumo": [{}],
        "aeb": [{"friction": "0.5"}],
        "vo_mpc": [{"steps": "10"}, {"steps": "20"}, {"steps": "30"}],
    }


def test_a_parameter_of_one_scenario_does_not_multiply_the_other(tmp_path: Path) -> None:
    found = matrix(
        tmp_path, scenarios=["midblock_zebra", "signalised_junction"], vary={"turn": ["left", "right"]}
    )
    assert [(one.scenario_name, one.varied) for one in found.configurations] == [
        ("midblock_zebra", ()),
        ("signalised_junction", (("turn", "left"),)),
        ("signalised_junction", (("turn", "right"),)),
    ]


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"scenarios": ["midblock_zebro"]}, ["midblock_zebro", "midblock_zebra"]),
        ({"controllers": ["vo_mcp"]}, ["vo_mcp", "did you mean 'vo_mpc'"]),
        ({"set": {"pedestrians_per_our": 5}}, ["pedestrians_per_our", "did you mean 'pedestrians_per_hour'"]),
        ({"vary": {"steps": [10]}}, ["steps: no such parameter", "sumo has none"]),
        ({"controllers": ["vo_mpc"], "set": {"model": "paper"}}, ["model: no such", "--controller vo_paper"]),
        ({"set": {"ego_share": 2.0}}, ["share", "at most 1"]),
        ({"set": {"ego_share": "many"}}, ["ego_share", "number"]),
        ({"set": {"ego_share": 0.1, "ego_vehicle": "x"}}, ["exclude each other"]),
    ],
)
def test_what_does_not_exist_is_answered_by_what_does(
    tmp_path: Path, keys: dict[str, Any], words: list[str]
) -> None:
    with pytest.raises(InputError) as caught:
        matrix(tmp_path, **keys)
    text = str(caught.value)
    assert str(tmp_path / "study.toml") in text
    assert all(word in text for word in words), text


def town(folder: Path) -> Path:
    """Write a network, whatever is in it, and a configuration that names it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "n.net.xml").write_text("<net/>")
    return configuration(folder)


def test_scenarios_are_found_beside_the_study_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    town(tmp_path / "study" / "roads")
    monkeypatch.chdir(tmp_path)
    (one,) = matrix(
        Path("study"), scenarios=["roads/town.sumocfg"], set={"ego_route": "e1 e2"}
    ).configurations
    assert one.place == str(tmp_path / "study" / "roads" / "town.sumocfg")
    assert one.request(3).ego_route == ("e1", "e2")
    assert one.scenario_name == "town"


@pytest.mark.parametrize(("share", "text"), [(1.0 / 3.0, "0.3333333333333333"), (0.25, "0.25"), (1, "1")])
def test_the_command_of_a_run_takes_the_very_share_of_egos(tmp_path: Path, share: float, text: str) -> None:
    town(tmp_path)
    (job,) = matrix(tmp_path, scenarios=["town.sumocfg"], seeds="1", set={"ego_share": share}).jobs()
    words = shlex.split(job.command())
    assert words[words.index("--ego-share") + 1] == text
    assert float(text) == job.request().ego_share == share


def test_what_a_configuration_has_is_said_once(tmp_path: Path) -> None:
    town(tmp_path)
    with pytest.raises(InputError) as caught:
        matrix(tmp_path, scenarios=["town.sumocfg"], set={"ego_share": 0.1, "nonsense": 1})
    assert str(caught.value).count("ego_share") == 1


def test_two_scenarios_of_one_name_are_refused(tmp_path: Path) -> None:
    town(tmp_path / "a")
    town(tmp_path / "b")
    with pytest.raises(InputError, match="both called town"):
        matrix(tmp_path, scenarios=["a/town.sumocfg", "b/town.sumocfg"], set={"ego_share": 0.1})


def test_the_share_of_egos_may_be_varied(tmp_path: Path) -> None:
    town(tmp_path)
    found = matrix(
        tmp_path, scenarios=["town.sumocfg"], set={"duration_s": 20}, vary={"ego_share": [0.05, 0.2, 1]}
    )
    assert [one.request(1).ego_share for one in found.configurations] == [0.05, 0.2, 1.0]
    assert len({job.name for job in found.jobs()}) == 6


def test_a_run_keeps_its_name_when_the_study_grows_or_moves(tmp_path: Path) -> None:
    keys: dict[str, Any] = {"scenarios": ["town.sumocfg"], "set": {"ego_share": 0.1}}
    town(tmp_path / "here")
    town(tmp_path / "there")
    small = matrix(tmp_path / "here", controllers=["sumo"], seeds="1-2", **keys)
    large = matrix(tmp_path / "there", controllers=["aeb", "sumo"], seeds="1-9", **keys)
    assert {job.name for job in small.jobs()} < {job.name for job in large.jobs()}


def test_a_name_is_one_that_every_file_system_takes(tmp_path: Path) -> None:
    found = matrix(
        tmp_path,
        vary={"ego_depart_lane": ["a/b c:d", "é" * 300, ""]},
    )
    names = [job.name for job in found.jobs()]
    assert len(set(names)) == len(names) == 6
    for name in names:
        assert len(name.encode()) < 200
        assert set(name) <= set("abcdefghijklmnopqrstuvwxyz0123456789_-=.+ABCDEFGHIJKLMNOPQRSTUVWXYZ")


def test_the_command_of_a_run_asks_for_the_same_run(tmp_path: Path) -> None:
    job: Job = matrix(tmp_path, controllers=["aeb"], set={"duration_s": 50, "friction": 0.5}).jobs()[0]
    assert job.command() == (
        "cosim run midblock_zebra --controller aeb --seed 1 --set duration_s=50 --set friction=0.5"
    )
    assert job.request().settings == {"duration_s": "50", "friction": "0.5"}
    assert library.load(job.configuration.place).name == "midblock_zebra"
