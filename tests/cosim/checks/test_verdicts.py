"""Verdicts of test protocols as findings of a check."""

from __future__ import annotations

from dataclasses import replace

from analysis.protocols.verdict import Verdict
from cosim.checks.finding import exit_code
from cosim.checks.judged import with_verdict
from cosim.suites import judging
from tests.cosim.checks.test_reports import PASSED

ABOUT = replace(
    PASSED, scope="case", metric="impact_speed_kmh", operator=None, threshold=None, value=None, margin=None
)
CASE = judging.cases("fmvss127")[0]
TOUCHED = Verdict(
    passed=False,
    preventable=True,
    contact=True,
    impact_speed_kmh=12.5,
    colour="",
    points=None,
    max_deceleration_mps2=7.0,
    note="impact at 12.5 km/h",
)


def test_a_contact_that_could_be_prevented_fails_the_check_and_another_does_not() -> None:
    failed = with_verdict(ABOUT, CASE, TOUCHED)
    assert (failed.status, failed.value, exit_code([failed])) == ("fail", 12.5, 1)
    assert failed.note == "expected no contact; impact at 12.5 km/h"
    spared = with_verdict(ABOUT, CASE, replace(TOUCHED, preventable=False))
    assert (spared.status, spared.counts, exit_code([spared])) == ("fail", False, 0)
    assert str(spared.note).endswith("not preventable, so it does not count")


def test_a_case_that_allows_an_impact_speed_has_it_as_its_threshold() -> None:
    case = replace(CASE, highest_impact_kmh=20.0)
    found = with_verdict(ABOUT, case, replace(TOUCHED, passed=True, note=""))
    assert (found.status, found.operator, found.threshold, found.margin) == ("pass", "<=", 20.0, 7.5)


def test_a_case_that_passed_counts() -> None:
    found = with_verdict(ABOUT, CASE, replace(TOUCHED, passed=True, impact_speed_kmh=None, preventable=False))
    assert (found.status, found.counts) == ("pass", True)
