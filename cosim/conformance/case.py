"""A conformance case and its result."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

Values = Mapping[str, float | str]
"""Values measured by one side of a case, by name with unit."""


@dataclass(frozen=True, slots=True)
class Case:
    """A claim about SUMO, with a control: the same measurement under conditions in which the claim must fail.

    Without the control, nobody would notice a criterion that is always met.
    """

    key: str
    """Short name for the command line."""
    name: str
    """The claim, as a sentence."""
    shows: str
    """Why the claim matters for the co-simulation."""
    claim: Callable[[], Values]
    control: Callable[[], Values]
    expected: str
    """The criterion that the claim's values meet, in words."""
    control_expected: str
    """How the control's values fail, in words."""
    holds: Callable[[Values], bool]
    control_fails: Callable[[Values], bool]
    expected_failure: bool = False
    """Whether the claim is known not to hold, so that a case in which it holds is reported."""
    slow: bool = False
    """Whether the case takes more than about 20 s."""


@dataclass(frozen=True, slots=True)
class Result:
    """The measurements of one case and the judgement."""

    case: Case
    measured: Values
    control_measured: Values
    passed: bool
    """Whether the claim turned out as expected: it holds or, for an expected failure, does not."""
    control_failed_as_it_must: bool
    seconds: float
    """Wall-clock time of both sides together [s]."""

    @property
    def green(self) -> bool:
        """Whether the claim turned out as expected and the control failed."""
        return self.passed and self.control_failed_as_it_must

    @property
    def verdict(self) -> str:
        """``pass``, ``expected failure`` or what is wrong."""
        if not self.passed:
            return "unexpectedly holds" if self.case.expected_failure else "FAIL"
        if not self.control_failed_as_it_must:
            return "CONTROL DID NOT FAIL"
        return "expected failure" if self.case.expected_failure else "pass"
