"""docs/ci.md: its jobs are YAML and its criteria can be read; tests/documentation runs its commands."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import yaml  # type: ignore[import-untyped]

from analysis.criteria.reading import read_criteria

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "docs/ci.md").read_text()
NO_RUN = re.compile(r" # no-run: \w+")


def blocks(kind: str) -> list[str]:
    return re.findall(rf"```{kind}\n(.*?)```", PAGE, re.DOTALL)


def jobs() -> list[dict[str, Any]]:
    github, gitlab = (yaml.safe_load(text) for text in blocks("yaml"))
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
