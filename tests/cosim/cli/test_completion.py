"""Completion in a shell, help and the list of names: quick answers without loading anything."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys

import pytest

from analysis.results import metric_catalog
from controllers import catalog
from cosim.cli import main, names
from cosim.cli.completion import Shell
from cosim.sensing import catalog as sensing_catalog
from sumo_scenarios import library
from sumo_scenarios.suites import tables


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("cosim re", {"replay", "report"}),
        ("cosim run mid", {"midblock_unmarked", "midblock_zebra"}),
        ("cosim run x --controller vo_", {"vo_ga", "vo_mpc", "vo_paper"}),
        ("cosim check suite:f", {"suite:false_reactions", "suite:fmvss127"}),
        ("cosim list con", {"controllers"}),
    ],
)
def test_bash_is_told_what_may_follow(
    words: str, expected: set[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("_COSIM_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(len(words.split(" ")) - 1))
    with pytest.raises(SystemExit) as ended:
        main([])
    assert ended.value.code == 0
    assert set(capsys.readouterr().out.split()) == expected


@pytest.mark.parametrize("shell", Shell)
def test_the_script_of_a_shell_is_one_that_it_reads(shell: Shell, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert "_COSIM_COMPLETE" in script
    assert f"complete_{shell}" in script
    program = shutil.which(shell)
    if program is not None:
        subprocess.run([program, "-n", "/dev/stdin"], input=script, text=True, check=True)


def test_the_names_are_those_of_the_catalogues() -> None:
    assert names.scenarios() == list(library.names())
    assert names.controllers() == list(catalog.names())
    assert names.metrics() == sorted(one.name for one in metric_catalog.find_metrics())
    assert names.sensing_models() == list(sensing_catalog.names())
    assert names.suites() == [f"suite:{name}" for name in tables.names()]


def test_list_names_everything(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    told = capsys.readouterr().out
    for name in ("midblock_zebra", "vo_mpc", "onboard", "suite:fmvss127", "time_to_collision"):
        assert name in told


def test_the_help_shows_every_command_in_full(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    told = capsys.readouterr().out
    assert not [line for line in told.splitlines() if line.endswith("...") and "[ARGS]" not in line]
    assert len(re.findall(r"^  [a-z]+ {2,}\S", told, re.MULTILINE)) >= 14
    assert max(map(len, told.splitlines())) <= 80


HEAVY = ("numpy", "pandas", "pyarrow", "scipy", "libsumo", "rich.console", "statsmodels")


def test_help_and_list_load_nothing_heavy() -> None:
    program = (
        "import sys; from cosim.cli import main\n"
        "for words in (['--help'], ['list'], ['run', '--help']):\n"
        f"    main(words); print(words, [name for name in {HEAVY!r} if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=60
    )
    told = done.stdout.splitlines()
    for words in (["--help"], ["list"], ["run", "--help"]):
        assert f"{words} []" in told
