"""A crash inside SUMO ends a run, not what it had recorded."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from cosim.recording.parquet_sink import ParquetSink, recover

CRASHING = """
import os, signal, sys
from cosim.sumo.world import SumoWorld
step = SumoWorld._step
def crash(self):
    if self._time > {after}:
        os.kill(os.getpid(), signal.SIGSEGV)
    step(self)
SumoWorld._step = crash
sys.argv = ["cosim", "run", "midblock_zebra", "--controller", "aeb", "--set", "warmup_s=20", "--out", "{out}"]
from cosim.cli import main
sys.exit(main())
"""


@pytest.mark.sumo
@pytest.mark.parametrize(("after", "recorded"), [(55, True), (2, False)])
def test_a_crash_of_the_process_is_one_line_and_keeps_the_recording(
    tmp_path: Path, after: int, recorded: bool
) -> None:
    out = tmp_path / "out"
    command = [sys.executable, "-c", CRASHING.format(after=after, out=out)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 3
    (line,) = [one for one in done.stderr.splitlines() if one.startswith("cosim:")]
    assert "SIGSEGV" in line
    assert "Traceback" not in done.stderr
    description = json.loads((out / "run.json").read_text())
    assert description["valid"] is False
    assert "SIGSEGV" in description["invalid_reason"]
    assert not list(out.glob("*.part"))
    assert (pq.read_table(out / "egos.parquet").num_rows > 100) is recorded


def test_what_was_written_of_a_table_can_be_recovered(tmp_path: Path) -> None:
    schema = pa.schema([("number", pa.int64())])
    sink = ParquetSink(tmp_path / "t.parquet", schema, rows_per_chunk=64)
    for number in range(101):
        sink.add_row((number,))
    part = tmp_path / "t.parquet.part"
    part.write_bytes(part.read_bytes()[:-20])  # the process ended while it wrote
    recover(part)
    found = pq.read_table(tmp_path / "t.parquet")["number"].to_pylist()
    assert found == list(range(len(found)))
    assert 90 <= len(found) <= 101
