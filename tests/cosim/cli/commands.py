"""Commands as a user starts them, in this process or in one of their own."""

from __future__ import annotations

import contextlib
import io
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from cosim.cli import main


def source_environment() -> dict[str, str]:
    """Return an environment in which this very checkout is imported."""
    return {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[3])}


def command(*arguments: object) -> list[str]:
    """Return a command line of this very checkout."""
    return [sys.executable, "-m", "cosim.cli", *map(str, arguments)]


def ended(
    *arguments: object,
    code: int = 0,
    folder: Path | None = None,
    environment: Mapping[str, str] | None = None,
) -> subprocess.CompletedProcess[str]:
    """Run a command to its end, which must have this exit code and show no traceback.

    Parameters
    ----------
    arguments
        Of the command.
    code
        The exit code.
    folder
        Where to run it.
    environment
        Additional variables. With them the command has a process of its own, which takes seconds to start.
    """
    if environment is None:
        done = finished(*arguments, folder=folder)
    else:
        done = subprocess.run(
            command(*arguments),
            capture_output=True,
            text=True,
            check=False,
            cwd=folder,
            env={**source_environment(), **environment},
        )
    assert done.returncode == code, f"exit code {done.returncode}\n{done.stdout}\n{done.stderr}"
    assert "Traceback" not in done.stderr
    return done


def finished(*arguments: object, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run a command in this process, which has loaded already what it needs, whatever its exit code."""
    words = command(*arguments)
    printed, told = io.StringIO(), io.StringIO()
    with (
        contextlib.chdir(folder or Path.cwd()),
        contextlib.redirect_stdout(printed),
        contextlib.redirect_stderr(told),
    ):
        code = main(words[3:])
    return subprocess.CompletedProcess(words, code, printed.getvalue(), told.getvalue())
