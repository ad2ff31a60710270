"""The table of verdicts as a file."""

from __future__ import annotations

from pathlib import Path

import pytest

from analysis.errors import AnalysisError
from analysis.protocols.impact import Impact, Measured
from analysis.protocols.verdict import Demand, Verdict, decide
from studies.protocols.table import COLUMNS, Row, read, write


def measured(kmh: float | None) -> Measured:
    impact = None if kmh is None else Impact(5.0, kmh / 3.6, kmh / 3.6, 0.0, 1.8, "front")
    return Measured(impact, False, False, 4.0, True)


def row(verdict: Verdict | None, note: str = "") -> Row:
    return Row("s", "c_30kmh", "c", "aeb", 1, 30.0, "somebody", "standard", verdict, note)


def test_rows_are_written_and_read(tmp_path: Path) -> None:
    green, brown = (decide(measured(kmh), Demand("green", 30.0)) for kmh in (None, 5.0))
    path = write(tmp_path, [row(green), row(brown), row(None, "time-out")])
    rows = read(path)
    assert tuple(rows[0]) == COLUMNS
    assert [one["colour"] for one in rows] == ["green", "brown", ""]
    assert [one["impact_speed_kmh"] for one in rows] == ["", "5.00", ""]
    assert [one["valid"] for one in rows] == ["1", "1", "0"]
    assert rows[2]["note"] == "time-out"
    path.write_text("suite,case\n")
    with pytest.raises(AnalysisError, match="other columns"):
        read(path)
