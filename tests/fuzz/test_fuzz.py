"""A few cases of the fuzzing in every run of the tests; `make fuzz` runs thousands."""

from __future__ import annotations

import json
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


CRITERION = b"[[criteria]]\nscope = 'run'\nmetric = 'n_collisions'\noperator = '=='\nthreshold = 0\n"
STUDY = b"scenarios = ['midblock_zebra']\ncontrollers = ['sumo']\nseeds = '1-2'\n"
JUDGED = """
import json
import sys
from pathlib import Path
from tests.fuzz.cases import Case, prepare
from tests.fuzz.harness import judge
from tests.fuzz.running import load

folder = Path(sys.argv[1])
prepare(folder)
load()
found = {}
for kind, file, content, command in eval(sys.argv[2]):
    content = content or (folder / kind / file).read_bytes()
    found[kind] = judge(Case(kind, file, content, command), folder)
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """Return how files without a mistake are judged, each by a copy of one process without threads."""
    right = (
        ("scenario", "scenario.toml", b"", ("run", "{}", *SHORT)),
        ("tracks", "tracks.csv", TRACKS.encode(), ("run", "{}", *SHORT)),
        ("study", "study.toml", STUDY, (TARGET, "{}/study.toml")),
        ("criteria", "criteria.toml", CRITERION, CRITERIA),
        ("sumo", "town.rou.xml", b"", TOWN),
    )
    command = [sys.executable, "-c", JUDGED, str(tmp_path_factory.mktemp("right") / "cases"), repr(right)]
    done = subprocess.run(
        command, cwd=ROOT, env=source_environment(), capture_output=True, text=True, check=True
    )
    found: dict[str, list[str]] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize("kind", ["scenario", "tracks", "study", "criteria", "sumo"])
def test_files_without_a_mistake_are_taken(kind: str, judged: dict[str, list[str]]) -> None:
    assert judged[kind] == ["exit 0", ""]


def test_a_case_that_does_not_behave_is_noticed(tmp_path: Path) -> None:
    prepare(tmp_path)
    never = Case("sumo", "town.rou.xml", b"<routes/>", ("no-such-command",))
    assert judge(never, tmp_path) == ("exit 2", "")
    wrong = Case("study", "study.toml", b"", (TARGET,))
    ending, what = judge(wrong, tmp_path)
    assert (ending, what) == ("exit 70", "a code that no command has")
