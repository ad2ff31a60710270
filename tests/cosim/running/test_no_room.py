"""Where there is no room for files: one line, and no name for anything that is not there or not whole."""

from __future__ import annotations

import re
import resource
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from analysis.arrays import FloatArray
from cosim.recording.parquet_sink import ParquetSink
from tests.cosim.batches.studies import write_study
from tests.cosim.cli.commands import ended

SCHEMA = pa.schema([("a", pa.float64())])
SHORT = ("--controller", "sumo", "--set", "warmup_s=2")


@contextmanager
def room(size: int) -> Iterator[None]:
    """Let no file of this process, or of those that it starts, become larger than so many bytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def write_table(path: Path, pieces: Iterable[FloatArray]) -> None:
    sink = ParquetSink(path, SCHEMA)
    try:
        for piece in pieces:
            sink.add_columns([piece])
    finally:
        sink.close()


def full_names(text: str) -> list[str]:
    return re.findall(r"/[\w./*-]+", text)


@pytest.mark.parametrize("size", [100, 50_000, 79_000])
def test_a_table_of_which_rows_are_missing_does_not_get_its_name(size: int, tmp_path: Path) -> None:
    numbers = np.random.default_rng(1).random(10_000)
    with room(size), pytest.raises(OSError, match="File too large"):
        write_table(tmp_path / "x.parquet", np.split(numbers, 10))
    assert [path.name for path in tmp_path.iterdir()] == ["x.parquet.part"]


def test_a_table_whose_part_was_cut_short_does_not_get_its_name(tmp_path: Path) -> None:
    sink = ParquetSink(tmp_path / "x.parquet", SCHEMA, rows_per_chunk=100)
    for piece in np.split(np.arange(1000.0), 10):
        sink.add_columns([piece])
    part = tmp_path / "x.parquet.part"
    part.write_bytes(part.read_bytes()[:4000])
    with pytest.raises(OSError, match="cut short"):
        sink.close()
    assert [path.name for path in tmp_path.iterdir()] == ["x.parquet.part"]


@pytest.mark.sumo
def test_a_run_that_cannot_begin_to_record_leaves_nothing(tmp_path: Path) -> None:
    # SUMO's input fits; run.json does not, or the description of a table's columns.
    for size in (2000, 3000):
        with room(size):
            done = ended("run", "suite:unr157/crossing_5kmh", "--out", tmp_path / "out", code=3)
        assert done.stderr == "cosim: the recording could not be written: File too large\n"
        assert not (tmp_path / "out").exists()


@pytest.mark.sumo
def test_a_run_that_has_no_room_for_its_input_says_so(tmp_path: Path) -> None:
    with room(0):
        done = ended("run", "midblock_zebra", *SHORT, "--out", tmp_path / "out", code=2)
    assert done.stderr == "cosim: the run's input cannot be prepared: [Errno 27] File too large\n"


@pytest.mark.sumo
def test_a_run_whose_recording_has_no_room_says_so(tmp_path: Path) -> None:
    with room(20_000):
        ended("run", "midblock_zebra", *SHORT, "--duration-s", 38, "--out", tmp_path / "out", code=3)
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"run.json", "neighbours.parquet.part"} <= names
    assert not {"neighbours.parquet", "encounters.csv"} & names
    assert not [name for name in names if name.endswith(".new")]
    assert "the recording could not be written: File too large" in (tmp_path / "out" / "run.json").read_text()


@pytest.mark.sumo
def test_an_analysis_that_has_no_room_names_no_file_that_is_not_there(tmp_path: Path) -> None:
    with room(40_000):
        done = ended("run", "midblock_zebra", *SHORT, "--duration-s", 2, "--out", tmp_path / "out", code=3)
    assert done.stderr == f"cosim: {tmp_path / 'out'} could not be analysed: File too large\n"


@pytest.mark.long
@pytest.mark.sumo
def test_a_batch_without_room_names_only_files_that_exist(tmp_path: Path) -> None:
    study = write_study(tmp_path, seeds="1")
    with room(20_000):
        # In a process of its own: the one that worker processes come from lives on, without room.
        arguments = ("batch", study, "--out", tmp_path / "out", "--jobs", 1)
        done = ended(*arguments, code=3, environment={"NO_ROOM": "1"})
    assert "File too large" in done.stderr
    names = [Path(name) for name in full_names(done.stdout + done.stderr)]
    assert study in names
    for path in names:
        assert path.exists() or list(path.parent.glob(path.name)), done.stdout + done.stderr
