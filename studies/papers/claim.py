"""What a paper says, what we found, and whether the two agree."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Status(StrEnum):
    """What became of a claim."""

    REPRODUCED = "reproduced"
    FITTED = "fitted"
    """It agrees, but a parameter or form was chosen so that it does: no independent evidence."""
    NOT_REPRODUCED = "not reproduced"


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
) -> Claim:
    """Return the claim that two numbers are equal within a tolerance.

    Parameters
    ----------
    theirs, ours, tolerance : in the same unit
    fitted : what was chosen so that they agree; empty when nothing was
    why : what else a reader should know

    >>> compared("004", "E1", "It stops.", theirs=29.0, ours=29.2, tolerance=0.5, unit="s").status
    <Status.REPRODUCED: 'reproduced'>
    """
    agrees = abs(ours - theirs) <= tolerance
    status = _status(agrees, fitted)
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
) -> Claim:
    """Return a claim about an order or an event, which holds or does not.

    Parameters
    ----------
    holds : whether our run shows it, computed from the run
    theirs, ours : what to show in the table
    test : what decides, for instance ``ours smaller``
    fitted, why : as for :func:`compared`
    """
    status = _status(holds, fitted)
    return Claim(paper, experiment, claim, theirs, ours, unit, test, status, _reasons(fitted, why))


def _status(agrees: bool, fitted: str) -> Status:
    if not agrees:
        return Status.NOT_REPRODUCED
    return Status.FITTED if fitted else Status.REPRODUCED


def _reasons(*texts: str) -> str:
    return "; ".join(text for text in texts if text)
