"""Why ``vo_ga`` fails a case at 10 km/h: the page on test protocols says so, and here it is driven."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.protocols.impact import Measured, measure
from cosim.running.request import RunRequest
from cosim.running.simulation import run

pytestmark = [pytest.mark.sumo, pytest.mark.slow]

RUNNER = "suite:fmvss127/crossing_left_50_10kmh"
BESIDE = "suite:false_reactions/stops_before_the_lane_20kmh"


def _driven(case: str, folder: Path, **settings: str) -> Measured:
    result = run(RunRequest(case, "vo_ga", settings=settings, out=folder))
    assert result.valid, result.invalid_reason
    return measure(folder)


def test_the_papers_disc_leaves_the_bumper_out_and_one_that_holds_it_the_person_beside_the_lane_in(
    tmp_path: Path,
) -> None:
    impact = _driven(RUNNER, tmp_path / "small").impact
    assert impact is not None
    assert impact.side == "front"
    assert _driven(RUNNER, tmp_path / "large", disc_radius_m="2.5").impact is None
    assert not _driven(BESIDE, tmp_path / "beside").stopped
    assert _driven(BESIDE, tmp_path / "beside_large", disc_radius_m="2.5").stopped


def test_an_emergency_brake_does_without_a_larger_disc(tmp_path: Path) -> None:
    assert _driven(RUNNER, tmp_path / "runner", emergency_brake="true").impact is None
    assert not _driven(BESIDE, tmp_path / "beside", emergency_brake="true").stopped
