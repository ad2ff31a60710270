"""Study files: what they may hold, and one clear line for what they may not."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cosim.batches.study import parse_seeds, read_study, study_of, study_text
from cosim.cli import main
from cosim.errors import InputError
from tests.cosim.batches.studies import write_study


def test_a_study_file_is_read_with_its_criteria_and_limits(tmp_path: Path) -> None:
    file = tmp_path / "study.toml"
    file.write_text(
        'scenarios = ["midblock_zebra"]\ncontrollers = ["sumo", "aeb"]\nseeds = "1-3"\nrun_timeout_s = 60\n'
        "[set]\nduration_s = 50\n[vary]\npedestrians_per_hour = [200, 600]\n"
        '[[criteria]]\nscope = "run"\nmetric = "n_collisions"\noperator = "<="\nthreshold = 0\n'
    )
    study = read_study(file)
    assert parse_seeds(study.seeds) == (1, 2, 3)
    assert study.settings == {"duration_s": 50}
    assert study.vary == {"pedestrians_per_hour": [200, 600]}
    assert study.run_timeout_s == 60
    wanted = {"scope": "run", "metric": "n_collisions", "operator": "<=", "threshold": 0}
    assert study.criteria == [wanted]


CRITERION = {
    "scope": "encounter",
    "metric": "collision",
    "operator": "<=",
    "threshold": 0,
    "where": {"preventable_r157": 1},
}


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"seed": "1-3"}, ["unknown key 'seed'", "seeds", "vary"]),
        ({"seeds": "1..3"}, ["1..3", '"1-30"']),
        ({"seeds": "one"}, ["one", '"1-30"']),
        ({"seeds": ""}, ['"1-30"']),
        ({"seeds": "9-3"}, ["9-3", "smaller"]),
        ({"seeds": "1-999999999"}, ["at most 1000000"]),
        ({"seeds": []}, ["at least one seed"]),
        ({"seeds": [1, -2]}, ["from 0", "-2"]),
        ({"seeds": [1, 2**31]}, ["from 0", str(2**31)]),
        ({"seeds": "1-4, 3"}, ["3 is named twice"]),
        ({"seeds": [1.5]}, ["seeds", "list"]),
        ({"seeds": 7}, ["seeds", '"1-30"']),
        ({"scenarios": []}, ["scenarios", "no run"]),
        ({"controllers": []}, ["controllers", "no run"]),
        ({"controllers": ["sumo", "sumo"]}, ["'sumo' is named twice"]),
        ({"controllers": "sumo"}, ["controllers", "list"]),
        ({"vary": {"pedestrians_per_hour": []}}, ["vary.pedestrians_per_hour", "no run"]),
        ({"vary": {"pedestrians_per_hour": [600, 600.0]}}, ["named twice"]),
        ({"vary": {"pedestrians_per_hour": 600}}, ["vary.pedestrians_per_hour", "list"]),
        ({"vary": {"duration_s": [10]}, "set": {"duration_s": 20}}, ["duration_s", "[set]", "[vary]"]),
        ({"set": {"duration_s": [1, 2]}}, ["set.duration_s", "expected a value"]),
        ({"run_timeout_s": 0}, ["run_timeout_s", "greater than 0"]),
        ({"run_timeout_s": "long"}, ["run_timeout_s", "number"]),
    ],
)
def test_a_wrong_study_is_answered_by_what_was_expected(
    tmp_path: Path, keys: dict[str, Any], words: list[str]
) -> None:
    file = write_study(tmp_path, **keys)
    with pytest.raises(InputError) as caught:
        read_study(file)
    text = str(caught.value)
    assert str(file) in text
    assert "\n" not in text
    assert all(word in text for word in words), text


def test_a_criterion_that_no_check_could_judge_is_refused_before_any_run() -> None:
    content = {"scenarios": ["a"], "controllers": ["sumo"], "seeds": "1"}
    with pytest.raises(InputError, match=r"study: criteria: number 2 \(n_hits\): .*no metric"):
        study_of({**content, "criteria": [CRITERION, {**CRITERION, "metric": "n_hits"}]}, "study")


def test_a_file_that_is_missing_or_no_toml_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"gone\.toml.*No such file"):
        read_study(tmp_path / "gone.toml")
    (tmp_path / "bad.toml").write_text("scenarios = [")
    with pytest.raises(InputError, match=r"bad\.toml.*not valid TOML"):
        read_study(tmp_path / "bad.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match=r"bytes\.toml"):
        read_study(tmp_path / "bytes.toml")


def test_a_misspelt_key_is_named_and_not_the_one_that_is_missing_for_it(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text('scenarios = ["a"]\ncontrolers = ["aeb"]\nseeds = "1"\n')
    with pytest.raises(InputError, match=r"unknown key 'controlers'; did you mean 'controllers'\?"):
        read_study(tmp_path / "s.toml")


def test_a_key_that_is_missing_is_named(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text('scenarios = ["midblock_zebra"]\nseeds = "1"\n')
    with pytest.raises(InputError, match="key 'controllers' is missing"):
        read_study(tmp_path / "s.toml")


@given(st.lists(st.integers(0, 10**6), min_size=1, max_size=20, unique=True))
def test_seeds_written_one_by_one_are_the_list(seeds: list[int]) -> None:
    assert parse_seeds(", ".join(map(str, seeds))) == parse_seeds(seeds) == tuple(seeds)


VALUES = st.one_of(
    st.booleans(),
    st.integers(-(10**12), 10**12),
    st.floats(allow_nan=False),
    st.text(st.characters(exclude_categories=["Cs"])),
)


@pytest.mark.long
@given(
    st.dictionaries(st.text(st.characters(exclude_categories=["Cs"]), min_size=1), VALUES),
    st.lists(st.text(st.characters(exclude_categories=["Cs"])), min_size=1, unique=True),
)
def test_a_study_written_as_a_file_is_the_same_study(settings: dict[str, Any], names: list[str]) -> None:
    content = {
        "scenarios": names,
        "controllers": ["sumo"],
        "seeds": [3, 5],
        "set": settings,
        "criteria": [CRITERION],
    }
    study = study_of(content, "study")
    text = study_text(study)
    assert study_of(tomllib.loads(text), "study") == study
    assert tomllib.loads(text) == content


@pytest.mark.parametrize("name", ["./mine.py", "process:./mine", "fmu:mine.fmu"])
def test_a_study_file_executes_no_file_unless_that_is_allowed(name: str, tmp_path: Path) -> None:
    file = tmp_path / "study.toml"
    file.write_text(f'scenarios = ["midblock_zebra"]\ncontrollers = ["sumo", "{name}"]\nseeds = "1"\n')
    with pytest.raises(
        InputError, match=r"would execute a file: allow it with .* --allow-programs"
    ) as caught:
        read_study(file)
    assert "\n" not in str(caught.value)
    assert read_study(file, allow_programs=True).controllers == ["sumo", name]


def test_the_command_line_refuses_such_a_study_before_anything_is_executed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'w')\n")
    file = tmp_path / "study.toml"
    file.write_text(
        f'scenarios = ["midblock_zebra"]\ncontrollers = ["{tmp_path / "mine.py"}"]\nseeds = "1"\n'
    )
    for words in (["batch", "--dry-run"], ["check"]):
        assert main([words[0], str(file), *words[1:]]) == 2
        assert "--allow-programs" in capsys.readouterr().err
    assert not (tmp_path / "executed").exists()
