"""One process makes one run after the other, and none of them is to be seen in the next."""

from __future__ import annotations

import itertools
import multiprocessing
import os
import sys
import time
from multiprocessing.connection import Connection
from pathlib import Path

import pytest

from cosim import processes
from cosim.batches.outcome import RUN
from cosim.batches.pool import Pool
from cosim.batches.worker import Handling
from tests.cosim.batches.studies import content, some_job

pytestmark = pytest.mark.sumo


@pytest.mark.long
def test_a_run_has_the_same_bytes_as_the_first_and_as_the_last_of_a_process(tmp_path: Path) -> None:
    first = some_job(controller="aeb", duration_s="15")
    other = some_job(controller="vo_mpc", seed=2, pedestrians_per_hour="900", duration_s="8")
    numbers = itertools.count()
    made = []
    with Pool(1, Handling(120.0)) as pool:
        for job in (first, other, first):
            outcome = pool.submit(job, tmp_path / str(next(numbers))).result()
            assert outcome.reason == ""
            made.append(content(outcome.folder / RUN))
    with Pool(1, Handling(120.0)) as pool:
        fresh = pool.submit(first, tmp_path / "fresh").result()
        assert fresh.reason == ""
    assert made[0] == made[2] == content(fresh.folder / RUN)
    assert made[0] != made[1]


def test_a_run_is_not_disturbed_by_a_start_without_a_step_before_it(tmp_path: Path) -> None:
    job = some_job(duration_s="10")
    with Pool(1, Handling(120.0)) as pool:
        alone = pool.submit(job, tmp_path / "alone").result()
    with Pool(1, Handling(120.0)) as pool:
        checked = pool.check(some_job(seed=5, controller="aeb"), start_sumo=True).result()
        assert not isinstance(checked, str)
        after = pool.submit(job, tmp_path / "after").result()
    assert content(alone.folder / RUN) == content(after.folder / RUN)


@pytest.mark.long
def test_a_worker_has_the_variables_that_are_set_when_it_starts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("first", "second"):
        cache = tmp_path / name
        monkeypatch.setenv("COSIM_CACHE_DIR", str(cache))
        with Pool(1, Handling(120.0)) as pool:
            checked = pool.check(some_job(), start_sumo=True).result()
        assert not isinstance(checked, str)
        assert list(cache.rglob("*.net.xml*")), name


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes start otherwise elsewhere")
def test_a_process_starts_with_everything_loaded_that_runs_need() -> None:
    receiver, sender = multiprocessing.Pipe(duplex=False)
    process = processes.context().Process(target=_tell_loaded, args=(sender,))  # type: ignore[attr-defined]
    process.start()
    assert receiver.poll(120.0)
    assert receiver.recv() == [*processes.LOADED]
    process.join()


def _tell_loaded(sender: Connection) -> None:
    sender.send([name for name in processes.LOADED if name in sys.modules])


def test_starting_processes_leaves_the_environment_as_it_was() -> None:
    before = dict(os.environ)
    processes.context()
    assert dict(os.environ) == before


class _ReadSlowly:
    """Something that a process needs a while to read."""

    def __reduce__(self) -> tuple[object, ...]:
        return time.sleep, (1.0,)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes start otherwise elsewhere")
def test_a_process_that_was_started_needs_nothing_of_the_pool_any_more() -> None:
    context = processes.context()
    lock = context.Lock()
    process = context.Process(target=id, args=((_ReadSlowly(), lock),))  # type: ignore[attr-defined]
    process.start()
    del lock  # as a pool that is stopped does
    process.join()
    assert process.exitcode == 0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes start otherwise elsewhere")
def test_a_process_that_ends_before_it_begins_is_not_waited_for() -> None:
    process = processes.context().Process(target=id, args=(_Unreadable(),))  # type: ignore[attr-defined]
    started = time.monotonic()
    process.start()
    process.join()
    assert process.exitcode == 1
    assert time.monotonic() - started < 20.0


class _Unreadable:
    """Something that ends the process that reads it."""

    def __reduce__(self) -> tuple[object, ...]:
        return sys.exit, (1,)
