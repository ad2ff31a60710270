"""What a paper says, what we found, and whether the two agree."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Status(StrEnum):
    """What became of a claim."""

    RESULT = "paper's result reproduced"
    """A number or an event that the paper reports of its experiment comes out of ours."""
    ARITHMETIC = "paper's arithmetic checked"
    """It follows from the paper's printed numbers and equations, without any experiment."""
    FITTED = "fitted"
    """It agrees, but a parameter or form was chosen so that it does: no independent evidence."""
    NOT_REPRODUCED = "not reproduced"
    OWN_CHECK = "own check"
    """The paper does not say so; we checked it about our implementation or our reading, and it holds."""
    OWN_CHECK_FAILED = "own check, does not hold"


class Kind(StrEnum):
    """Who says what a claim says, and where."""

    RESULT = "result"
    """The paper, of its experiments."""
    ARITHMETIC = "arithmetic"
    """The paper's printed numbers and equations."""
    OWN = "own"
    """We, about our implementation or our reading; the paper says nothing of it."""


_HOLDS = {Kind.RESULT: Status.RESULT, Kind.ARITHMETIC: Status.ARITHMETIC, Kind.OWN: Status.OWN_CHECK}


@dataclass(frozen=True, slots=True)
class Claim:
    """One line of the table of claims."""

    paper: str
    """``000``, ``002``, ``003`` or ``004``."""
    experiment: str
    claim: str
    """What is said, in one sentence."""
    paper_value: str
    """As the paper has it; empty where it gives none."""
    our_value: str
    unit: str
    tolerance: str
    """When the two count as equal."""
    status: Status
    why: str
    """What the status rests on: the assumption that was fitted, or what differs."""


def compared(
    paper: str,
    experiment: str,
    claim: str,
    *,
    theirs: float,
    ours: float,
    tolerance: float,
    unit: str = "",
    fitted: str = "",
    why: str = "",
    kind: Kind = Kind.RESULT,
) -> Claim:
    """Return the claim that two numbers are equal within a tolerance.

    Parameters
    ----------
    theirs, ours, tolerance : in the same unit
    fitted : what was chosen so that they agree; empty when nothing was
    why : what else a reader should know
    kind : who says so

    >>> compared("004", "E1", "It stops.", theirs=29.0, ours=29.2, tolerance=0.5, unit="s").status
    <Status.RESULT: "paper's result reproduced">
    """
    agrees = abs(ours - theirs) <= tolerance
    status = _status(agrees, fitted, kind)
    values = (f"{theirs:g}", f"{ours:.5g}")
    return Claim(paper, experiment, claim, *values, unit, f"± {tolerance:g}", status, _reasons(fitted, why))


def observed(
    paper: str,
    experiment: str,
    claim: str,
    *,
    holds: bool,
    theirs: str = "",
    ours: str = "",
    unit: str = "",
    test: str = "",
    fitted: str = "",
    why: str = "",
    kind: Kind = Kind.RESULT,
) -> Claim:
    """Return a claim about an order or an event, which holds or does not.

    Parameters
    ----------
    holds : whether our run shows it, computed from the run
    theirs, ours : what to show in the table
    test : what decides, for instance ``ours smaller``
    fitted, why, kind : as for :func:`compared`
    """
    status = _status(holds, fitted, kind)
    return Claim(paper, experiment, claim, theirs, ours, unit, test, status, _reasons(fitted, why))


def _status(holds: bool, fitted: str, kind: Kind) -> Status:
    if not holds:
        return Status.OWN_CHECK_FAILED if kind is Kind.OWN else Status.NOT_REPRODUCED
    return Status.FITTED if fitted and kind is not Kind.OWN else _HOLDS[kind]


def _reasons(*texts: str) -> str:
    return "; ".join(text for text in texts if text)
