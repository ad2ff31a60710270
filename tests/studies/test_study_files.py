"""The study files of this repository name what exists."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim.batch.matrix import build_matrix
from cosim.batch.study import read_study

UNPUBLISHED = ("golden", "screenshots")
"""Studies whose numbers nobody is to read."""
FILES = sorted((Path(__file__).resolve().parents[2] / "studies").rglob("*.toml"))


def test_there_are_studies() -> None:
    assert FILES


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_study_names_scenarios_controllers_and_parameters_that_exist(file: Path) -> None:
    jobs = build_matrix(read_study(file), file).jobs()
    assert len({job.name for job in jobs}) == len(jobs) > 1
    # Seeds that are published are never those that anything was tuned on.
    assert file.stem in UNPUBLISHED or all(job.seed > 9000 for job in jobs)
