"""Run folders that several tests use."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.analysis.study.study_tables import two_controllers


@pytest.fixture
def folders(tmp_path: Path) -> list[Path]:
    return two_controllers(tmp_path / "runs")
