"""Closed forms against values that can be derived by hand, against shapely, and their invariances."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analysis.encounters.prediction import required_deceleration
from analysis.geometry import clearance, closest_approach, time_to_contact, to_frame
from tests.analysis.judges import uniform_motion
from tests.analysis.judges.agreement import Judge
from tests.analysis.judges.conflict_areas import conflict_area_instants
from tests.analysis.judges.recorded_rides import curved_rides

CAR = (2.25, 0.9)

near = st.floats(-40.0, 40.0)
slow = st.floats(-15.0, 15.0).map(lambda speed: round(speed, 3))


def test_head_on_the_time_is_the_gap_over_the_closing_speed() -> None:
    assert time_to_contact(20.0, 0.0, -10.0, 0.0, *CAR, 0.3) == pytest.approx(1.745, abs=1e-12)


@pytest.mark.parametrize("closing", [0.0, -3.0])
def test_equal_velocities_and_receding_never_touch(closing: float) -> None:
    assert time_to_contact(20.0, 0.0, -closing, 0.0, *CAR, 0.3) == np.inf


def test_a_disc_inside_the_rectangle_touches_now() -> None:
    assert time_to_contact(0.5, 0.1, 1.0, 1.0, *CAR, 0.3) == 0.0


def test_grazing_is_contact_and_a_nanometre_further_out_is_none() -> None:
    graze = CAR[1] + 0.3
    # The corner is met at a right angle to its surface: rounding by 1e-16 m moves the instant by 1e-9 s.
    assert time_to_contact(20.0, graze, -10.0, 0.0, *CAR, 0.3) == pytest.approx(1.775, abs=1e-8)
    assert time_to_contact(20.0, graze + 1e-9, -10.0, 0.0, *CAR, 0.3) == np.inf


def test_a_walker_from_the_right_is_hit_by_the_side_when_they_reach_the_strip() -> None:
    ttc = time_to_contact(32.5, -5.0, -10.0, 1.25, *CAR, 0.25)
    assert ttc == pytest.approx(3.08, abs=1e-12)


@pytest.mark.parametrize(
    ("speed", "distance", "time", "needed"),
    [(10, 30, 4, 1.25), (10, 20, 4, 2.5), (10, 15, 4, 10 / 3), (10, 10, 10, 5.0), (10, 30, 4.92, 1.5864)],
)
def test_the_deceleration_has_three_branches(
    speed: float, distance: float, time: float, needed: float
) -> None:
    found = required_deceleration(np.array([speed]), np.array([distance]), np.array([time]))
    assert found[0] == pytest.approx(needed, abs=5e-5)


def test_after_a_reaction_time_more_deceleration_is_needed() -> None:
    found = required_deceleration(np.array([10.0]), np.array([20.0]), np.array([3.92]))
    assert found[0] == pytest.approx(2.4990, abs=5e-5)


@pytest.mark.long
@pytest.mark.parametrize(
    ("judge", "count", "bound"),
    [
        (uniform_motion.time_to_contact, 1000, 1e-9),
        (uniform_motion.predicted_distance, 600, 1e-9),
        (uniform_motion.distance_between_samples, 600, 1e-9),
        (uniform_motion.rectangle_overlap, 4000, 0.0),
        (conflict_area_instants, 20, 0.005),
    ],
)
def test_shapely_agrees(judge: Judge, count: int, bound: float) -> None:
    found = judge(count)
    assert found.disagreements == 0
    assert found.defined >= count / 5
    assert found.largest <= bound


@pytest.mark.parametrize(("step", "bound"), [(0.1, 0.005), (1.0, 0.02)])
def test_shapely_agrees_on_curved_rides_at_any_step(step: float, bound: float) -> None:
    assert curved_rides(step, 6).largest <= bound


def test_the_deceleration_is_what_a_search_over_braking_finds() -> None:
    found = uniform_motion.braking()
    assert found.largest <= 1e-6


@pytest.mark.long
@settings(max_examples=300, deadline=None)
@given(near, near, slow, slow, st.floats(-np.pi, np.pi), near, near)
def test_turning_and_moving_the_world_changes_nothing(
    x: float, y: float, u: float, w: float, turn: float, shift_x: float, shift_y: float
) -> None:
    cos, sin = np.cos(turn), np.sin(turn)
    ego = np.array([shift_x, shift_y])
    person = ego + np.array([cos * x - sin * y, sin * x + cos * y])
    way = person - ego
    back = to_frame(way[0], way[1], turn)
    motion = to_frame(cos * u - sin * w, sin * u + cos * w, turn)
    here = closest_approach(x, y, u, w, *CAR, 0.25)
    there = closest_approach(back[0], back[1], motion[0], motion[1], *CAR, 0.25)
    assert there[0] == pytest.approx(here[0], abs=1e-9)
    graze = abs(float(here[0])) < 1e-6
    before, after = time_to_contact(x, y, u, w, *CAR, 0.25), time_to_contact(*back, *motion, *CAR, 0.25)
    assert graze or (np.isinf(before) and np.isinf(after)) or after == pytest.approx(before, abs=1e-6)


@settings(max_examples=300, deadline=None)
@given(near, near, slow, slow, st.floats(0.01, 1.0))
def test_the_time_to_contact_shrinks_by_the_time_that_passes(
    x: float, y: float, u: float, w: float, step: float
) -> None:
    now = float(time_to_contact(x, y, u, w, *CAR, 0.25))
    if not step < now < 100.0:
        return
    later = float(time_to_contact(x + u * step, y + w * step, u, w, *CAR, 0.25))
    least = float(closest_approach(x, y, u, w, *CAR, 0.20)[0])
    if least < 1e-4:  # deeper than a graze, which rounding may turn into a miss
        assert later == pytest.approx(now - step, abs=1e-6)


@settings(max_examples=300, deadline=None)
@given(near, near, slow, slow)
def test_the_predicted_distance_is_reached_at_its_time(x: float, y: float, u: float, w: float) -> None:
    distance, when = closest_approach(x, y, u, w, *CAR, 0.25)
    there = clearance(x + u * when, y + w * when, *CAR, 0.25)
    assert there == pytest.approx(float(distance), abs=1e-9)
    for share in (0.0, 0.5, 0.9, 1.1, 2.0):
        elsewhere = clearance(x + u * when * share, y + w * when * share, *CAR, 0.25)
        assert elsewhere >= distance - 1e-9
