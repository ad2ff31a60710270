"""What disturbs a batch: the processes that make its runs, and a disk without room."""

from __future__ import annotations

import shlex
import shutil
import subprocess
from collections.abc import Sequence
from contextlib import suppress

import psutil  # type: ignore[import-untyped]

SMALL_DISK_OUT = "disk/out"
"""Where a batch on a small disk is to write."""


def workers(batch: int) -> list[psutil.Process]:
    """Return the processes that make the runs of a batch: copies of one process, which replaces them."""
    found: list[psutil.Process] = []
    with suppress(psutil.NoSuchProcess):
        for one in psutil.Process(batch).children():
            with suppress(psutil.NoSuchProcess):  # it has ended by now
                if "forkserver" in " ".join(one.cmdline()):
                    found += one.children()
    return found


def can_mount() -> bool:
    """Tell whether this machine lets us have a small file system of our own."""
    if shutil.which("unshare") is None:
        return False
    probe = ["unshare", "--user", "--map-root-user", "--mount", "mount", "-t", "tmpfs", "tmpfs", "/mnt"]
    return subprocess.run(probe, capture_output=True, check=False).returncode == 0


def on_small_disk(words: Sequence[str], kilobytes: int, saved: str) -> list[str]:
    """Return the command that runs a command with a small disk, and saves what it left there.

    Parameters
    ----------
    words : Sequence
        The command, which writes to `SMALL_DISK_OUT`.
    kilobytes : int
        Size of the disk.
    saved : str
        Copy of what is there in the end; the disk itself is gone then.
    """
    script = (
        f"mkdir disk && mount -t tmpfs -o size={kilobytes}k tmpfs disk && {{ {shlex.join(words)}; code=$?; "
        f"[ -d {SMALL_DISK_OUT} ] && cp -r {SMALL_DISK_OUT} {saved}; exit $code; }}"
    )
    return ["unshare", "--user", "--map-root-user", "--mount", "bash", "-c", script]
