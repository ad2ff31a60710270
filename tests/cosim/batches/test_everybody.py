"""Batches whose runs record everybody."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.results.traffic_rows import SUMO
from tests.cosim.batches.studies import batch, refused, rows, runs, write_study
from tests.cosim.cli.commands import ended

TRAFFIC = "traffic_encounters.csv"


@pytest.mark.long
@pytest.mark.sumo
def test_the_traffic_of_all_runs_is_in_one_table_at_any_share_of_egos(tmp_path: Path) -> None:
    study = write_study(
        tmp_path,
        controllers=["aeb"],
        seeds="1",
        record="everybody",
        set={"warmup_s": 2, "duration_s": 40, "vehicles_per_hour": 900, "pedestrians_per_hour": 900},
        vary={"ego_share": [0, 0.5]},
    )
    batch(study, "--out", "out", "--jobs", 2, folder=tmp_path)
    out = tmp_path / "out"
    together = rows(out / TRAFFIC)
    one_by_one = [row for name in runs(out) for row in rows(out / "runs" / name / TRAFFIC)]
    key = ("run_id", "traffic_encounter_id")
    assert sorted(together, key=lambda row: [row[name] for name in key]) == sorted(
        one_by_one, key=lambda row: [row[name] for name in key]
    )
    drivers = {(row["controller"], row["is_ego"]) for row in together}
    assert drivers == {("aeb", "1"), (SUMO, "0")}
    resources = (out / "datapackage.json").read_text("utf-8")
    assert '"traffic_encounters"' in resources
    ended("verify", out)
    (out / TRAFFIC).write_text("altered")
    assert TRAFFIC in ended("verify", out, code=3).stderr


def test_whom_a_run_can_record_is_said(tmp_path: Path) -> None:
    told = refused(write_study(tmp_path, record="all"), "--out", tmp_path / "out")
    assert "record: expected egos or everybody, got 'all'" in told
    told = refused(write_study(tmp_path, set={"ego_share": 0}), "--out", tmp_path / "out")
    assert "--ego-share 0: a run without egos has to record everybody" in told
