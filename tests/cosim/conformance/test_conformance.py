"""What SUMO does to an external ego: the cases of ``cosim conformance``, each with its control."""

from __future__ import annotations

import pytest

from cosim.conformance.case import Case, Result
from cosim.conformance.suite import cases, named, run
from cosim.conformance.table import HEADINGS, described, markdown, summary, table_rows
from cosim.errors import InputError

ALL = cases()


@pytest.mark.long
@pytest.mark.sumo
@pytest.mark.parametrize(
    "case", [pytest.param(case, id=case.key, marks=[pytest.mark.slow] * case.slow) for case in ALL]
)
def test_the_claim_is_as_expected_and_its_control_fails(case: Case) -> None:
    (result,) = run([case])
    assert result.green, f"{result.verdict}: {table_rows([result])[0]}"


def test_every_case_has_a_name_of_its_own() -> None:
    assert len({case.key for case in ALL}) == len(ALL)


def test_an_unknown_case_is_refused_with_the_list_of_those_that_exist() -> None:
    with pytest.raises(InputError, match="blind_step"):
        named(["nonsense"])


def _result(passed: bool, control: bool, expected_failure: bool = False) -> Result:
    case = Case(
        key="demo",
        name="A claim",
        shows="what",
        claim=dict,
        control=dict,
        expected="x > 1",
        control_expected="x < 1",
        holds=lambda _: True,
        control_fails=lambda _: True,
        expected_failure=expected_failure,
    )
    return Result(case, {"return_code": 0, "x_m": 2.5}, {"return_code": -11}, passed, control, 1.0)


def test_a_control_that_does_not_fail_is_not_green() -> None:
    result = _result(passed=True, control=False)
    assert not result.green
    assert result.verdict == "CONTROL DID NOT FAIL"
    assert "not green: demo" in summary([result])


def test_an_expected_failure_is_green_and_listed() -> None:
    result = _result(passed=True, control=True, expected_failure=True)
    assert result.green
    assert result.verdict == "expected failure"
    assert "expected failures: demo" in summary([result])


def test_an_expected_failure_that_holds_is_news() -> None:
    assert _result(passed=False, control=True, expected_failure=True).verdict == "unexpectedly holds"


def test_the_table_shows_what_was_measured_and_a_crash_by_its_return_code() -> None:
    (row,) = table_rows([_result(passed=True, control=True)])
    assert len(row) == len(HEADINGS)
    assert row[3] == "x_m = 2.500"
    assert row[4] == "x < 1 -> return_code = -11"
    assert markdown([_result(passed=True, control=True)]).count("\n| ") == 3
    assert described({"return_code": 0, "route": ""}) == "route = none"
