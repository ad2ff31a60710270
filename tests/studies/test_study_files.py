"""The study files of this repository name what exists, and make names them; nothing of it is installed."""

from __future__ import annotations

import importlib.util
import re
import tomllib
from fnmatch import fnmatch
from pathlib import Path

import pytest

from cosim.batches.matrix import build_matrix
from cosim.batches.study import read_study

UNPUBLISHED = ("golden", "screenshots")
"""Studies whose numbers nobody is to read."""
ROOT = Path(__file__).resolve().parents[2]
FILES = sorted((ROOT / "studies").rglob("*.toml"))


def test_there_are_studies() -> None:
    assert FILES


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_study_names_scenarios_controllers_and_parameters_that_exist(file: Path) -> None:
    jobs = build_matrix(read_study(file), file).jobs()
    assert len({job.name for job in jobs}) == len(jobs) > 1
    # Seeds that are published are never those that anything was tuned on.
    assert file.stem in UNPUBLISHED or all(job.seed > 9000 for job in jobs)


def test_what_make_runs_of_the_studies_exists() -> None:
    recipes = (ROOT / "Makefile").read_text("utf-8")
    modules = set(re.findall(r"-m (studies[\w.]*)", recipes))
    files = set(re.findall(r"\bstudies/[\w/]+\.\w+", recipes))
    assert {"studies.papers", "studies.crossings.page", "studies.zoo"} <= modules
    assert [name for name in modules if importlib.util.find_spec(name) is None] == []
    assert [name for name in files if not (ROOT / name).is_file()] == []
    # Every study file but the one of README.md has a target.
    unused = {path.relative_to(ROOT).as_posix() for path in FILES} - files
    assert unused == {"studies/crossing_safety.toml"}


def test_the_studies_are_not_installed() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    installed = project["tool"]["setuptools"]["packages"]["find"]["include"]
    assert any(fnmatch("cosim.sumo", pattern) for pattern in installed)
    assert not any(fnmatch("studies.papers", pattern) for pattern in installed)
