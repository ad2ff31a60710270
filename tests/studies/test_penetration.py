"""The page of the penetration study, on two short runs in SUMO."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from analysis.errors import StudyError
from analysis.files import read_csv
from analysis.study.runs import find_run_folders, read_runs
from studies.penetration.outcomes import ALL, EGOS, OTHERS, outcomes
from studies.penetration.page import write_page
from tests.cosim.batches.studies import batch, write_study


@pytest.mark.long
@pytest.mark.sumo
def test_the_page_splits_egos_and_others_over_the_share(tmp_path: Path) -> None:
    study = write_study(
        tmp_path,
        controllers=["aeb"],
        seeds="1",
        record="everybody",
        set={"warmup_s": 10, "duration_s": 50, "vehicles_per_hour": 900, "pedestrians_per_hour": 900},
        vary={"ego_share": [0.0, 0.5]},
    )
    batch(study, "--out", "out", "--jobs", 2, folder=tmp_path)
    found = outcomes(read_runs(find_run_folders(tmp_path / "out")))
    assert [one.share for one in found] == [0.0, 0.5]
    nobody, half = (one.values for one in found)
    met = [row for row in read_csv(tmp_path / "out" / "traffic_encounters.csv") if row["entered"] == "1"]
    hours = 40.0 / 3600.0
    assert nobody["met", ALL] + half["met", ALL] == pytest.approx(len(met) / hours, rel=0.01)
    assert nobody["met", EGOS] == 0.0
    assert math.isnan(nobody["conflicts", EGOS])
    assert half["met", EGOS] + half["met", OTHERS] == pytest.approx(half["met", ALL])
    assert 0.0 < half["met", EGOS] < half["met", ALL]
    for values in (nobody, half):
        assert values["throughput", ALL] > 0.0
        assert 0.0 < values["vehicle_delay", ALL] < 300.0
        assert values["ped_delay", ALL] >= 0.0
    page = tmp_path / "page.md"
    write_page(tmp_path / "out", page)
    told = page.read_text("utf-8")
    assert "### `midblock_zebra`" in told
    assert "#### Conflicts, serious or worse [per 100 encounters]" in told
    assert "| 0.5 | 1 |" in told
    assert (tmp_path / "page-midblock_zebra.svg").is_file()


def test_a_folder_without_runs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="no runs"):
        write_page(tmp_path, tmp_path / "page.md")
