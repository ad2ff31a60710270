"""Controllers that end the process or never answer, at their first plan as well as later."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cosim.batches import unruly
from tests.cosim.batches.studies import batch, write_study
from tests.cosim.cli.commands import finished

pytestmark = pytest.mark.sumo


@pytest.mark.long
@pytest.mark.parametrize(
    ("behaviour", "told"),
    [
        ("exit", "SystemExit: enough"),
        ("hang", "took longer than run_timeout_s = 5 s"),
        ("leave", "exit code 5"),
    ],
)
def test_a_batch_whose_controller_fails_at_its_first_plan_is_refused_in_time(
    behaviour: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    unruly.use(tmp_path / "plugin", monkeypatch)
    study = write_study(
        tmp_path,
        controllers=["unruly"],
        seeds="1",
        set={"behaviour": behaviour, "at_s": 0.0, "warmup_s": 2.0, "duration_s": 6.0},
        run_timeout_s=5,
    )
    done = batch(study, "--out", "out", "--jobs", 1, code=2, folder=tmp_path)
    (line,) = done.stderr.strip().splitlines()
    assert line.startswith("cosim: ")
    assert told in line
    assert not (tmp_path / "out" / "runs").exists()


@pytest.mark.parametrize(("at_s", "code"), [(0.0, 2), (3.0, 3)])
def test_a_controller_that_calls_exit_fails_like_any_other(
    at_s: float, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    unruly.use(tmp_path / "plugin", monkeypatch)
    words = ["run", "midblock_zebra", "--controller", "unruly", "--duration-s", 4, "--out", "out"]
    given = ["--set", "behaviour=exit", "--set", f"at_s={at_s}", "--set", "warmup_s=2", "--debug"]
    done = finished(*words, *given, folder=tmp_path)
    assert done.returncode == code, done.stderr
    assert "SystemExit: enough" in done.stderr.strip().splitlines()[-1]
    assert "Traceback (most recent call last)" in done.stderr
    if code == 3:
        description = json.loads((tmp_path / "out" / "run.json").read_text())
        assert not description["valid"]
        assert "SystemExit: enough" in description["invalid_reason"]
        assert (tmp_path / "out" / "egos.parquet").exists()
