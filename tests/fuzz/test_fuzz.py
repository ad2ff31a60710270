"""A few cases of the fuzzing in every run of the tests; `make fuzz` runs thousands."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.cosim.cli.commands import source_environment
from tests.fuzz.cases import TARGET, Case, prepare
from tests.fuzz.harness import judge

pytestmark = pytest.mark.sumo
ROOT = Path(__file__).resolve().parents[2]
FEW = 40
"""Cases in which each kind occurs."""


@pytest.fixture(scope="module", params=[FEW, pytest.param(100, marks=pytest.mark.slow)])
def fuzzed(request: pytest.FixtureRequest) -> tuple[int, str]:
    """Return the number of cases and what is printed of them.

    They are run in a process of its own, of which every case is a copy: one without threads.
    """
    count: int = request.param
    command = [sys.executable, "-m", "tests.fuzz", "--cases", str(count), "--seed", "2"]
    done = subprocess.run(
        command, cwd=ROOT, env=source_environment(), capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return count, done.stdout


@pytest.mark.long
def test_cases_with_mistakes_behave(fuzzed: tuple[int, str]) -> None:
    count, told = fuzzed
    assert f"{count} of {count} behaved" in told
    for kind in ("scenario", "pedestrians", "tracks", "study", "criteria", "sumo"):
        assert f"  {kind} " in told


@pytest.mark.long
@pytest.mark.parametrize("kind", ["scenario", "tracks", "study", "criteria", "sumo"])
def test_files_without_a_mistake_are_taken(kind: str, fuzzed: tuple[int, str]) -> None:
    assert f"  without a mistake: {kind}: exit 0\n" in fuzzed[1]


def test_a_case_that_does_not_behave_is_noticed(tmp_path: Path) -> None:
    prepare(tmp_path)
    never = Case("sumo", "town.rou.xml", b"<routes/>", ("no-such-command",))
    assert judge(never, tmp_path) == ("exit 2", "")
    wrong = Case("study", "study.toml", b"", (TARGET,))
    ending, what = judge(wrong, tmp_path)
    assert (ending, what) == ("exit 70", "a code that no command has")
