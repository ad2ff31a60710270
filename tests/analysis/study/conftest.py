"""Run folders that several tests use."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.study.writing import write_tables
from tests.analysis.study.study_tables import Cells, read, two_controllers


@pytest.fixture
def folders(tmp_path: Path) -> list[Path]:
    return two_controllers(tmp_path / "runs")


@pytest.fixture(scope="package")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the tables of :func:`two_controllers`, to be read only."""
    place = tmp_path_factory.mktemp("study")
    write_tables(place / "out", two_controllers(place / "runs"), None)
    return place / "out"


@pytest.fixture(scope="package")
def two_controllers_tables(written: Path) -> tuple[list[Cells], list[Cells]]:
    """Return the rows of configs.csv and comparisons.csv there."""
    return read(written / "configs.csv"), read(written / "comparisons.csv")
