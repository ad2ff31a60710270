"""What sensors told an ego, and how its encounters are judged by it; scenes that can be derived by hand."""

from __future__ import annotations

import operator
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from analysis.errors import RecordingError
from analysis.recording.columns import SENSING
from analysis.results.analyse import analyse_run
from tests.analysis.recorded import Ego, Person, line, write_run

Told = Callable[[float], bool]


def _run(folder: Path, told: Told | None, ego_x: float = -20.0) -> Path:
    """Write a run: 10 m/s east along y = 0, and a child who crosses x = 32.5 m at 1 m/s from y = -4 m."""
    sensing = "perfect" if told is None else "onboard"
    # The front bumper is 2.25 m ahead of the middle, so it is at the child's disc at 5.0 s for x = -20 m.
    write_run(
        folder, [Ego(line(ego_x, 0.0, 10.0, 0.0))], [Person(line(32.5, -5.2, 0.0, 1.0))], sensing=sensing
    )
    if told is not None:
        _write_sensing(folder, [(0.1 * k, told(0.1 * k)) for k in range(101)])
    return folder


def _write_sensing(folder: Path, seen: list[tuple[float, bool]]) -> None:
    rows = [
        {
            "time_s": round(time, 6),
            "ego_id": "ego",
            "object_id": "ped",
            "told": told,
            "state": "visible" if told else "hidden",
            "age_s": 0.0 if told else None,
            "error_m": 0.1 if told else None,
            "uncertainty_m": 0.1 if told else None,
        }
        for time, told in seen
    ]
    pq.write_table(pa.Table.from_pylist(rows, schema=SENSING.schema), folder / "sensing.parquet")


def _row(folder: Path) -> dict[str, Any]:
    (row,) = analyse_run(folder).encounters
    return dict(row)


def test_the_time_for_which_they_were_visible_ends_with_the_contact(tmp_path: Path) -> None:
    row = _row(_run(tmp_path / "late", lambda t: t > 4.05))
    assert row["collision"]
    assert row["visible_before_conflict_s"] == pytest.approx(row["t_collision_s"] - 4.1)


def test_without_a_contact_it_ends_when_the_second_of_the_two_enters(tmp_path: Path) -> None:
    # One second later than the child's way through the ego's path ends.
    row = _row(_run(tmp_path / "later", lambda t: t > 4.05, ego_x=-50.0))
    assert not row["collision"]
    # The front bumper is at the near side of the disc, x = 32.25 m.
    assert row["visible_before_conflict_s"] == pytest.approx(8.0 - 4.1, abs=0.06)


def test_a_break_begins_the_time_again(tmp_path: Path) -> None:
    row = _row(_run(tmp_path / "broken", lambda t: not 3.55 < t < 4.45))
    assert row["visible_before_conflict_s"] == pytest.approx(row["t_collision_s"] - 4.5)


def test_who_is_hidden_at_the_conflict_was_visible_for_no_time(tmp_path: Path) -> None:
    assert _row(_run(tmp_path / "hidden", lambda t: t < 3.0))["visible_before_conflict_s"] == 0.0
    assert _row(_run(tmp_path / "never", lambda t: False))["visible_before_conflict_s"] == 0.0


def test_with_perfect_sensing_there_is_nothing_to_say(tmp_path: Path) -> None:
    assert _row(_run(tmp_path / "perfect", None))["visible_before_conflict_s"] is None


def test_a_careful_driver_sees_with_their_own_eyes(tmp_path: Path) -> None:
    told = [
        _row(_run(tmp_path / f"{since}", partial(operator.le, since - 1e-9))) for since in (0.0, 3.1, 3.5)
    ]
    never = _row(_run(tmp_path / "never", lambda t: False))
    perfect = _row(_run(tmp_path / "perfect", None))
    assert {row["preventable_r157"] for row in (*told, never, perfect)} == {True}


def test_when_they_entered_is_not_a_matter_of_sensing(tmp_path: Path) -> None:
    rows = [_row(_run(tmp_path / "a", None)), _row(_run(tmp_path / "b", lambda t: False))]
    assert rows[0]["late_entry"] == rows[1]["late_entry"]
    assert rows[0]["min_dist_m"] == rows[1]["min_dist_m"]


def test_a_run_that_lost_its_sensing_is_refused(tmp_path: Path) -> None:
    folder = _run(tmp_path / "run", lambda t: True)
    (folder / "sensing.parquet").unlink()
    with pytest.raises(RecordingError, match=r"sensing\.parquet: no such file"):
        analyse_run(folder)


def test_two_rows_of_one_pair_and_instant_are_refused(tmp_path: Path) -> None:
    folder = _run(tmp_path / "run", lambda t: True)
    _write_sensing(folder, [(0.1, True), (0.1, False)])
    with pytest.raises(RecordingError, match=r"'ego', 'ped' has a second row at 0\.1 s"):
        analyse_run(folder)
