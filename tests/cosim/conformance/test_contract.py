"""The checks of a controller: each of them notices the controller that breaks its promise."""

from __future__ import annotations

import time
from collections.abc import Callable
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from controllers.interface import Command, Controller, Decision, Manoeuvre, Perception, Plan, constant_command
from cosim.cli import main
from cosim.conformance import contract
from cosim.conformance.contract_table import NAMED, Verdict, checks, verdicts
from cosim.conformance.scenes import golden


class Steady:
    """Keeps every promise."""

    def __init__(self) -> None:
        self.plans = 0

    def decide(self, perception: Perception) -> Decision:
        return Decision(Manoeuvre.KEEP, perception.road.reference)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        self.plans += 1
        return self.answer(perception)

    def answer(self, perception: Perception) -> Plan:
        return Plan(constant_command(0.5, 0.0))


class NotFinite(Steady):
    def answer(self, perception: Perception) -> Plan:
        return Plan(constant_command(0.0, np.nan if perception.ego.speed == 0.0 else 0.0))


class TooStrong(Steady):
    def answer(self, perception: Perception) -> Plan:
        return Plan(constant_command(-9.0 if len(perception.pedestrians) > 100 else 0.0, 0.0))


class Backwards(Steady):
    def answer(self, perception: Perception) -> Plan:
        long = perception.ego.plan_interval > 0.5
        times = np.array([0.0, 0.5, 0.2] if long else [0.0, 0.2, 0.5])
        return Plan(Command(times, np.zeros(3), np.zeros(3)))


class Nowhere(Steady):
    def decide(self, perception: Perception) -> Decision:
        return Decision(Manoeuvre.CHANGE_LEFT, perception.road.reference + 1)


class Nameless(Steady):
    def answer(self, perception: Perception) -> Plan:
        return Plan(constant_command(0.0, 0.0), solved=not perception.road.signals)


class Tired(Steady):
    def answer(self, perception: Perception) -> Plan:
        if self.plans > 20:
            raise RuntimeError("tired")
        return super().answer(perception)


class Sharing(Steady):
    shared = count()

    def answer(self, perception: Perception) -> Plan:
        return Plan(constant_command(0.001 * (next(self.shared) % 1000), 0.0))


class Slow(Steady):
    def answer(self, perception: Perception) -> Plan:
        if self.plans < 20 and perception.ego.time == 0.1 * (self.plans - 1):
            time.sleep(0.02)
        return super().answer(perception)


def broken(factory: Callable[[], Controller]) -> dict[str, Verdict]:
    return {one.name: one for one in verdicts(factory) if not one.kept}


def test_one_that_keeps_every_promise_passes_all_checks() -> None:
    found = list(verdicts(Steady))
    assert len(found) == len(checks()) == 20
    assert [one.name for one in found if not one.kept] == []


@pytest.mark.parametrize(
    ("factory", "names", "detail"),
    [
        (NotFinite, {"standing start", "a speed of 0 m/s"}, "not a finite number"),
        (TooStrong, {"five hundred pedestrians"}, "acceleration -9 is beyond"),
        (Backwards, {"a plan interval of 1 s"}, "do not ascend from 0"),
        (Nowhere, {"no pedestrian"}, "target lane 1 does not exist"),
        (Nameless, {"a red signal"}, "expected a name"),
        (Tired, {"one object meets all situations", "a second run is like the first"}, "tired"),
        (Sharing, {"the same answers, whatever another object is asked"}, "differ in acceleration"),
        (Sharing, {"a second run is like the first"}, "two runs"),
    ],
)
def test_a_broken_promise_is_found(factory: Callable[[], Controller], names: set[str], detail: str) -> None:
    found = broken(factory)
    assert names <= found.keys()
    assert any(detail in found[name].detail for name in names)
    assert all("\n" not in one.detail for one in found.values())


def test_a_slow_one_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contract, "SLOWEST_MS", 5.0)
    with pytest.raises(contract.BrokenError, match="expected a median of at most 5 ms"):
        contract.check_time(Slow)


def test_the_named_situations_exist() -> None:
    assert NAMED.keys() <= golden().keys()


@pytest.mark.long
def test_the_command_prints_a_table_and_its_code_says_whether_all_is_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "nameless.py"
    file.write_text(
        '"""Does nothing, and says that it failed."""\n\n'
        "from controllers.interface import Decision, Manoeuvre, Plan, constant_command\n\n\n"
        "class Nothing:\n"
        "    def decide(self, perception):\n"
        "        return Decision(Manoeuvre.KEEP, perception.road.reference)\n\n"
        "    def plan(self, perception, decision):\n"
        "        return Plan(constant_command(0.0, 0.0), solved=False, status=STATUS)\n\n\n"
        "STATUS = 'ok'\n\n\n"
        "def build(*, status: str = 'ok'):\n"
        "    global STATUS\n"
        "    STATUS = status\n"
        "    return Nothing()\n"
    )
    out = tmp_path / "contract.md"
    assert main(["conformance", "--controller", str(file), "--out", str(out)]) == 1
    assert "BROKEN" in capsys.readouterr().out
    assert "promises kept; broken: no pedestrian" in out.read_text()
    assert main(["conformance", "--controller", str(file), "--set", "status=fallback"]) == 0
    assert "20 of 20 promises kept" in capsys.readouterr().out


def test_an_interrupted_check_leaves_the_table_of_before(tmp_path: Path) -> None:
    file = tmp_path / "interrupted.py"
    file.write_text(
        '"""Interrupts who asks."""\n\n'
        "from controllers.outside.functions import FromFunction\n\n\n"
        "def interrupt(perception):\n    raise KeyboardInterrupt\n\n\n"
        "def build():\n    return FromFunction(interrupt)\n"
    )
    out = tmp_path / "contract.md"
    out.write_text("of before")
    assert main(["conformance", "--controller", str(file), "--out", str(out)]) == 130
    assert out.read_text() == "of before"


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--controller", "sumo", "--out", "."], "--out .: cannot be written"),
        (["--controller", "no_such"], "no controller 'no_such'"),
        (["--controller", "sumo", "--set", "gap=3"], "no parameter 'gap'"),
        (["route", "--controller", "sumo"], "--controller takes no case"),
    ],
)
def test_wrong_use_is_one_line(words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["conformance", *words]) == 2
    said = capsys.readouterr().err
    assert told in said
    assert said.count("\n") == 1
