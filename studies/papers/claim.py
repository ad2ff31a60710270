"""Claims of a paper, our findings, and whether the two agree."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Status(StrEnum):
    """Result of checking a claim."""

    RESULT = "paper's result reproduced"
    """Our experiment gives a number or an event that the paper reports of its own."""
    ARITHMETIC = "paper's arithmetic checked"
    """The claim follows from the paper's printed numbers and equations, without any experiment."""
    FITTED = "fitted"
    """The claim holds, but a parameter or form was chosen so that it does: no independent evidence."""
    NOT_REPRODUCED = "not reproduced"
    OWN_CHECK = "own check"
    """The paper does not claim this; we checked it of our implementation or our reading, and it holds."""
    OWN_CHECK_FAILED = "own check, does not hold"


class Kind(StrEnum):
    """Origin of a claim."""

    RESULT = "result"
    """The paper claims it of its experiments."""
    ARITHMETIC = "arithmetic"
    """It follows from the paper's printed numbers and equations."""
    OWN = "own"
    """We claim it of our implementation or our reading; the paper says nothing about it."""


_HOLDS = {Kind.RESULT: Status.RESULT, Kind.ARITHMETIC: Status.ARITHMETIC, Kind.OWN: Status.OWN_CHECK}


@dataclass(frozen=True, slots=True)
class Claim:
    """One line of the table of claims."""

    paper: str
    """``000``, ``002``, ``003`` or ``004``."""
    experiment: str
    claim: str
    """The claim in one sentence."""
    paper_value: str
    """The paper's value; empty if it gives none."""
    our_value: str
    unit: str
    tolerance: str
    """Criterion by which the two values count as equal."""
    status: Status
    why: str
    """Reason for the status: the assumption that was fitted, or what differs."""


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
    theirs, ours, tolerance : the paper's value, ours and the tolerance, in the same unit
    fitted : what was chosen so that the values agree; empty if nothing was
    why : further remarks for the reader
    kind : origin of the claim

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
    """Return a claim about an order or an event, which holds or fails.

    Parameters
    ----------
    holds : whether the claim holds in our run, computed from the run
    theirs, ours : texts for the table
    test : criterion, for instance ``ours smaller``
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
