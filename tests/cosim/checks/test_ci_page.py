"""docs/ci.md: its jobs are YAML and its criteria can be read; tests/documentation runs its commands."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml  # type: ignore[import-untyped]

from analysis.criteria.reading import read_criteria
from tests.cosim.batches.studies import rows

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs/ci.md").read_text()
NO_RUN = re.compile(r" # no-run: \w+")


def blocks(kind: str) -> list[str]:
    return re.findall(rf"```{kind}\n(.*?)```", PAGE, re.DOTALL)


def jobs() -> list[dict[str, Any]]:
    _, github, gitlab = (yaml.safe_load(text) for text in blocks("yaml"))
    return [github["jobs"]["crossings"], gitlab["crossings"]]


def lines(job: dict[str, Any]) -> list[str]:
    """Return the commands of a job, of either system."""
    steps = [step["run"] for step in job.get("steps", []) if "run" in step]
    return [*steps, *job.get("before_script", []), *job.get("script", [])]


def test_each_job_checks_something_and_says_why_other_lines_are_not_run_here() -> None:
    for job in jobs():
        assert any(line.startswith("cosim check") for line in lines(job))
        for line in lines(job):
            assert line.startswith("cosim ") or NO_RUN.search(line), line


def test_every_criterion_that_the_page_shows_can_be_read() -> None:
    found = [one for text in blocks("toml") for one in read_criteria(tomllib.loads(text)["criteria"])]
    assert {one.scope for one in found} == {"encounter", "run", "configuration"}


def test_the_number_of_encounters_for_the_bound_is_right() -> None:
    from analysis.statistics.intervals import share_upper_bound

    (needed,) = map(int, re.findall(r"at least (\d+) entered encounters without any collision", PAGE))
    bounds = [share_upper_bound(0, trials) for trials in (needed - 1, needed)]
    assert bounds[0] is not None
    assert bounds[1] is not None
    assert bounds[1] < 0.01 <= bounds[0]


def test_the_action_has_the_inputs_that_the_page_gives_it() -> None:
    action = yaml.safe_load((ROOT / "action.yml").read_text("utf-8"))
    first = yaml.safe_load(blocks("yaml")[0])
    (step,) = [one for one in first["jobs"]["crossings"]["steps"] if "with" in one]
    assert set(step["with"]) <= set(action["inputs"])
    assert {name for name, one in action["inputs"].items() if one["required"]} <= set(step["with"])
    (check,) = [one for one in action["runs"]["steps"] if one.get("id") == "check"]
    script = (ROOT / ".ci/action").read_text("utf-8")
    assert [name for name in check["env"] if name not in script] == []
    assert all("shell" in one for one in action["runs"]["steps"] if "run" in one)


@pytest.mark.long
@pytest.mark.sumo
@pytest.mark.skipif(os.name != "posix", reason="the shim for the command is a shell script")
def test_the_action_checks_reports_and_tells_the_exit_code(tmp_path: Path) -> None:
    shim = tmp_path / "bin/cosim"
    shim.parent.mkdir()
    shim.write_text(f'#!/bin/sh\nexec {sys.executable} -m cosim.cli "$@"\n')
    shim.chmod(0o755)
    environment = {
        **os.environ,
        "PATH": f"{shim.parent}:{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "TARGET": "suite:fmvss127",
        "CONTROLLER": "aeb",
        "ARGUMENTS": "--filter crossing_right_25_30kmh --jobs 1",
        "OUT": "out",
        "GITHUB_OUTPUT": str(tmp_path / "output"),
    }
    subprocess.run([ROOT / ".ci/action"], cwd=tmp_path, env=environment, check=True, timeout=300)
    assert (tmp_path / "output").read_text() == "exit-code=0\n"
    assert {row["controller"] for row in rows(tmp_path / "out" / "criteria.csv")} == {"aeb"}
    for name in ("junit.xml", "criteria.csv", "report.html"):
        assert (tmp_path / "out" / name).is_file()
