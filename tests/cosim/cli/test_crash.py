"""A crash inside SUMO ends a run, not what it had recorded."""

from __future__ import annotations

import errno
import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from cosim.recording.parquet_sink import ParquetSink, recover

DISTURBED = """
import errno, importlib, json, os, resource, signal, sys
from pathlib import Path
from cosim.cli import main
from cosim.processes import LOADED
from cosim.sumo.world import SumoWorld
step = SumoWorld._step
def crash():
    os.kill(os.getpid(), signal.SIGSEGV)
def fail_without_a_word():
    os._exit(1)
def find_no_memory_to_finish():
    from cosim.running import simulation
    def fail(*_):
        raise MemoryError
    simulation._finish = fail
    raise MemoryError
def fail_in_the_interpreter():
    from cosim.running import simulation
    def fail(*_):
        raise SystemError("error return without exception set")
    simulation._finish = fail
    raise MemoryError
def find_no_memory_for_the_last_files():
    from cosim.running import simulation
    def fail(folder):
        raise OSError(errno.ENOMEM, "Cannot allocate memory")
    simulation.seal_recording = fail
    raise MemoryError
def forbid_more_memory():
    with open("/proc/self/statm") as file:
        size = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (size, resource.RLIM_INFINITY))
def disturbed_run(folder, after, how):
    def disturbed(self):
        if self._time > after:
            globals()[how]()
        step(self)
    SumoWorld._step = disturbed
    sys.argv = ["cosim", "run", "midblock_zebra", "--controller", "aeb", "--out", folder]
    sys.argv += ["--set", "warmup_s=2", "--set", "ego_headway_s=2"]
    sys.exit(main())
"""
ONE = DISTURBED + "disturbed_run(sys.argv[1], int(sys.argv[2]), sys.argv[3])"
EACH = (
    DISTURBED
    + """
for name in LOADED:
    importlib.import_module(name)
for folder, after, how in json.loads(sys.argv[1]):
    child = os.fork()
    if child == 0:
        os.dup2(os.open(Path(folder, "stderr"), os.O_WRONLY | os.O_CREAT), 2)
        disturbed_run(folder + "/out", after, how)
    _, status = os.waitpid(child, 0)
    Path(folder, "code").write_text(str(os.waitstatus_to_exitcode(status)))
"""
)
"""One run after the other, each in a copy of a process that has loaded what they need."""


LATE = 12
"""Five egos have been recorded for so long that the first 256 rows are written [s]."""
CRASHES = [
    (LATE, "crash", True, "SIGSEGV"),
    (2, "crash", False, "SIGSEGV"),
    (LATE, "fail_without_a_word", True, "could not report"),
    (LATE, "fail_in_the_interpreter", True, "could not report"),
    (LATE, "find_no_memory_to_finish", True, "want of memory"),
    (LATE, "find_no_memory_for_the_last_files", True, "want of memory"),
]
Crashed = Callable[[int, str], tuple[Path, int, str]]


@pytest.fixture(scope="module")
def crashed(tmp_path_factory: pytest.TempPathFactory) -> Crashed:
    """Make all runs that crash; return of one its folder, the exit code and the text of standard error."""
    folder = tmp_path_factory.mktemp("crashed")
    kinds = [(str(folder / f"{how}-{after}"), after, how) for after, how, *_ in CRASHES]
    for place, *_ in kinds:
        Path(place).mkdir()
    words = [sys.executable, "-c", EACH, json.dumps(kinds)]
    subprocess.run(words, check=True, timeout=300, stdout=subprocess.DEVNULL)

    def found(after: int, how: str) -> tuple[Path, int, str]:
        run = folder / f"{how}-{after}"
        return run / "out", int((run / "code").read_text()), (run / "stderr").read_text()

    return found


@pytest.mark.long
@pytest.mark.sumo
@pytest.mark.parametrize(("after", "how", "recorded", "told"), CRASHES)
def test_a_crash_of_the_process_is_one_line_and_keeps_the_recording(
    crashed: Crashed, after: int, how: str, recorded: bool, told: str
) -> None:
    out, code, errors = crashed(after, how)
    assert code == 3
    (line,) = [one for one in errors.splitlines() if one.startswith("cosim:")]
    assert told in line
    assert "Traceback" not in errors
    description = json.loads((out / "run.json").read_text())
    assert description["valid"] is False
    assert told in description["invalid_reason"]
    assert not list(out.glob("*.part"))
    assert (pq.read_table(out / "egos.parquet").num_rows > 100) is recorded


@pytest.mark.long
@pytest.mark.sumo
def test_a_run_without_enough_memory_is_one_line_and_keeps_the_recording(tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = [sys.executable, "-c", ONE, str(out), str(LATE), "forbid_more_memory"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 3
    (line,) = [one for one in done.stderr.splitlines() if one.startswith("cosim:")]
    assert "internal error" not in line
    assert "Traceback" not in done.stderr
    assert json.loads((out / "run.json").read_text())["valid"] is False
    assert pq.read_table(out / "egos.parquet").num_rows > 100


@pytest.mark.parametrize(("raised", "told"), [("MemoryError", False), ("ValueError", True)])
def test_a_destructor_without_memory_is_not_told_of_beside_the_end_of_the_run(
    raised: str, told: bool
) -> None:
    program = f"""
import os
from cosim.cli.apart import Inside, begin
class Held:
    def __del__(self):
        raise {raised}
if isinstance(begin(), Inside):
    Held()
    os._exit(0)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert (raised in done.stderr) is told


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


@pytest.mark.parametrize(
    ("failure", "told"),
    [
        (OSError("ZSTD compression failed: Allocation error : not enough memory"), MemoryError),
        (OSError(errno.ENOSPC, "No space left on device"), OSError),
    ],
)
def test_a_table_without_memory_to_finish_it_stays_a_part_and_is_not_taken_for_one_without_room(
    failure: OSError, told: type[Exception], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise failure

    sink = ParquetSink(tmp_path / "t.parquet", pa.schema([("number", pa.int64())]))
    sink.add_row((7,))
    with monkeypatch.context() as patch:
        patch.setattr(pq.ParquetWriter, "write_table", fails)
        with pytest.raises(told, match=re.escape(str(failure))):
            sink.close()
    assert [path.name for path in tmp_path.iterdir()] == ["t.parquet.part"]
    recover(tmp_path / "t.parquet.part")
    assert pq.read_table(tmp_path / "t.parquet")["number"].to_pylist() == [7]
