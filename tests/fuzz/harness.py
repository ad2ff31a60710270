"""One case in a process of its own, with limits on memory and time, and whether it behaved."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import sys
import time
from contextlib import suppress
from pathlib import Path

from tests.fuzz.cases import TARGET, Case
from tests.limits import limit

MOST_MEMORY = 6 << 30
"""[bytes]"""
LONGEST_S = 30.0
FOLDERS = {"tracks": "pedestrians"}


def judge(case: Case, folder: Path) -> tuple[str, str]:
    """Run a case; return how it ended, and what is wrong with that: nothing if it behaved."""
    place = folder / FOLDERS.get(case.kind, case.kind)
    path = place / case.file
    before = path.read_bytes() if path.exists() else None
    printed, told = folder / "stdout", folder / "stderr"
    out = folder / "out"
    try:
        path.write_bytes(case.content)
        words = [word.replace("{}", str(place)) for word in case.command]
        words += ["--out", str(out)] if words[0] == "run" else []
        status = _ended(words, printed, told)
        return _verdict(status, told.read_text("utf-8", "replace"), out)
    finally:
        for one in (out, place / "out"):
            shutil.rmtree(one, ignore_errors=True)
        if before is None:
            path.unlink()
        else:
            path.write_bytes(before)


def _ended(words: list[str], printed: Path, told: Path) -> int | None:
    """Run a command in a copy of this process; return its status, ``None`` where it does not end."""
    sys.stdout.flush()
    sys.stderr.flush()
    child = os.fork()
    if child == 0:
        code = 70
        with suppress(BaseException):
            code = _child(words, printed, told)
        os._exit(code)
    deadline = time.monotonic() + LONGEST_S
    while time.monotonic() < deadline:
        found, status = os.waitpid(child, os.WNOHANG)
        if found:
            return status
        time.sleep(0.005)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None


def _child(words: list[str], printed: Path, told: Path) -> int:
    limit(MOST_MEMORY)
    for number, path in ((1, printed), (2, told)):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), number)
    sys.stdout, sys.stderr = (os.fdopen(number, "w", encoding="utf-8", errors="replace") for number in (1, 2))
    from cosim.cli import main

    code = _target(*words[1:]) if words[0] == TARGET else main(words)
    sys.stdout.flush()
    sys.stderr.flush()
    return code


def _target(study_or_scenario: str, criteria: str = "") -> int:
    """Read what `cosim check` begins with: a study and its criteria, without the runs that try it."""
    from cosim.checks.target import Wishes, read_target
    from cosim.errors import InputError

    try:
        read_target(study_or_scenario, Wishes(criteria=Path(criteria) if criteria else None)).matrix.jobs()
    except InputError as error:
        print("cosim: " + " ".join(str(error).split()), file=sys.stderr)
        return 2
    return 0


def _verdict(status: int | None, told: str, out: Path) -> tuple[str, str]:
    if status is None:
        return "hang", f"no end after {LONGEST_S:g} s"
    if os.WIFSIGNALED(status):
        return f"signal {os.WTERMSIG(status)}", ""  # `cosim run` tells of it and keeps what was recorded
    code = os.WEXITSTATUS(status)
    lines = [line for line in told.splitlines() if line.startswith("cosim: ") and "cosim: note: " not in line]
    if "Traceback" in told or "internal error" in told:
        return f"exit {code}", "a traceback or an internal error"
    if code not in (0, 1, 2, 3):
        return f"exit {code}", "a code that no command has"
    if code >= 2 and len(lines) != 1:
        return f"exit {code}", f"expected one line, got {len(lines)}"
    if code == 2 and out.exists():
        return "exit 2", "a folder is left behind"
    return f"exit {code}", _wrong_files(out) if code == 0 and out.exists() else ""


def _wrong_files(out: Path) -> str:
    try:
        if not json.loads((out / "run.json").read_text("utf-8"))["valid"]:
            return "exit code 0, but the run is not valid"
        for path in out.glob("*.csv"):
            with path.open(encoding="utf-8", newline="") as file:
                heads, *rows = csv.reader(file)
            if any(len(row) != len(heads) for row in rows):
                return f"{path.name} has rows of different lengths"
    except (OSError, ValueError) as error:
        return f"a file cannot be read: {error}"
    return ""
