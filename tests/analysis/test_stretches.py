"""Unbroken runs of True."""

import numpy as np
import pytest

from analysis.stretches import stretches


@pytest.mark.parametrize(
    ("marks", "found"),
    [("", []), ("0", []), ("1", [(0, 0)]), ("1101", [(0, 1), (3, 3)]), ("0110", [(1, 2)]), ("111", [(0, 2)])],
)
def test_each_run_has_its_first_and_its_last_index(marks: str, found: list[tuple[int, int]]) -> None:
    assert stretches(np.array([mark == "1" for mark in marks], dtype=np.bool_)) == found
