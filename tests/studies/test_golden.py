"""The comparison of two versions' runs finds what differs, by value."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pandas as pd
import pytest

import controllers.catalog
import sumo_scenarios.library
from studies.golden import differences

STUDY = Path(__file__).resolve().parents[2] / "studies/golden.toml"


def _batch(folder: Path, version: str, **columns: list[float]) -> Path:
    run = folder / "runs" / f"zebra-aeb-seed1-{version}"
    run.mkdir(parents=True)
    pd.DataFrame({"run_id": [version], **columns}).to_csv(run / "encounters.csv", index=False)
    return folder


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"ttc_s": [1.0], "pet_s": [2.0]}, []),
        ({"new": [1.0], "pet_s": [2.0], "ttc_s": [1.0]}, []),
        ({"ttc_s": [1.5], "pet_s": [2.0]}, ["other ttc_s"]),
        ({"ttc_s": [1.0]}, ["without pet_s"]),
    ],
)
def test_what_differs_is_named(tmp_path: Path, columns: dict[str, list[float]], said: list[str]) -> None:
    before = _batch(tmp_path / "before", "a1", ttc_s=[1.0], pet_s=[2.0])
    lines = differences(before, _batch(tmp_path / "after", "b2", **columns))
    assert [line.partition(": ")[2] for line in lines] == said


def test_a_run_that_is_missing_is_named(tmp_path: Path) -> None:
    before = _batch(tmp_path / "before", "a1", ttc_s=[1.0])
    (tmp_path / "after" / "runs").mkdir(parents=True)
    assert differences(before, tmp_path / "after") == [f"zebra-aeb-seed1: only in {before}"]


def test_every_controller_drives_in_every_scenario() -> None:
    study = tomllib.loads(STUDY.read_text("utf-8"))
    assert study["controllers"] == sorted(controllers.catalog.names())
    assert study["scenarios"] == sorted(sumo_scenarios.library.names())
