"""Pedestrians whom another vehicle hides from the driver before a conflict."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.results.analyse import analyse_run
from tests.analysis.recorded import Ego, Person, Vehicle, line, write_run

# At 10 m/s the ego strikes somebody who steps out at x = 32.5 m after 3 s.
EGO, STRUCK = Ego(line(0, 0, 10, 0)), Person(line(32.5, -5.2, 0, 1.5))
PARKED = {
    "nobody": [],
    "between": [Vehicle(line(27, -3.2, 0, 0))],
    "on the other side": [Vehicle(line(27, 3.2, 0, 0))],
    "between, but gone 2 s before": [Vehicle(line(27, -3.2, 0, 0), end=0.8)],
}


@pytest.mark.parametrize("parked", PARKED)
def test_who_is_hidden_in_the_last_seconds_is_told_from_who_is_not(parked: str, tmp_path: Path) -> None:
    hidden = parked == "between"
    report = analyse_run(write_run(tmp_path, [EGO], [STRUCK], PARKED[parked], duration=5.0))
    (row,) = report.encounters
    assert row["severity"] == "collision"
    assert row["hidden_before_conflict"] == hidden
    assert report.run["n_hidden_before_conflict"] == int(hidden)


def test_without_a_conflict_nothing_is_said(tmp_path: Path) -> None:
    late = Person(line(32.5, -20.0, 0, 1.5))
    report = analyse_run(write_run(tmp_path, [EGO], [late], PARKED["between"], duration=20.0))
    assert [row["hidden_before_conflict"] for row in report.encounters] == [None]
    assert report.run["n_hidden_before_conflict"] == 0
