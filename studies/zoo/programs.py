"""Calls the programs of the installed SUMO with a time limit."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import sumo

HOME = Path(sumo.SUMO_HOME)
LIMIT_S = 300.0
"""Longest time that one program may take [s]."""

_COMMENT = re.compile(r"<!--.*?-->\s*", re.DOTALL)


class ZooError(Exception):
    """A network could not be made; the message is one line."""


def call(*words: object, folder: Path, limit_s: float = LIMIT_S) -> None:
    """Run ``netgenerate``, ``netconvert`` or a script of SUMO's tools in a folder.

    Parameters
    ----------
    words : object
        Name of the program, or path of a ``.py`` file below SUMO's ``tools``, and its arguments.
    folder : Path
    limit_s : float
        Time after which the program is ended [s].

    Raises
    ------
    ZooError
        If the program fails or takes too long; the message contains the last error in its output.
    """
    name, *arguments = map(str, words)
    script = name.endswith(".py")
    program = [sys.executable, str(HOME / "tools" / name)] if script else [str(HOME / "bin" / name)]
    environment = {**os.environ, "SUMO_HOME": str(HOME)}
    try:
        done = subprocess.run(
            [*program, *arguments],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            timeout=limit_s,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise ZooError(f"{name} was not done after {limit_s:g} s") from error
    if done.returncode:
        raise ZooError(f"{name} ended with {done.returncode}: {_complaint(done.stdout + done.stderr)}")


def without_comments(path: Path) -> None:
    """Remove SUMO's comments, which contain time and folder, so that the same seed gives the same bytes."""
    path.write_text(_COMMENT.sub("", path.read_text("utf-8")), "utf-8")


def _complaint(said: str) -> str:
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    errors = [line for line in lines if line.startswith("Error")]
    return (errors or lines or ["it said nothing"])[-1]
