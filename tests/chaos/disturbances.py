"""What is done to a batch while it runs, or to its folder between its stop and its being resumed."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import psutil  # type: ignore[import-untyped]

from tests.cosim.batches.disturbing import SMALL_DISK_OUT, can_mount, on_small_disk, workers
from tests.cosim.cli.commands import command, source_environment
from tests.limits import LARGEST_FILE, limit

MOST_MEMORY = 8 << 30
"""[bytes]"""
LONGEST_S = 60.0
"""A disturbed batch ends within this time [s]."""
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
OUT = "out"
"""Folder of the batch."""
KEPT = (".lock",)
"""Files without a content."""


@dataclass(frozen=True, slots=True)
class Disturbed:
    """How a disturbed batch ended."""

    what: str
    """The disturbance, in words that repeat it."""
    code: int | None
    """Exit code; ``None``: it did not end."""
    told: str
    """What it wrote to standard error."""
    left: int = 0
    """Processes that lived on."""
    damaged: Path | None = None
    """The file that was altered afterwards."""


def killed(folder: Path, study: Path, drawn: random.Random, lasts_s: float) -> Disturbed:
    """Send a signal to the batch or to one of its workers at some moment."""
    number, to_parent = drawn.choice(SIGNALS), drawn.random() < 0.5
    moment = drawn.uniform(0.0, lasts_s)
    process = _started(folder, _batch(study))
    time.sleep(moment)
    family, found = _family(process), workers(process.pid)
    target = psutil.Process(process.pid) if to_parent or not found else drawn.choice(found)
    if target.is_running():
        target.send_signal(number)
    whom = "batch" if target.pid == process.pid else "worker"
    return _ended(process, f"{number.name} to the {whom} after {moment:.2f} s", family)


def without_room(folder: Path, study: Path, drawn: random.Random, lasts_s: float) -> Disturbed:
    """Let the disk, or a file, be full at some byte."""
    size = int(2.0 ** drawn.uniform(12.0, 20.5))
    if not can_mount() or drawn.random() < 0.3:
        process, what = _started(folder, _batch(study), size), f"no file larger than {size} bytes"
    else:
        kilobytes = 4 * (max(size // 4096, 1) + 1)  # in whole pages
        words = on_small_disk(_batch(study, SMALL_DISK_OUT), kilobytes, OUT)
        process, what = _started(folder, words), f"a disk of {kilobytes} kB"
    return _ended(process, what, _family(process))


def damaged(folder: Path, study: Path, drawn: random.Random, lasts_s: float) -> Disturbed:
    """Let the batch end early or in time, then cut a file of its folder short, alter a byte of it or lose it."""
    process = _started(folder, _batch(study))
    if drawn.random() < 0.7:
        time.sleep(drawn.uniform(0.5, 1.0) * lasts_s)
        process.send_signal(signal.SIGTERM)
    ended = _ended(process, "stopped before there was a file", _family(process))
    files = sorted(path for path in (folder / OUT).rglob("*") if path.is_file() and path.name not in KEPT)
    if not files:
        return ended
    chosen = drawn.choice(files)
    content = bytearray(chosen.read_bytes())
    how = drawn.choice(("altered", "cut", "lost"))
    where = drawn.randrange(len(content)) if content else 0
    if how == "lost":
        chosen.unlink()
    elif how == "cut" or not content:
        chosen.write_bytes(content[:where])
    else:
        content[where] ^= 1 << drawn.randrange(8)
        chosen.write_bytes(content)
    return replace(ended, what=f"{chosen.relative_to(folder)} {how} at byte {where}", damaged=chosen)


Disturbance = Callable[[Path, Path, random.Random, float], Disturbed]
DISTURBANCES: tuple[Disturbance, ...] = (killed, damaged, without_room)


def _batch(study: Path, out: str = OUT) -> list[str]:
    return command("batch", study, "--out", out, "--jobs", 2)


def _started(folder: Path, words: list[str], largest_file: int = LARGEST_FILE) -> subprocess.Popen[str]:
    return subprocess.Popen(
        words,
        cwd=folder,
        env=source_environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=partial(limit, MOST_MEMORY, largest_file),
    )


def _family(process: subprocess.Popen[str]) -> list[psutil.Process]:
    try:
        parent = psutil.Process(process.pid)
        return [parent, *parent.children(recursive=True)]
    except psutil.NoSuchProcess:
        return []


def _ended(process: subprocess.Popen[str], what: str, family: list[psutil.Process]) -> Disturbed:
    """Wait for the end of a batch and of all its processes; kill what goes on."""
    code: int | None = None
    try:
        _, told = process.communicate(timeout=LONGEST_S)
        code = process.returncode
    except subprocess.TimeoutExpired:
        family = [*family, *_family(process)]
        os.killpg(process.pid, signal.SIGKILL)
        _, told = process.communicate()
    _, alive = psutil.wait_procs(family, timeout=10.0)
    for one in alive:
        one.kill()
    return Disturbed(what, code, told, len(alive))
