"""The files that a run leaves: what a run that is told to end keeps, and the same ones each time."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from analysis.manifest import MANIFEST, read_manifest
from tests.cosim.cli.commands import command, ended, source_environment

pytestmark = [pytest.mark.sumo, pytest.mark.long]

SOME_ROWS_BYTES = 50_000
"""A recording of this size has more than the names of its columns."""
OF_THE_WALL_CLOCK = ("timing.parquet", "run.json", "runs.csv")
"""Files of a run that hold times of this machine; the hashes in files.json follow."""


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_run_that_is_told_to_end_keeps_what_it_has(tmp_path: Path) -> None:
    alone = ["--set", "vehicles_per_hour=0", "--set", "pedestrians_per_hour=0", "--set", "warmup_s=1"]
    settings = [*alone, "--set", "ego_count=500", "--set", "ego_headway_s=2", "--duration-s", "100000"]
    process = subprocess.Popen(
        command("run", "midblock_zebra", "--controller", "sumo", "--out", "out", *settings),
        stderr=subprocess.PIPE,
        env=source_environment(),
    )
    part = tmp_path / "out" / "egos.parquet.part"
    deadline = time.monotonic() + 120.0
    while not (part.exists() and part.stat().st_size > SOME_ROWS_BYTES) and time.monotonic() < deadline:
        time.sleep(0.1)
    process.send_signal(signal.SIGTERM)
    _, errors = process.communicate(timeout=60.0)
    assert process.returncode == 3, errors
    assert b"interrupted" in errors
    assert json.loads((tmp_path / "out" / "run.json").read_text())["invalid_reason"] == "interrupted"
    assert pq.read_metadata(tmp_path / "out" / "egos.parquet").num_rows > 0


def test_the_same_command_twice_gives_the_same_files(tmp_path: Path) -> None:
    arguments = ["midblock_unmarked", "--controller", "vo_mpc", "--seed", "7", "--set", "warmup_s=20"]
    arguments += ["--duration-s", "15"]
    ended("run", *arguments, "--out", "first")
    # In another process, in which sets are in another order.
    ended("run", *arguments, "--out", "second", environment={})
    names = sorted(path.name for path in (tmp_path / "first").iterdir())
    assert names == sorted(path.name for path in (tmp_path / "second").iterdir())
    assert {"egos.parquet", "neighbours.parquet", "plans.parquet", "map.json", "runs.csv"} <= set(names)
    for name in names:
        first, second = ((tmp_path / folder / name).read_bytes() for folder in ("first", "second"))
        if name not in (*OF_THE_WALL_CLOCK, MANIFEST):
            assert first == second, f"{name} differs"
    sealed = [read_manifest(tmp_path / folder) or {} for folder in ("first", "second")]
    differing = [name for name in names if name != MANIFEST and sealed[0][name] != sealed[1][name]]
    assert set(differing) <= set(OF_THE_WALL_CLOCK)
    assert lasting(tmp_path / "first" / "runs.csv") == lasting(tmp_path / "second" / "runs.csv")
    runs = [json.loads((tmp_path / folder / "run.json").read_text()) for folder in ("first", "second")]
    assert runs[0]["run_id"] == runs[1]["run_id"]


def lasting(path: Path) -> dict[str, str]:
    """Return the single row of a CSV file without its wall-clock columns."""
    with path.open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    return {key: value for key, value in row.items() if not key.startswith(("wall_", "compute_"))}
