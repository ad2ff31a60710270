"""Suites, their cases, and verdicts that depend on one another."""

from __future__ import annotations

import subprocess
import sys

import pytest

from analysis.protocols.impact import Impact, Measured
from analysis.protocols.verdict import Demand, Verdict, decide
from cosim.cli import main as cosim
from cosim.errors import InputError
from cosim.suites import judging
from cosim.suites.judging import Case, settled
from tests.cosim.cli.commands import source_environment


def hit(case: Case, kmh: float) -> Verdict:
    """Return the verdict on a contact of this speed."""
    demand = Demand(case.group.rule, case.ego_speed_kmh, case.highest_impact_kmh)
    impact = Impact(5.0, kmh / 3.6, kmh / 3.6, 0.0, 1.8, "front")
    return decide(Measured(impact, False, False, 4.0, True), demand)


def test_slower_pedestrians_are_held_against_the_standard_case() -> None:
    (standard,) = judging.cases("euroncap2026/cpna_50_60kmh")
    (slower,) = judging.cases("euroncap2026/cpna_50_slower_60kmh")
    judged = [(case, hit(case, 12.0)) for case in (standard, slower)]
    assert [verdict.passed for _, verdict in judged] == [False, False]
    assert [verdict.passed for _, verdict in settled(judged)] == [False, True]


@pytest.mark.parametrize(
    ("suite", "said"), [("fmvs127", "did you mean 'fmvss127'"), ("fmvss127/nothing", "no such case")]
)
def test_a_suite_or_case_that_does_not_exist_is_answered_by_what_does(suite: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        judging.cases(suite)


def test_the_program_of_earlier_versions_says_what_took_its_place() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "cosim.suites", "fmvss127"],
        env=source_environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("cosim: suites are checked by cosim check suite:NAME")
    assert done.stderr.count("\n") == 1


def test_suites_and_their_cases_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cosim(["list", "suites"]) == 0
    listed = capsys.readouterr().out
    assert all(f"suite:{name}" in listed for name in judging.names())
    assert cosim(["list", "suite:unr152"]) == 0
    listed = capsys.readouterr().out
    assert all(case.reference in listed for case in judging.cases("unr152"))
    assert cosim(["list", "suite:unr15"]) == 2
    assert "did you mean" in capsys.readouterr().err
