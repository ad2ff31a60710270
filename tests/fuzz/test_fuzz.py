"""A few cases of the fuzzing in every run of the tests; `make fuzz` runs thousands."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.cosim.cli.commands import source_environment
from tests.fuzz.cases import CRITERIA, SHORT, TARGET, TRACKS, Case, prepare
from tests.fuzz.harness import judge

pytestmark = pytest.mark.sumo
ROOT = Path(__file__).resolve().parents[2]
TOWN = ("run", "{}/town.sumocfg", *SHORT, "--ego-share", "1")


def test_two_hundred_cases_behave() -> None:
    # In a process of its own, of which every case is a copy: one without threads.
    command = [sys.executable, "-m", "tests.fuzz", "--cases", "200", "--seed", "2"]
    done = subprocess.run(
        command, cwd=ROOT, env=source_environment(), capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "200 of 200 behaved" in done.stdout
    for kind in ("scenario", "pedestrians", "tracks", "study", "criteria", "sumo"):
        assert f"  {kind} " in done.stdout


JUDGED = """
import sys
from pathlib import Path
from tests.fuzz.cases import Case, prepare
from tests.fuzz.harness import judge

folder = Path(sys.argv[1])
prepare(folder)
print(judge(Case(*eval(sys.argv[2])), folder))
"""


def judged(case: Case, folder: Path) -> str:
    """Return how a case is judged, by a process of its own."""
    arguments = (case.kind, case.file, case.content, case.command)
    command = [sys.executable, "-c", JUDGED, str(folder), repr(arguments)]
    done = subprocess.run(
        command, cwd=ROOT, env=source_environment(), capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


@pytest.mark.parametrize("kind", ["scenario", "tracks", "study", "criteria", "sumo"])
def test_files_without_a_mistake_are_taken(kind: str, tmp_path: Path) -> None:
    prepare(tmp_path / "right")
    criterion = b"[[criteria]]\nscope = 'run'\nmetric = 'n_collisions'\noperator = '=='\nthreshold = 0\n"
    study = b"scenarios = ['midblock_zebra']\ncontrollers = ['sumo']\nseeds = '1-2'\n"
    right = {
        "scenario": ("scenario.toml", ("run", "{}", *SHORT)),
        "tracks": ("tracks.csv", ("run", "{}", *SHORT)),
        "study": ("study.toml", (TARGET, "{}/study.toml")),
        "criteria": ("criteria.toml", CRITERIA),
        "sumo": ("town.rou.xml", TOWN),
    }
    file, command = right[kind]
    given = {"tracks": TRACKS.encode(), "study": study, "criteria": criterion}
    content = given.get(kind) or (tmp_path / "right" / kind / file).read_bytes()
    assert judged(Case(kind, file, content, command), tmp_path / "case") == "('exit 0', '')"


def test_a_case_that_does_not_behave_is_noticed(tmp_path: Path) -> None:
    prepare(tmp_path)
    never = Case("sumo", "town.rou.xml", b"<routes/>", ("no-such-command",))
    assert judge(never, tmp_path) == ("exit 2", "")
    wrong = Case("study", "study.toml", b"", (TARGET,))
    ending, what = judge(wrong, tmp_path)
    assert (ending, what) == ("exit 70", "a code that no command has")
