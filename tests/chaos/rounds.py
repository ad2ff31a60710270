"""Rounds: a batch is disturbed, resumed until it is finished, and compared with one that was not disturbed."""

from __future__ import annotations

import random
import re
import shutil
import time
from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from tests.chaos.disturbances import DISTURBANCES, Disturbed
from tests.cosim.batches.studies import content, lasting, write_study
from tests.cosim.cli.commands import finished

MOST_RESUMED = 4
"""So often a batch is resumed at most."""
REMEDIES = (
    (re.compile(r"remove the folder (\S+?) and "), "remove"),
    (re.compile(r"cosim analyse (\S+) makes it again"), "analyse"),
    (re.compile(r"the batch or check, repeated, writes it again"), "repeat"),
)


@dataclass
class Rounds:
    """What has become of the rounds."""

    endings: Counter[tuple[str, str]] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)


@dataclass
class Chaos:
    """Rounds in a folder.

    Parameters
    ----------
    folder : empty
    seed : with the round's number, decides everything but the moments at which processes are disturbed
    """

    folder: Path
    seed: int

    def run(self, count: int) -> Rounds:
        """Run so many rounds."""
        found = Rounds()
        for number in range(count):
            kind, ending, what = self.round(number)
            found.endings[kind, ending.split(":")[0]] += 1
            if ending.startswith("wrong"):
                found.wrong.append(f"round {number}: {what}: {ending}")
        return found

    def round(self, number: int) -> tuple[str, str, str]:
        """Run a round; return the kind of disturbance, how it ended, and the disturbance itself."""
        reference, lasts_s = self._undisturbed
        drawn = random.Random(f"{self.seed}-{number}")
        disturb = DISTURBANCES[number % len(DISTURBANCES)]
        place = self.folder / f"round-{number}"
        place.mkdir()
        disturbed = disturb(place, self._study, drawn, lasts_s)
        ending = _judged(disturbed) or self._resumed(place, disturbed, reference)
        if not ending.startswith("wrong"):
            shutil.rmtree(place)
        return disturb.__name__, ending, disturbed.what

    @cached_property
    def _study(self) -> Path:
        return write_study(self.folder / "study", seeds="1-3")

    @cached_property
    def _undisturbed(self) -> tuple[dict[str, object], float]:
        """Return what a batch leaves that nothing disturbs, and how long it lasts [s]."""
        began = time.monotonic()
        done = finished("batch", self._study, "--out", "whole", "--jobs", 2, folder=self.folder)
        assert done.returncode == 0, done.stderr
        return _lasting(self.folder / "whole"), time.monotonic() - began

    def _resumed(self, place: Path, disturbed: Disturbed, reference: dict[str, object]) -> str:
        """Resume a batch, as it says itself where it refuses; return how that ended."""
        named = disturbed.damaged is None
        ending = "identical"
        for _ in range(MOST_RESUMED):
            done = finished("batch", self._study, "--out", "out", "--jobs", 2, folder=place)
            if "Traceback" in done.stderr or "internal error" in done.stderr:
                return f"wrong: {done.stderr[-500:]}"
            if done.returncode == 0:
                return self._compared(place, disturbed, reference, named, ending)
            named = named or disturbed.damaged is None or str(disturbed.damaged.name) in done.stderr
            if not named:
                return f"wrong: it does not name the file: {done.stderr[-500:]}"
            if not _mended(place, done.stderr):
                return f"wrong: it says no remedy: exit code {done.returncode}: {done.stderr[-500:]}"
            ending = "named, then identical"
        return f"wrong: not finished after {MOST_RESUMED} times: {done.stderr[-500:]}"

    def _compared(
        self, place: Path, disturbed: Disturbed, reference: dict[str, object], named: bool, ending: str
    ) -> str:
        """Return how a finished batch compares with the undisturbed one."""
        now = _lasting(place / "out")
        differs = sorted(name for name in {*now, *reference} if now.get(name) != reference.get(name))
        if differs:
            told = "unnoticed" if disturbed.damaged is not None and not named else "after all"
            return f"wrong: other than undisturbed, {told}: {', '.join(differs)}"
        done = finished("verify", "out", folder=place)
        if done.returncode != 0:
            return f"wrong: identical, but not verified: {done.stdout[-300:]}{done.stderr[-300:]}"
        return ending


def _judged(disturbed: Disturbed) -> str:
    """Return what is wrong with the end of a disturbed batch; empty for nothing."""
    if disturbed.code is None:
        return "wrong: it did not end"
    if disturbed.left:
        return f"wrong: {disturbed.left} of its processes lived on"
    if "Traceback" in disturbed.told or "internal error" in disturbed.told:
        return f"wrong: {disturbed.told[-500:]}"
    return ""


def _mended(place: Path, told: str) -> bool:
    """Do what a batch says is to be done; return whether it said something."""
    said = False
    for pattern, remedy in REMEDIES:
        for found in pattern.finditer(told):
            said = True
            if remedy == "remove":
                shutil.rmtree(place / found[1], ignore_errors=True)
            elif remedy == "analyse":
                finished("analyse", found[1], folder=place)
    return said


def _lasting(out: Path) -> dict[str, object]:
    """Return what does not depend on the wall clock: the tables of a study, and the files of its runs."""
    found: dict[str, object] = {"tables": lasting(out)}
    for run in sorted((out / "runs").iterdir()):
        found |= {f"{run.name}/{name}": value for name, value in content(run).items()}
    return found
