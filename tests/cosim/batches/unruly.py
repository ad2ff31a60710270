"""A controller that misbehaves on request, installed as the plug-in that it is in a user's hands."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

CODE = '''"""Behaves for a while, then as it is told to."""

import ctypes
import os
import signal
import time
from pathlib import Path

from controllers.interface import Controller, Decision, Manoeuvre, Perception, Plan, constant_command


def fail(behaviour: str) -> None:
    if behaviour.startswith("once"):
        mark = Path(os.environ["UNRULY_MARKS"]) / behaviour
        if mark.exists():
            return
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if behaviour == "raise":
        raise ZeroDivisionError("one over nothing")
    if behaviour == "hang":
        time.sleep(1000)
    if behaviour == "hang_deaf":  # in C and with the lock of the interpreter: no signal is handled
        ctypes.PyDLL(None).sleep(1000)
    if behaviour == "crash":
        print("about to crash", flush=True)
        ctypes.string_at(0)
    if behaviour == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    if behaviour == "leave":
        os._exit(5)
    if behaviour == "exit":
        raise SystemExit("enough")


class Unruly:
    def __init__(self, behaviour: str, at_s: float) -> None:
        self.behaviour, self.at_s = behaviour, at_s

    def decide(self, perception: Perception) -> Decision:
        if perception.ego.time >= self.at_s:
            fail(self.behaviour)
        return Decision(Manoeuvre.KEEP, perception.road.reference)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        return Plan(constant_command(0.0, steering=0.0))


def build(*, behaviour: str = "none", at_s: float = 3.0) -> Controller:
    return Unruly(behaviour, at_s)
'''


def install(folder: Path) -> dict[str, str]:
    """Put the plug-in below ``folder`` and return the environment in which it is found."""
    root = Path(__file__).resolve().parents[3]
    (folder / "unruly-1.dist-info").mkdir(parents=True)
    (folder / "unruly.py").write_text(CODE)
    (folder / "unruly-1.dist-info" / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: unruly\nVersion: 1\n"
    )
    (folder / "unruly-1.dist-info" / "entry_points.txt").write_text("[cosim.controllers]\nunruly = unruly\n")
    marks = folder / "marks"
    marks.mkdir()
    return {"PYTHONPATH": f"{root}:{folder}", "UNRULY_MARKS": str(marks)}


def use(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Put the plug-in below ``folder``, where this process and those that it starts find it."""
    monkeypatch.setenv("UNRULY_MARKS", install(folder)["UNRULY_MARKS"])
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.delitem(sys.modules, "unruly", raising=False)
