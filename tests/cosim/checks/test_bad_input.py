"""Everything that is wrong with a check is one line and exit code 2 before anything is simulated."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cosim.batches.studies import write_study
from tests.cosim.cli.test_cli import refused

ONE = 'scope = "run"\nmetric = "n_collisions"\noperator = "=="\nthreshold = 0\n'


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def with_criterion(text: str) -> str:
    """Return the place of a study with this criterion."""
    study = write_study(Path("study"))
    study.write_text(study.read_text() + "[[criteria]]\n" + text)
    return str(study)


@pytest.mark.parametrize(
    ("line", "replacement", "part"),
    [
        ('"n_collisions"', '"n_colisions"', "did you mean 'n_collisions'?"),
        ("threshold = 0", 'threshold = "none"', "threshold: expected a number, got 'none'"),
        ("threshold = 0\n", "", "threshold is missing"),
        ('"=="', '"!="', "operator '!=': expected one of < <= > >= =="),
        ("threshold", 'statistic = "mean"\nthreshold', "statistic belongs to"),
        (
            "threshold",
            'scenarios = ["town"]\nthreshold',
            "judges no run; there are the scenarios midblock_zebra",
        ),
        ("threshold", 'controllers = ["aeb"]\nthreshold', "judges no run"),
        ("threshold", 'controllers = ["abe"]\nthreshold', "names the controller 'abe', which does not exist"),
    ],
)
def test_a_wrong_criterion_is_refused_and_nothing_is_run(
    line: str, replacement: str, part: str, capsys: pytest.CaptureFixture[str]
) -> None:
    study = with_criterion(ONE.replace(line, replacement))
    said = refused(capsys, "check", study, "--out", "out")
    assert said.startswith("cosim: study/study.toml: ")
    assert part in said
    assert not Path("out").exists()


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["midblock_zebra", "--filter", "town"], "--filter town: nothing in midblock_zebra matches"),
        (["suite:fmvss127", "--filter", "town"], "--filter town: nothing in suite:fmvss127 matches"),
        (["suite:fmvss126"], "did you mean 'fmvss127'?"),
        (["suite:fmvss127", "--drop-recordings"], "--drop-recordings"),
        (["midblock_zebr"], "no such scenario"),
        (["nothing.toml"], "nothing.toml: cannot be read"),
        (["midblock_zebra", "--criteria", "nothing.toml"], "--criteria nothing.toml: cannot be read"),
        (["midblock_zebra", "--controller", "abe"], "no controller 'abe'"),
        (["midblock_zebra", "--seeds", "one"], "seeds"),
        (["midblock_zebra", "--set", "ego_share=much"], "--set ego_share=much: expected a number"),
        (["midblock_zebra", "--baseline", "nothing"], "--baseline nothing: no such folder"),
        (["midblock_zebra", "--baseline", "."], "contains no runs"),
        (["midblock_zebra", "--level", "5"], "--level: expected a probability"),
        (["midblock_zebra", "--junit", "."], "--junit .: expected a file"),
        (["midblock_zebra", "midblock_zebra"], "two targets are called midblock_zebra"),
        (["midblock_zebra", "--run-timeout-s", "0"], "run_timeout_s"),
    ],
)
def test_a_wrong_argument_is_refused(
    arguments: list[str], part: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert part in refused(capsys, "check", *arguments, "--out", "out")
    assert not Path("out").exists()


def test_a_folder_with_other_files_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    Path("out").mkdir()
    Path("out/thesis.txt").write_text("precious")
    assert "this one has thesis.txt in it" in refused(capsys, "check", "midblock_zebra", "--out", "out")


def test_a_target_without_a_criterion_is_told_how_to_write_one(capsys: pytest.CaptureFixture[str]) -> None:
    scenario = Path("town")
    scenario.mkdir()
    text = 'description = "x"\nduration_s = 10.0\npackaged_sumocfg = "tools/game/fokr_bs_demo.sumocfg"\n'
    (scenario / "scenario.toml").write_text(text + "[egos]\nshare = 0.2\n")
    said = refused(capsys, "check", "town", "--out", "out")
    assert "no criterion" in said
    assert '[[criteria]] scope = "run", metric = "n_collisions"' in said


def test_a_criterion_in_a_scenario_is_read_when_the_scenario_is_checked(
    capsys: pytest.CaptureFixture[str],
) -> None:
    scenario = Path("town")
    scenario.mkdir()
    text = 'description = "x"\nduration_s = 10.0\npackaged_sumocfg = "tools/game/fokr_bs_demo.sumocfg"\n'
    wrong = ONE.replace("n_collisions", "n_colisions")
    (scenario / "scenario.toml").write_text(f"{text}[egos]\nshare = 0.2\n[[criteria]]\n{wrong}")
    assert "did you mean 'n_collisions'?" in refused(capsys, "check", "town", "--out", "out")


def test_a_file_of_criteria_holds_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    Path("c.toml").write_text("[[criteria]]\n" + ONE + '[other]\nkey = "value"\n')
    said = refused(capsys, "check", "midblock_zebra", "--criteria", "c.toml", "--out", "out")
    assert "only [[criteria]] expected" in said
