"""The contract of controllers as a list of checks, and their results as a table."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from time import perf_counter

from cosim.conformance import contract
from cosim.conformance.contract import CROWD, BrokenError, Factory
from cosim.conformance.scenes import golden

HEADINGS = ("check", "result", "detail")
NAMED = {
    "empty road": "no pedestrian",
    CROWD: "five hundred pedestrians",
    "three lanes": "lanes on both sides",
    "lane ends": "the lane ends",
    "standing": "standing start",
    "red signal": "a red signal",
    "amber signal too near to stop": "an amber signal that is too near to stop",
    "boxed in": "no lane is free",
    "no view of the road": "nothing is known of the road",
}
"""Situations with a row of their own, and its name; the other situations share one row."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """The result of one check of one controller."""

    name: str
    kept: bool
    detail: str
    seconds: float

    def row(self) -> tuple[str, str, str]:
        """Return the columns of `HEADINGS`."""
        return self.name, "kept" if self.kept else "BROKEN", self.detail


def checks() -> dict[str, Callable[[Factory], str]]:
    """Return the checks by name; each returns a detail or raises `BrokenError`."""
    others = [situation for situation in golden() if situation not in NAMED]
    return {
        **{name: partial(_situation, situation=situation) for situation, name in NAMED.items()},
        f"{len(others)} other situations": partial(_situations, situations=others),
        **{f"a plan interval of {one:g} s": partial(_interval, interval=one) for one in contract.INTERVALS},
        **{f"a speed of {one:g} m/s": partial(_speed, speed=one) for one in contract.SPEEDS},
        "one object meets all situations": contract.check_survival,
        "the same answers, whatever another object is asked": contract.check_determinism,
        "a second run is like the first": contract.check_runs,
        f"a step takes at most {contract.SLOWEST_MS:g} ms on the median": contract.check_time,
    }


def verdicts(factory: Factory) -> Iterator[Verdict]:
    """Yield the result of every check; any exception from the controller counts as a broken contract."""
    for name, check in checks().items():
        begun = perf_counter()
        try:
            kept, detail = True, check(factory)
        except BrokenError as error:
            kept, detail = False, str(error)
        except (Exception, SystemExit) as error:  # noqa: BLE001  a foreign controller may raise anything
            kept, detail = False, f"{type(error).__name__}: {error}"
        yield Verdict(name, kept, " ".join(detail.split()), perf_counter() - begun)


def _situation(factory: Factory, situation: str) -> str:
    return contract.check_situation(factory, situation)


def _situations(factory: Factory, situations: list[str]) -> str:
    for situation in situations:
        try:
            contract.check_situation(factory, situation)
        except BrokenError as error:
            raise BrokenError(f"{situation}: {error}") from error
    return ""


def _interval(factory: Factory, interval: float) -> str:
    return contract.check_interval(factory, interval)


def _speed(factory: Factory, speed: float) -> str:
    return contract.check_speed(factory, speed)
