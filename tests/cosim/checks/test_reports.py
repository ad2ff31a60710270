"""Exit codes, JUnit and summaries, from findings written by hand."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from cosim.checks import summary
from cosim.checks.baseline import _finding
from cosim.checks.finding import Finding, exit_code
from cosim.checks.junit import write_junit

PASSED = Finding(
    target="town",
    scenario_id="town",
    controller="aeb",
    configuration="aeb horizon=2",
    scope="run",
    criterion_id="min_dist_m >= 0.5",
    metric="min_dist_m",
    status="pass",
    unit="m",
    operator=">=",
    threshold=0.5,
    value=0.75,
    margin=0.25,
    seed=3,
    run="town/runs/town-aeb-seed3",
    command="cosim run town --controller aeb --seed 3",
)
FAILED = replace(PASSED, status="fail", value=0.25, margin=-0.25, seed=4)
UNDEFINED = replace(PASSED, status="undefined", value=None, margin=None, seed=5)
ALLOWED = replace(UNDEFINED, counts=False)
INVALID = replace(UNDEFINED, status="invalid", note="still running after run_timeout_s = 5 s", seed=6)


@pytest.mark.parametrize(
    ("findings", "code"),
    [
        ([PASSED, PASSED], 0),
        ([PASSED, ALLOWED], 0),
        ([PASSED, FAILED], 1),
        ([PASSED, UNDEFINED], 1),
        ([PASSED, INVALID], 3),
        ([FAILED, INVALID, PASSED], 3),
        ([PASSED, replace(FAILED, counts=False)], 0),
    ],
)
def test_the_worst_finding_that_counts_decides_the_exit_code(findings: list[Finding], code: int) -> None:
    assert exit_code(findings) == code


COMPARED = {
    **{"metric": "ego_delay_mean_s", "unit": "s", "n_pairs": 6, "base_mean": 10.0, "alt_mean": 12.0},
    **{"diff_mean": 2.0, "test": "paired_t", "p_value": 0.004, "p_holm": 0.02, "n_family": 5},
}


@pytest.mark.parametrize(
    ("changes", "code", "told"),
    [
        ({"worse_now": True}, 1, "p = 0.004, 0.02 corrected over 5 tests: worse at level 0.05"),
        ({"worse_now": False}, 0, "corrected over 5 tests: not shown to be worse at level 0.05"),
        ({"worse_now": False, "p_holm": None}, 0, "10 → 12 s, 6 pairs, no test"),
        ({"worse_now": False, "p_holm": None, "diff_mean": 0.0}, 0, "6 pairs, no difference"),
        ({"worse_now": False, "p_holm": None, "diff_mean": None}, 0, "undefined in the pairs; not compared"),
    ],
)
def test_what_got_worse_than_the_baseline_fails_and_says_by_how_much(
    changes: dict[str, Any], code: int, told: str
) -> None:
    found = _finding(PASSED, COMPARED | changes, 0.05)
    assert exit_code([found]) == code
    assert (found.scope, found.metric, found.value) == (
        "baseline",
        "ego_delay_mean_s",
        (COMPARED | changes)["diff_mean"],
    )
    assert told in found.sentence
    assert found.counts is (found.status != "undefined")


def written(folder: Path, *findings: Finding) -> ElementTree.Element:
    path = folder / "results" / "junit.xml"
    write_junit(path, findings)
    return ElementTree.parse(path).getroot()


def test_the_file_has_the_shape_that_readers_of_junit_expect(tmp_path: Path) -> None:
    other = replace(FAILED, target="village", encounter_id=7)
    root = written(tmp_path, PASSED, FAILED, INVALID, ALLOWED, other)
    assert root.tag == "testsuites"
    assert [suite.get("name") for suite in root] == ["town", "village"]
    for element in (root, *root):
        cases = list(element.iter("testcase"))
        assert element.get("tests") == str(len(cases))
        for attribute, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
            if element is not root or tag != "skipped":
                assert element.get(attribute) == str(sum(case.find(tag) is not None for case in cases))
    assert set(root.attrib) == {"name", "tests", "failures", "errors"}
    assert all(set(suite.attrib) == {"name", "tests", "failures", "errors", "skipped"} for suite in root)
    names = [(case.get("classname"), case.get("name")) for case in root.iter("testcase")]
    assert len(set(names)) == len(names)
    assert all(case.get("classname") and case.get("name") for case in root.iter("testcase"))
    assert {child.tag for case in root.iter("testcase") for child in case} == {"failure", "error", "skipped"}


def test_a_failure_says_value_threshold_seed_and_the_command_that_makes_the_run_again(
    tmp_path: Path,
) -> None:
    failure = written(tmp_path, FAILED).find("testsuite/testcase/failure")
    assert failure is not None
    assert failure.get("message") == "min_dist_m = 0.25 m, expected >= 0.5 m"
    assert "seed 4" in str(failure.text)
    assert "margin: -0.25" in str(failure.text)
    assert "again: cosim run town --controller aeb --seed 3" in str(failure.text)


def test_a_run_that_is_invalid_is_an_error_with_its_reason(tmp_path: Path) -> None:
    error = written(tmp_path, INVALID).find("testsuite/testcase/error")
    assert error is not None
    assert error.get("message") == "invalid: still running after run_timeout_s = 5 s"


def test_what_xml_cannot_hold_is_replaced(tmp_path: Path) -> None:
    odd = replace(INVALID, note="ended by \x1b[1m <&> \ud800 ü", criterion_id="a < b")
    error = written(tmp_path, odd).find("testsuite/testcase/error")
    assert error is not None
    assert error.get("message") == "invalid: ended by ?[1m <&> ? ü"


def test_the_same_findings_give_the_same_bytes(tmp_path: Path) -> None:
    for name in ("one", "two"):
        write_junit(tmp_path / name, [PASSED, FAILED])
    assert (tmp_path / "one").read_bytes() == (tmp_path / "two").read_bytes()


def test_a_summary_counts_and_shows_the_value_nearest_to_failing() -> None:
    near = replace(PASSED, value=0.55, margin=0.05)
    (line,) = summary.lines([PASSED, near, ALLOWED, UNDEFINED, INVALID])
    assert (line.judged, line.passed, line.failed, line.not_counted, line.invalid) == (5, 2, 1, 1, 1)
    assert line.worst_text == "0.55 m"
    assert summary.verdict([PASSED, FAILED, ALLOWED]) == (
        "failed: 1 of 2 criteria met, 1 not met, 1 do not count"
    )
    assert summary.verdict([FAILED, INVALID]).startswith("invalid: 0 of 1 criteria met")


def test_the_cases_of_a_protocol_are_one_line_with_the_fastest_impact() -> None:
    cases = [
        replace(
            FAILED,
            scope="case",
            criterion_id=f"protocol {speed}",
            value=speed,
            margin=None,
            threshold=None,
            unit="km/h",
        )
        for speed in (10.0, 42.0, 20.0)
    ]
    (line,) = summary.lines(cases)
    assert (line.criterion, line.failed, line.worst_text) == ("protocol", 3, "42 km/h")


def test_the_step_summary_is_appended_where_there_is_one(tmp_path: Path) -> None:
    path = tmp_path / "summary.md"
    path.write_text("before\n")
    summary.append_step_summary([PASSED, FAILED], {summary.STEP_SUMMARY: str(path)})
    summary.append_step_summary([PASSED], {})
    text = path.read_text()
    assert text.startswith("before\n### cosim check failed: 1 of 2 criteria met, 1 not met\n")
    (row,) = (line for line in text.splitlines() if line.startswith("| town"))
    assert row == "| town | min_dist_m >= 0.5 | 2 | 1 | 1 | 0 | 0 | 0.25 m |"
    assert "again: cosim run town --controller aeb --seed 3" in text


def test_a_long_list_of_failures_is_cut_and_says_so() -> None:
    many = [replace(FAILED, seed=seed) for seed in range(100)]
    assert summary.failures(many)[-1] == "… and 70 more"
    assert len(re.findall("^again:", summary.markdown(many), re.MULTILINE)) == summary.MOST_FAILURES


def test_an_invalid_run_is_told_once() -> None:
    run = replace(INVALID, criterion_id="valid", metric="valid")
    (line,) = summary.failures([run, INVALID, replace(INVALID, scope="encounter", metric="collision")])
    assert line.startswith("valid: town with aeb horizon=2, seed 6: invalid: still running")
    statistic = replace(INVALID, scope="configuration", seed=None)
    assert len(summary.failures([run, INVALID, statistic])) == 2


def test_what_failed_at_a_place_without_a_pedestrian_is_told_without_one(tmp_path: Path) -> None:
    overlap = replace(FAILED, ego_id="ego_0", place="22.2 s, 1.80 m into vehicle eastbound.0")
    (failure,) = written(tmp_path, overlap).iter("failure")
    assert "\nego ego_0\nwhere: 22.2 s, 1.80 m into vehicle eastbound.0\n" in (failure.text or "")
    assert "ego ego_0" in summary.markdown([overlap])
