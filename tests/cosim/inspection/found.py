"""Looks up findings of an inspection."""

from __future__ import annotations

from cosim.inspection.finding import Finding, Level
from cosim.inspection.inspection import Inspection


def finding(found: Inspection, check: str) -> Finding:
    """Return the one finding of a check."""
    (one,) = [one for one in found.findings if one.check == check]
    return one


def missing(found: Inspection) -> set[str]:
    """Return the checks that say that something is missing."""
    return {one.check for one in found.findings if one.level is Level.MISSING}
