"""A check whose runs were altered since: they are invalid, and the others are judged."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cosim.batches.studies import SHORT, rows, write_study
from tests.cosim.cli.commands import ended

pytestmark = pytest.mark.sumo


@pytest.mark.long
def test_a_damaged_run_is_invalid_and_the_others_are_judged(tmp_path: Path) -> None:
    criterion = {"metric": "n_collisions", "operator": "==", "threshold": 0, "scope": "run"}
    study = write_study(tmp_path, set=SHORT)
    with study.open("a") as file:
        file.write("[[criteria]]\n" + "".join(f"{key} = {value!r}\n" for key, value in criterion.items()))
    words = ["check", study, "--out", "out", "--jobs", 1]
    ended(*words, folder=tmp_path)
    (path,) = (tmp_path / "out").glob("*/runs/*seed1*/runs.csv")
    path.write_text(path.read_text().replace("sumo", "vo_mpc"))
    said = f"{path.relative_to(tmp_path)}: has another content than it was written with"
    assert said in ended("verify", "out", code=3, folder=tmp_path).stderr
    assert said in ended(*words, code=3, folder=tmp_path).stderr
    verdicts = tmp_path / "out" / "criteria.csv"
    before = verdicts.read_text()
    verdicts.write_text(before.replace("invalid", "pass"))
    assert "out/criteria.csv: was " in ended("verify", "out", code=3, folder=tmp_path).stderr
    assert "out/criteria.csv: was " in ended("report", "out", code=2, folder=tmp_path).stderr
    verdicts.write_text(before)
    found = {(row["seed"], row["criterion_id"]): row for row in rows(tmp_path / "out" / "criteria.csv")}
    assert {key[0]: row["status"] for key, row in found.items()} == {"1": "invalid", "2": "pass"}
