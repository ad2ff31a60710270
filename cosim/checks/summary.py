"""Summary of a check for people: a table of criteria, and the failures."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.table import Table

from analysis.markdown import table as markdown_table
from cosim.checks.finding import VALID, Finding, exit_code
from cosim.checks.junit import details

MOST_FAILURES = 30
"""Largest number of failures shown one by one; criteria.csv has all of them."""
MOST_ROWS = 200
STEP_SUMMARY = "GITHUB_STEP_SUMMARY"

_NUMBERS = ("judged", "passed", "failed", "not counted", "invalid", "worst value")
_HEADINGS = ("target", "criterion", *_NUMBERS)
_WORDS = {0: "passed", 1: "failed", 3: "invalid"}


@dataclass(frozen=True, slots=True)
class Line:
    """One criterion of a target, over everything that it judges."""

    target: str
    criterion: str
    judged: int
    passed: int
    failed: int
    """Number of failed findings, including undefined ones."""
    not_counted: int
    invalid: int
    worst: Finding | None
    """The finding nearest to failing, or furthest beyond; ``None`` if that is not known."""

    @property
    def worst_text(self) -> str:
        """Value and unit of the worst finding."""
        one = self.worst
        if one is None or one.value is None:
            return "–"
        unit = f" {one.unit}" if one.unit not in (None, "", "1") else ""
        return f"{one.value:.6g}{unit}"


def lines(findings: Sequence[Finding]) -> list[Line]:
    """Return one line for each criterion of each target, in the order of the findings."""
    groups: dict[tuple[str, str, str], list[Finding]] = {}
    for one in findings:
        # Each case of a protocol is a criterion of its own; the table has one line for all of them.
        name = "protocol" if one.scope == "case" else one.criterion_id
        groups.setdefault((one.target, one.scope, name), []).append(one)
    return [
        Line(
            target=target,
            criterion=name,
            judged=len(group),
            passed=sum(one.status == "pass" for one in group),
            failed=sum(one.failed for one in group),
            not_counted=sum(not one.counts for one in group),
            invalid=sum(one.invalid for one in group),
            worst=_worst(group),
        )
        for (target, _, name), group in groups.items()
    ]


def _worst(group: Sequence[Finding]) -> Finding | None:
    """Return the finding with the smallest margin; without margins, the case with the highest value."""
    margins = [(one.margin, one) for one in group if one.margin is not None]
    if margins:
        return min(margins, key=lambda pair: pair[0])[1]
    values = [(one.value, one) for one in group if one.value is not None and one.scope == "case"]
    return max(values, key=lambda pair: pair[0])[1] if values else None


def verdict(findings: Sequence[Finding]) -> str:
    """Return the outcome in one line."""
    judged = [one for one in findings if one.status in ("pass", "fail", "undefined") and one.counts]
    failed, invalid = sum(one.failed for one in findings), sum(one.invalid for one in findings)
    other = len(findings) - len(judged) - invalid
    said = f"{_WORDS[exit_code(findings)]}: {len(judged) - failed} of {len(judged)} criteria met"
    said += f", {failed} not met" if failed else ""
    said += f", {invalid} could not be judged because a run is invalid" if invalid else ""
    return said + (f", {other} do not count" if other else "")


def table(findings: Sequence[Finding]) -> Table:
    """Return the table for a terminal."""
    shown = Table(box=None, pad_edge=False, header_style="bold")
    for heading in _HEADINGS:
        if heading in _NUMBERS:
            shown.add_column(heading, justify="right")
        else:
            shown.add_column(heading, overflow="fold")
    for line in lines(findings)[:MOST_ROWS]:
        shown.add_row(*_cells(line))
    return shown


def failures(findings: Sequence[Finding]) -> list[str]:
    """Return the failures, one line each, with invalid runs first."""
    wrong = _wrong(findings)
    said = [f"{one.criterion_id}: {one.subject}: {one.sentence}" for one in wrong[:MOST_FAILURES]]
    return said + ([f"… and {len(wrong) - MOST_FAILURES} more"] if len(wrong) > MOST_FAILURES else [])


def append_step_summary(findings: Sequence[Finding], environment: Mapping[str, str] = os.environ) -> None:
    """Append the check to the summary of a GitHub Actions step, if there is one."""
    path = environment.get(STEP_SUMMARY)
    if path:
        with Path(path).open("a", encoding="utf-8") as file:
            file.write(markdown(findings))


def markdown(findings: Sequence[Finding]) -> str:
    """Return the check as Markdown."""
    rows = [[_escaped(cell) for cell in _cells(line)] for line in lines(findings)[:MOST_ROWS]]
    said = [f"### cosim check {verdict(findings)}", "", markdown_table(_HEADINGS, rows, right=_NUMBERS), ""]
    wrong = _wrong(findings)
    for one in wrong[:MOST_FAILURES]:
        said += [f"**{_escaped(one.criterion_id)}**", "", "```", *details(one), "```", ""]
    if len(wrong) > MOST_FAILURES:
        said += [f"… and {len(wrong) - MOST_FAILURES} more in criteria.csv", ""]
    return "\n".join(said) + "\n"


def _wrong(findings: Sequence[Finding]) -> list[Finding]:
    """Return the findings to look into: one for each invalid run, and all that failed."""
    invalid = [one for one in findings if one.invalid and (one.metric == VALID or one.seed is None)]
    return invalid + [one for one in findings if one.failed]


def _cells(line: Line) -> list[str]:
    numbers = (line.judged, line.passed, line.failed, line.not_counted, line.invalid)
    return [line.target, line.criterion, *map(str, numbers), line.worst_text]


def _escaped(text: str) -> str:
    return text.replace("<", "&lt;").replace("\n", " ")
