"""Configurations that a study asks for and that have no run."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from analysis.files import read_csv
from cosim.batches.study import study_of
from cosim.checks.unstarted import unstarted
from cosim.cli import main

STUDY = """scenarios = ["midblock_zebra"]
controllers = ["constant_speed", "aeb"]
seeds = "1-2"
set = { duration_s = 12.0, warmup_s = 2.0 }
vary = { predictor = ["constant_velocity", "direction_model"] }
sensing = ["perfect", "onboard"]
"""
PAIR = ("midblock_zebra", "aeb")


def test_what_varies_is_known_from_the_runs_of_the_same_pair() -> None:
    study = study_of({"scenarios": ["midblock_zebra"], "controllers": ["aeb"], "seeds": "1"}, "test")
    assert list(unstarted(study, {})) == [(PAIR, {})]
    assert list(unstarted(study, {PAIR: [{}]})) == []
    several = study.model_copy(
        update={"sensing": ["perfect", "onboard", "fused"], "vary": {"gap_s": [1, 2.0], "latency_s": [0.5]}}
    )
    begun = [{"sensing": "perfect", "gap_s": "1"}, {"sensing": "onboard", "gap_s": "1", "latency_s": "0.5"}]
    assert list(unstarted(several, {PAIR: begun})) == [
        (PAIR, {"sensing": "perfect", "gap_s": "2.0"}),
        (PAIR, {"sensing": "onboard", "gap_s": "2.0", "latency_s": "0.5"}),
        (PAIR, {"sensing": "fused"}),
    ]


@pytest.mark.long
@pytest.mark.sumo
def test_a_batch_from_which_a_configuration_is_missing_is_not_called_whole(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(STUDY)
    batch, criteria = tmp_path / "batch", tmp_path / "criteria.toml"
    assert main(["batch", str(tmp_path / "study.toml"), "--out", str(batch), "--jobs", "1"]) == 0
    criteria.write_text(
        '[[criteria]]\nscope = "run"\nmetric = "n_collisions"\noperator = "<="\nthreshold = 99\n'
    )
    words = [
        "check",
        "--results",
        str(batch),
        "--criteria",
        str(criteria),
        "--out",
        str(tmp_path / "checked"),
    ]
    assert main(words) == 0
    for run in (batch / "runs").glob("*aeb*onboard*direction_model*"):
        shutil.rmtree(run)
    assert main(words) == 3
    missing = [row for row in read_csv(tmp_path / "checked/criteria.csv") if row["note"] == "was not made"]
    assert {row["seed"] for row in missing} == {"1", "2"}
    assert {row["configuration"] for row in missing} == {"aeb sensing=onboard predictor=direction_model"}
