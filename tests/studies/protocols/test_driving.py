"""Suites driven in SUMO, and the table of their verdicts."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies.protocols.driving import Driven, drive
from studies.protocols.page import write_page


@pytest.mark.long
@pytest.mark.sumo
def test_cases_run_in_worker_processes_are_judged_and_resumed(tmp_path: Path) -> None:
    def driven() -> Driven:
        controllers = ("constant_speed", "aeb")
        return drive(("fmvss127",), controllers, tmp_path / "out", "stationary_[12]0kmh", jobs=1)

    found = driven()
    assert found.exit_code == 1
    assert {(row.controller, row.case): row.verdict and row.verdict.passed for row in found.rows} == {
        ("constant_speed", "stationary_10kmh"): False,
        ("constant_speed", "stationary_20kmh"): False,
        ("aeb", "stationary_10kmh"): True,
        ("aeb", "stationary_20kmh"): True,
    }
    assert [row.note for row in found.rows] == [""] * 4
    (file,) = found.files
    written = file.read_bytes()
    made = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").glob("*/runs/*/run.json")}
    assert len(made) == 4
    assert driven().rows == found.rows
    assert file.read_bytes() == written
    assert {path: path.stat().st_mtime_ns for path in made} == made
    write_page(tmp_path / "out", tmp_path / "page.md")
    assert "| `aeb` | 2 of 2 |" in (tmp_path / "page.md").read_text("utf-8")
