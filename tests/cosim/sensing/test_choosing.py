"""Which model a run has: catalogue, scenario, command line, study; every mistake is one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim.batches.matrix import Matrix, build_matrix
from cosim.batches.study import read_study
from cosim.cli import main
from cosim.errors import InputError
from cosim.running.compose import inputs_of
from cosim.running.request import RunRequest
from cosim.sensing import catalog, chosen
from tests.cosim.batches.studies import write_study

TABLE = {"model": "onboard", "range_m": 30.0, "latency_ms": 200.0}


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("roadside", {"latency_ms": -1.0}, ["latency_ms = -1.0", "expected at least 0"]),
        ("roadside", {"latency_ms": "-20"}, ["latency_ms = '-20'", "expected at least 0"]),
        ("roadside", {"loss_probability": 1.5}, ["loss_probability", "expected at most 1"]),
        ("onboard", {"miss_probability": -0.1}, ["miss_probability", "expected at least 0"]),
        ("fused", {"unit_miss_probability": "2"}, ["unit_miss_probability", "expected at most 1"]),
        ("onboard", {"range_m": 0.0}, ["range_m", "expected more than 0"]),
        ("onboard", {"range_m": "far"}, ["range_m = 'far'", "expected a number"]),
        ("onboard", {"range_m": "nan"}, ["range_m", "expected"]),
        ("onboard", {"range_m": "inf"}, ["range_m", "expected a finite number"]),
        ("onboard", {"field_of_view_deg": 400}, ["field_of_view_deg", "expected at most 360"]),
        ("onboard", {"confirm_hits": 2.5}, ["confirm_hits", "expected a whole number"]),
        (
            "onboard",
            {"confirm_hits": 6, "confirm_looks": 5},
            ["confirm_hits = 6", "at most confirm_looks = 5"],
        ),
        ("onboard", {"rang_m": 3}, ["no parameter 'rang_m'", "did you mean 'range_m'"]),
        ("perfect", {"range_m": 3}, ["no parameter 'range_m'", "it has none"]),
        ("roadside", {"message_rate_hz": 0}, ["message_rate_hz", "expected more than 0"]),
        ("roadside", {"unit_sees_over_vehicles": "perhaps"}, ["expected true or false"]),
        ("roadside", {"units": "here"}, ["units", "'120,-4'", "got 'here'"]),
        ("roadside", {"units": "1,2,3,4"}, ["units", "got '1,2,3,4'"]),
        ("roadside", {"units": "1,inf"}, ["units", "got '1,inf'"]),
        ("roadside", {"units": " "}, ["units", "at least one place"]),
        ("omniscient", {}, ["no sensing model 'omniscient'", "there are: fused, onboard, perfect, roadside"]),
        ("onbord", {}, ["did you mean 'onboard'"]),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(
    name: str, values: dict[str, object], words: list[str]
) -> None:
    with pytest.raises(InputError) as caught:
        catalog.build(name, values)
    text = str(caught.value)
    assert "\n" not in text
    assert all(word in text for word in words), text


def test_the_scenario_says_which_model_and_who_asks_may_say_another() -> None:
    name, own = chosen.choose(TABLE, "scenario.toml", None, {})
    assert name == "onboard"
    assert catalog.values_of(own)["range_m"] == 30.0
    name, other = chosen.choose(TABLE, "scenario.toml", "roadside", {"loss_probability": "0.1"})
    assert name == "roadside"
    assert catalog.values_of(other)["latency_ms"] == 200.0
    assert catalog.values_of(other)["loss_probability"] == 0.1
    assert chosen.choose({}, "scenario.toml", None, {})[0] == "perfect"


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"modell": "onboard"}, ["[sensing] has the key 'modell'", "keys that exist: model"]),
        ({"model": "x-ray"}, ["no sensing model 'x-ray'"]),
        # Of a model that is not the one in use.
        ({"model": "onboard", "latency_ms": -1.0}, ["latency_ms = -1.0"]),
    ],
)
def test_a_mistake_in_a_scenario_names_its_place(table: dict[str, object], words: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        chosen.choose(table, "here/scenario.toml", None, {})
    assert all(word in str(caught.value) for word in ["here/scenario.toml: ", *words]), caught.value


def test_a_name_that_two_have_needs_a_prefix() -> None:
    both = ("range_m", "headway_s")
    with pytest.raises(InputError, match=r"expected sensing\.range_m or other\.range_m"):
        chosen.split({"range_m": "3"}, "onboard", both)
    given = {"sensing.range_m": "3", "other.range_m": "4", "headway_s": "1", "hold_s": "2"}
    assert chosen.split(given, "onboard", both) == (
        {"range_m": "3", "hold_s": "2"},
        {"range_m": "4", "headway_s": "1"},
    )


def test_no_controller_has_a_parameter_of_a_sensing_model() -> None:
    from controllers import catalog as controllers

    of_controllers = {key for name in controllers.names() for key in controllers.parameters(name)}
    assert not of_controllers & catalog.all_parameters()


def _inputs(sensing: str | None = None, **settings: str) -> tuple[str, str, str]:
    request = RunRequest("midblock_zebra", "aeb", sensing=sensing, settings=settings)
    inputs = inputs_of(request)
    return inputs.sensing, inputs.config_id(), inputs.run_id()


def test_sensing_is_part_of_a_run_s_identity() -> None:
    runs = [
        _inputs(),
        _inputs("onboard"),
        _inputs("onboard", range_m="40"),
        _inputs("roadside"),
        _inputs("roadside", latency_ms="300"),
    ]
    assert [one[0] for one in runs] == ["perfect", "onboard", "onboard", "roadside", "roadside"]
    assert len({one[1] for one in runs}) == len({one[2] for one in runs}) == 5
    assert _inputs("perfect") == runs[0]
    assert _inputs("onboard", range_m="60") == runs[1]


@pytest.mark.parametrize(
    ("flags", "words"),
    [
        (["--sensing", "radar"], "no sensing model 'radar'"),
        (["--sensing", "roadside", "--set", "latency_ms=-5"], "latency_ms = '-5': expected at least 0"),
        (
            ["--sensing", "onboard", "--set", "miss_probability=1.2"],
            "miss_probability = '1.2': expected at most 1",
        ),
        (["--set", "range_m=40"], "--set range_m: no such parameter; --sensing fused or onboard has it"),
        (["--sensing", "onboard", "--set", "rang_m=40"], "did you mean 'range_m'"),
        (["--sensing", "onboard", "--set", "sensing.rang_m=40"], "did you mean 'range_m'"),
    ],
)
def test_bad_input_ends_with_one_line_and_code_2(
    flags: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["run", "midblock_zebra", *flags, "--out", str(out)]) == 2
    error = capsys.readouterr().err.strip()
    assert words in error
    assert "\n" not in error
    assert not out.exists()


@pytest.mark.sumo
def test_a_unit_outside_the_network_is_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    flags = ["--sensing", "roadside", "--set", "units=9000,9000"]
    assert main(["run", "midblock_zebra", *flags, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err.strip()
    assert "unit at 9000,9000 is outside the network" in error
    assert "\n" not in error
    assert not (tmp_path / "out").exists()


def _matrix(folder: Path, **keys: object) -> Matrix:
    path = write_study(folder, **keys)
    return build_matrix(read_study(path), path)


def test_sensing_is_an_axis_of_a_study_and_its_parameters_multiply_only_whom_they_concern(
    tmp_path: Path,
) -> None:
    found = _matrix(
        tmp_path,
        controllers=["aeb"],
        sensing=["perfect", "onboard", "roadside"],
        vary={"latency_ms": [0, 200]},
    )
    assert [one.varied for one in found.configurations] == [
        (("sensing", "perfect"),),
        (("sensing", "onboard"),),
        (("sensing", "roadside"), ("latency_ms", "0")),
        (("sensing", "roadside"), ("latency_ms", "200")),
    ]
    assert len({job.name for job in found.jobs()}) == 8
    last = found.jobs()[-1]
    assert last.request().sensing == "roadside"
    assert last.request().settings["latency_ms"] == "200"
    assert "--sensing roadside" in last.command()
    assert len({one.road for one in found.configurations}) == 4


def test_a_study_that_does_not_speak_of_sensing_has_the_scenarios_own(tmp_path: Path) -> None:
    (one,) = _matrix(tmp_path).configurations
    assert one.sensing is None
    assert one.request(1).sensing is None


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"sensing": []}, "sensing: expected at least one"),
        ({"sensing": ["onboard", "onboard"]}, "sensing: 'onboard' is named twice"),
        ({"sensing": ["radar"]}, "no sensing model 'radar'"),
        ({"sensing": ["onboard"], "vary": {"latency_ms": [1]}}, "latency_ms: no such parameter"),
    ],
)
def test_a_study_s_mistakes_are_told(tmp_path: Path, keys: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        _matrix(tmp_path, **keys)
