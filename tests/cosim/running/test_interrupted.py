"""Ctrl-C, once or again and again, at a run's end loses nothing that was recorded."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

import cosim
from cosim.recording import parquet_sink

pytestmark = pytest.mark.sumo
SHORT: dict[str, Any] = {"duration_s": 8.0, "warmup_s": 5.0, "ego_headway_s": 5.0}
TABLES = ["egos", "neighbours", "plans", "timing", "traffic"]


def interrupted(folder: Path, after_s: float, **parameters: Any) -> cosim.Run:
    """Make a run that is interrupted after a time, and return what it left."""

    def interrupt(now: float, _: float | None) -> None:
        if now > after_s:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        cosim.run(
            "midblock_zebra",
            controller="sumo",
            record="everybody",
            out=folder,
            progress=interrupt,
            **SHORT,
            **parameters,
        )
    assert sorted(path.stem for path in folder.glob("*.parquet")) == TABLES
    assert not list(folder.glob("*.part"))
    run = cosim.load(folder)
    assert isinstance(run, cosim.Run)
    return run


@pytest.fixture
def interrupt_while_tables_are_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parquet_sink, "_convert", after_ctrl_c(parquet_sink._convert))


def after_ctrl_c(function: Callable[..., None]) -> Callable[..., None]:
    def disturbed(*arguments: Any) -> None:
        signal.raise_signal(signal.SIGINT)
        function(*arguments)

    return disturbed


@pytest.mark.usefixtures("interrupt_while_tables_are_made")
def test_a_second_ctrl_c_while_the_tables_are_made_loses_none(tmp_path: Path) -> None:
    run = interrupted(tmp_path / "run", 7.0)
    assert (run.valid, run.invalid_reason) == (False, "interrupted")
    times = pq.read_table(tmp_path / "run" / "egos.parquet")["time_s"].to_pylist()
    assert (times[0], times[-1]) == pytest.approx((5.1, 7.1), abs=0.11)
    assert (tmp_path / "run" / "map.json").exists()
    assert (tmp_path / "run" / "encounters.csv").exists()


@pytest.mark.usefixtures("interrupt_while_tables_are_made")
def test_a_run_that_was_over_before_ctrl_c_is_whole(tmp_path: Path) -> None:
    run = interrupted(tmp_path / "run", float("inf"))
    assert run.valid
    assert run.description["duration_s"] == SHORT["duration_s"]
