"""What searches have found stays runnable; cosim check says whether it is mended."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim.batches.matrix import build_matrix
from cosim.batches.study import read_study
from cosim.cli import main
from sumo_scenarios import library

SUITES = sorted(Path(__file__).parent.glob("*/*.toml"))


@pytest.mark.parametrize("suite", SUITES, ids=lambda file: f"{file.parent.name}-{file.stem}")
def test_every_found_failure_is_a_scenario_with_criteria_and_a_pedestrian(suite: Path) -> None:
    configurations = build_matrix(read_study(suite), suite).configurations
    assert {one.scenario_name for one in configurations} <= {path.name for path in suite.parent.iterdir()}
    for one in configurations:
        scenario = library.load(one.place)
        assert scenario.table is not None
        assert scenario.table.criteria
        assert [each.name for each in scenario.pedestrians] == ["met"]
        assert scenario.duration_s - scenario.warmup_s <= 30.0


def test_every_folder_is_in_a_suite() -> None:
    named = {name for suite in SUITES for name in read_study(suite).scenarios}
    folders = {path.parent.name for path in Path(__file__).parent.glob("*/*/scenario.toml")}
    assert folders == named
    assert folders


@pytest.mark.long
@pytest.mark.sumo
def test_what_is_mended_stays_mended(tmp_path: Path) -> None:
    suite = Path(__file__).parent / "vo_mpc" / "seed-9301.toml"
    assert main(["check", str(suite), "--out", str(tmp_path / "check")]) == 0
