"""The results of the suite as a table, for the terminal and for a file."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version

from analysis.markdown import table
from cosim.conformance.case import Result, Values

HEADINGS = ("case", "claim", "expected", "measured", "control, which must fail", "verdict")


def sumo_version() -> str:
    """Return the version of the installed libsumo."""
    return version("libsumo")


def table_rows(results: Sequence[Result]) -> list[tuple[str, ...]]:
    """Return one row per case with the columns of `HEADINGS`."""
    return [
        (
            result.case.key,
            result.case.name,
            result.case.expected,
            described(result.measured),
            f"{result.case.control_expected} -> {described(result.control_measured)}",
            result.verdict,
        )
        for result in results
    ]


def summary(results: Sequence[Result]) -> str:
    """Return one line: how many cases are green, and which are not."""
    failures = [result.case.key for result in results if not result.green]
    expected = [result.case.key for result in results if result.green and result.case.expected_failure]
    text = f"libsumo {sumo_version()}: {len(results) - len(failures)} of {len(results)} cases green"
    if expected:
        text += f", among them expected failures: {', '.join(expected)}"
    return text + (f"; not green: {', '.join(failures)}" if failures else "")


def markdown(results: Sequence[Result]) -> str:
    """Return the table and its summary as Markdown."""
    return f"{summary(results)}.\n\n{table(HEADINGS, table_rows(results))}\n"


def described(values: Values) -> str:
    """Return measured values in one line; the return code is shown only if it is not 0."""
    return ", ".join(
        f"{name} = {_number(value)}" for name, value in values.items() if (name, value) != ("return_code", 0)
    )


def _number(value: float | str) -> str:
    if isinstance(value, str):
        return value or "none"
    if float(value).is_integer():
        return str(int(value))
    return "0" if abs(value) < 0.0005 else f"{value:.3f}"
