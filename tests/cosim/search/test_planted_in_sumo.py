"""A controller given by its address has planted faults: a search in SUMO finds them, and nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.files import read_csv
from benchmarks.measuring import planted_driver
from cosim.cli import main

VOLUME = 0.02
NUMBERS = tuple(one.name for one in planted_driver.AXES)


def test_the_boxes_have_the_volume_that_was_asked_for_and_are_inside_the_space() -> None:
    centres, half = planted_driver.boxes(VOLUME, 1)
    assert len(centres) == 3
    assert 3 * (2.0 * half) ** 3 == pytest.approx(VOLUME)
    assert all(half <= at <= 1.0 - half for one in centres for at in one.values())
    middle = {
        axis.name: axis.value(at) for axis, at in zip(planted_driver.AXES, centres[0].values(), strict=True)
    }
    assert planted_driver.outside((centres, half), middle)[0] == pytest.approx(-half, abs=1e-3)


@pytest.mark.slow
@pytest.mark.sumo
def test_planted_faults_are_found_in_sumo_and_every_failure_is_one_of_them(tmp_path: Path) -> None:
    (tmp_path / "space.toml").write_text(planted_driver.SPACE)
    (tmp_path / "criteria.toml").write_text(planted_driver.CRITERIA)
    out = tmp_path / "found"
    words = ["falsify", "jaywalk_arterial", "--controller", planted_driver.__file__, "--budget", "80"]
    words += ["--space", str(tmp_path / "space.toml"), "--criteria", str(tmp_path / "criteria.toml")]
    words += ["--set", "vehicles_per_hour=0", "--set", f"volume={VOLUME}", "--no-report", "--no-shrink"]
    assert main([*words, "--jobs", "2", "--out", str(out)]) == 0
    planted = planted_driver.boxes(VOLUME, 1)
    failures = read_csv(out / "failures.csv")
    assert failures
    for row in failures:
        point = {name: float(row[name]) for name in NUMBERS}
        assert min(planted_driver.outside(planted, point)) <= planted_driver.MEASURED
    # A file must not have code executed that the command does not name.
    again = ["check", str(out / "failures"), "--out", str(tmp_path / "again")]
    assert main(again) == 2
    assert main([*again, "--controller", planted_driver.__file__]) == 1
