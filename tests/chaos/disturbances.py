"""What is done to a batch while it runs, or to its folder between its stop and its being resumed."""

from __future__ import annotations

import os
import random
import resource
import shlex
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import psutil  # type: ignore[import-untyped]

from tests.cosim.cli.commands import command, source_environment

MOST_MEMORY = 8 << 30
"""Of the addresses of a process, of which libraries reserve much more than they use [bytes]."""
LONGEST_S = 60.0
"""A disturbed batch ends within this time [s]."""
LARGEST_FILE = 64 << 20
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
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


def killed(folder: Path, words: list[str], drawn: random.Random, lasts_s: float) -> Disturbed:
    """Send a signal to the batch or to one of its workers at some moment."""
    number, to_parent = drawn.choice(SIGNALS), drawn.random() < 0.5
    moment = drawn.uniform(0.0, lasts_s)
    process = _started(folder, words)
    time.sleep(moment)
    family = _family(process)
    workers = [one for one in family if one.pid != process.pid and _is_worker(one)]
    target = psutil.Process(process.pid) if to_parent or not workers else drawn.choice(workers)
    if target.is_running():
        target.send_signal(number)
    whom = "batch" if target.pid == process.pid else "worker"
    return _ended(process, f"{number.name} to the {whom} after {moment:.2f} s", family)


def without_room(folder: Path, words: list[str], drawn: random.Random, lasts_s: float) -> Disturbed:
    """Let the disk, or a file, be full at some byte."""
    size = int(2.0 ** drawn.uniform(12.0, 20.5))
    if not can_mount() or drawn.random() < 0.3:
        process = _started(folder, words, most_bytes=size)
        return _ended(process, f"no file larger than {size} bytes", _family(process))
    pages = max(size // 4096, 1) + 1
    (folder / "disk").mkdir()
    inner = [*words[: words.index("--out")], "--out", "disk/out", *words[words.index("--out") + 2 :]]
    script = (
        f"mount -t tmpfs -o size={pages * 4}k tmpfs disk && "
        f"{{ {shlex.join(inner)}; code=$?; [ -d disk/out ] && cp -r disk/out out; exit $code; }}"
    )
    words = ["unshare", "--user", "--map-root-user", "--mount", "bash", "-c", script]
    process = _started(folder, words)
    return _ended(process, f"a disk of {pages * 4} kB", _family(process))


def damaged(folder: Path, words: list[str], drawn: random.Random, lasts_s: float) -> Disturbed:
    """Let the batch end early or in time, then cut a file of its folder short, alter a byte of it or lose it."""
    process = _started(folder, words)
    if drawn.random() < 0.7:
        time.sleep(drawn.uniform(0.5, 1.0) * lasts_s)
        process.send_signal(signal.SIGTERM)
    ended = _ended(process, "", _family(process))
    files = sorted(path for path in (folder / "out").rglob("*") if path.is_file() and path.name not in KEPT)
    if not files:
        return Disturbed("stopped before there was a file", ended.code, ended.told, ended.left)
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
    what = f"{chosen.relative_to(folder)} {how} at byte {where}"
    return Disturbed(what, ended.code, ended.told, ended.left, chosen)


Disturbance = Callable[[Path, list[str], random.Random, float], Disturbed]
DISTURBANCES: tuple[Disturbance, ...] = (killed, damaged, without_room)


def batch_command(folder: Path, study: Path) -> list[str]:
    """Return the command line of a batch into ``out`` of a folder."""
    return command("batch", study, "--out", "out", "--jobs", 2)


def can_mount() -> bool:
    """Tell whether this machine lets us have a small file system of our own."""
    if shutil.which("unshare") is None:
        return False
    probe = ["unshare", "--user", "--map-root-user", "--mount", "mount", "-t", "tmpfs", "tmpfs", "/mnt"]
    return subprocess.run(probe, capture_output=True, check=False).returncode == 0


def _started(folder: Path, words: list[str], most_bytes: int = LARGEST_FILE) -> subprocess.Popen[str]:
    return subprocess.Popen(
        words,
        cwd=folder,
        env=source_environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=partial(_limit, most_bytes),
    )


def _limit(most_bytes: int) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _family(process: subprocess.Popen[str]) -> list[psutil.Process]:
    try:
        parent = psutil.Process(process.pid)
        return [parent, *parent.children(recursive=True)]
    except psutil.NoSuchProcess:
        return []


def _is_worker(one: psutil.Process) -> bool:
    """Return whether a process makes runs: it is a copy of the one that is copied, and its child."""
    try:
        both = one, one.parent()
        return all(each is not None and "forkserver" in " ".join(each.cmdline()) for each in both)
    except psutil.NoSuchProcess:
        return False


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
