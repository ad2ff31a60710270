"""Whom an ego would meet that keeps its speed."""

from __future__ import annotations

import pytest

from controllers.interface import Decision, Manoeuvre
from controllers.yielding.facing import PathWatch
from tests.controllers.scenes import FRONT, Walker, ego, perception, straight_road

AHEAD, PACE, SPEED, MARGIN = 30.0, 1.4, 10.0, 0.8
SIDE_MARGIN = 0.3


def met(across: float, pace: float) -> list[bool]:
    """Return whom an ego at 10 m/s meets, of somebody 30 m ahead."""
    scene = perception(ego(SPEED), straight_road(), [Walker(AHEAD, across, 0.0, pace)])
    facing = PathWatch(SIDE_MARGIN, 1.0).look(scene, Decision(Manoeuvre.KEEP, 0), 0.0)
    return [bool(one) for one in facing.meets(MARGIN)]


@pytest.mark.parametrize(("early", "expected"), [(0.05, [True]), (-0.05, [False])])
def test_who_enters_within_the_margin_after_the_ego_has_left_is_met(
    early: float, expected: list[bool]
) -> None:
    body = ego(SPEED).body
    leaves = (AHEAD + 0.25 + body.rear_overhang) / SPEED
    # Half the body, the margin at its side and the disc of 0.25 m.
    reach = 0.5 * body.width + SIDE_MARGIN + 0.25
    assert met(-reach - PACE * (leaves + MARGIN - early), PACE) == expected


@pytest.mark.parametrize(("late", "expected"), [(0.05, [True]), (-0.05, [False])])
def test_who_leaves_within_the_margin_before_the_ego_comes_is_met(late: float, expected: list[bool]) -> None:
    body = ego(SPEED).body
    arrives = (AHEAD - 0.25 - FRONT) / SPEED
    reach = 0.5 * body.width + SIDE_MARGIN + 0.25
    assert met(reach - PACE * (arrives - MARGIN + late), PACE) == expected
