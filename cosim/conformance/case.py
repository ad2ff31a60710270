"""A conformance case and its result."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

Values = Mapping[str, float | str]
"""What one side of a case measured, by name with unit."""


@dataclass(frozen=True, slots=True)
class Case:
    """A claim about SUMO with a control: the same measurement, done such that the claim must not hold.

    Without the control a criterion that is always met would go unnoticed.
    """

    key: str
    """Short name for the command line."""
    name: str
    """The claim, a sentence."""
    shows: str
    """Why it matters here."""
    claim: Callable[[], Values]
    control: Callable[[], Values]
    expected: str
    """The criterion that the claim's values meet, in words."""
    control_expected: str
    """How the control's values fail, in words."""
    holds: Callable[[Values], bool]
    control_fails: Callable[[Values], bool]
    expected_failure: bool = False
    """The claim is known not to hold; that it does would be news."""
    slow: bool = False
    """Takes more than about 20 s."""


@dataclass(frozen=True, slots=True)
class Result:
    """One case as measured."""

    case: Case
    measured: Values
    control_measured: Values
    passed: bool
    """The claim is as expected: it holds or, for an expected failure, does not."""
    control_failed_as_it_must: bool
    seconds: float
    """Wall-clock time of both sides together [s]."""

    @property
    def green(self) -> bool:
        """Whether there is nothing to look into."""
        return self.passed and self.control_failed_as_it_must

    @property
    def verdict(self) -> str:
        """``pass``, ``expected failure`` or what is wrong."""
        if not self.passed:
            return "unexpectedly holds" if self.case.expected_failure else "FAIL"
        if not self.control_failed_as_it_must:
            return "CONTROL DID NOT FAIL"
        return "expected failure" if self.case.expected_failure else "pass"
