"""Indices of a function whose variance is known."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.search.axes import Axis, point
from analysis.search.sensitivity import influences

AXES = (Axis("much"), Axis("little"), Axis("nothing"))


def test_the_indices_are_the_shares_of_the_variance() -> None:
    drawn = np.random.default_rng(1).random((400, 3))
    points = [point(AXES, row) for row in drawn]
    # Variances of 2 x and x are 4 and 1 parts of 5.
    margins = [2.0 * float(one["much"]) + float(one["little"]) for one in points]
    found = influences(AXES, points, margins)
    assert [one.axis for one in found] == ["much", "little", "nothing"]
    assert [one.first_order for one in found] == pytest.approx([0.8, 0.2, 0.0], abs=0.06)
    assert all(0.0 < one.half_width < 0.15 for one in found)


def test_too_few_trials_and_margins_that_are_all_the_same_have_none() -> None:
    points = [point(AXES, [0.1, 0.2, 0.3])] * 50
    assert influences(AXES, points[:10], [0.5] * 10) == []
    assert influences(AXES, points, [0.5] * 50) == []
