"""The emergency brake: how far it needs, when it acts, when it lets go."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers import catalog
from controllers.interface import EgoState, Perception
from controllers.safety.emergency_braking import stopping_distance
from cosim.step.plant import CAR_DRIVE
from tests.controllers.drives import drive
from tests.controllers.scenes import FRONT, Car, Walker, ego, perception, straight_road, zebra

IDEAL = replace(CAR_DRIVE, drive_lag=0.0, steering_lag=0.0)
BOTH_SPEEDS = pytest.mark.parametrize(("kilometres_per_hour", "distance"), [(40.0, 10.08), (50.0, 15.07)])


@BOTH_SPEEDS
def test_the_closed_form_gives_the_paper_s_distances(kilometres_per_hour: float, distance: float) -> None:
    # The paper's numbers follow with g = 9.8 m/s^2.
    found = stopping_distance(kilometres_per_hour / 3.6, 0.8 * 9.8, 0.1, 0.2)
    assert found == pytest.approx(distance, abs=0.005)


@BOTH_SPEEDS
@pytest.mark.parametrize("interval", [0.05, 0.1, 0.5, 1.0])
def test_the_simulated_brake_stops_within_the_paper_s_distances(
    kilometres_per_hour: float, distance: float, interval: float
) -> None:
    # The road's limit is the speed, so that the driver keeps it during the dead time.
    speed = kilometres_per_hour / 3.6

    def scene(state: EgoState, travelled: float) -> Perception:
        walker = Walker(FRONT + distance + 0.4 - travelled, 0.0)
        return perception(state, straight_road(limit=speed), walkers=[walker])

    rows = drive(catalog.build("aeb"), scene, speed, 6.0, interval, IDEAL)
    assert rows[-1, 3] == 0.0
    assert rows[-1, 1] == pytest.approx(distance, abs=0.02)
    assert rows[-1, 1] <= distance


def test_a_stop_within_the_ramp_has_its_own_distance() -> None:
    full, ramp = 8.0, 0.2
    border = 0.5 * full * ramp
    assert stopping_distance(border - 1e-9, full, 0.1, ramp) == pytest.approx(
        stopping_distance(border, full, 0.1, ramp), abs=1e-6
    )
    assert stopping_distance(0.0, full, 0.1, ramp) == 0.0


@pytest.mark.parametrize(
    ("interval", "speed", "distance"),
    [
        (0.05, 13.0, 30.0),
        (0.1, 8.0, 30.0),
        (0.1, 13.0, 60.0),
        (0.5, 8.0, 60.0),
        (0.5, 13.0, 30.0),
        (1.0, 8.0, 30.0),
        (1.0, 13.0, 60.0),
    ],
)
def test_a_pedestrian_who_stands_in_the_path_is_not_touched_and_left_when_they_are_gone(
    distance: float, speed: float, interval: float
) -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        walkers = [Walker(distance - travelled, 0.2)] if state.time < 20.0 else []
        return perception(state, walkers=walkers)

    rows = drive(catalog.build("aeb"), scene, speed, 32.0, interval)
    waiting = rows[(rows[:, 0] < 20.0) & (rows[:, 0] > 17.0)]
    clearance = distance - 0.25 - FRONT - rows[rows[:, 0] < 20.0, 1]
    assert clearance.min() > 0.2
    assert waiting[:, 3].max() < 0.01
    assert clearance[-1] < 5.0
    assert rows[-1, 3] > 10.0
    assert rows[:, 4].min() < -6.5


def test_a_pedestrian_who_waits_at_a_zebra_is_not_yielded_to() -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        walker = Walker(50.0 - travelled, -5.0, crossing=0, waiting=True)
        return perception(state, walkers=[walker], crossings=[zebra(48.0 - travelled)])

    rows = drive(catalog.build("aeb"), scene, 13.0, 6.0)
    assert rows[:, 3].min() > 12.9


def test_a_pedestrian_who_steps_in_front_is_braked_for_only_late() -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        walker = Walker(45.0 - travelled, -4.5 + 1.3 * state.time, 0.0, 1.3, 0, True)
        return perception(state, walkers=[walker], crossings=[zebra(43.0 - travelled)])

    rows = drive(catalog.build("aeb"), scene, 13.0, 15.0)
    first = rows[np.argmax(rows[:, 4] < -1.0)]
    assert 45.0 - FRONT - first[1] < 25.0
    assert rows[:, 4].min() < -7.0
    inside = np.abs(-4.5 + 1.3 * rows[:, 0]) < 0.9 + 0.25
    assert (45.0 - 0.25 - FRONT - rows[inside, 1]).min() > 0.0
    assert rows[-1, 3] > 8.0


def test_a_vehicle_cutting_in_is_braked_for() -> None:
    controller = catalog.build("aeb")
    seen = perception(ego(13.0), cars=[Car(FRONT + 4.5 + 6.0, 2.2, 4.0, across_speed=-1.5)])
    decision = controller.decide(seen)
    assert decision.because == "car0"


def test_an_oncoming_vehicle_beside_the_lane_is_not_braked_for() -> None:
    controller = catalog.build("aeb")
    seen = perception(ego(13.0), cars=[Car(20.0, 3.5, -13.0, heading_error=3.1)])
    assert controller.decide(seen).because == ""


@pytest.mark.parametrize("turned", [-0.3, 0.3])
@pytest.mark.parametrize(
    ("distance", "ahead", "braked"), [(12.0, True, True), (12.0, False, False), (24.0, True, False)]
)
def test_whoever_is_ahead_of_a_turned_body_is_braked_for_in_time_and_not_who_is_beside(
    turned: float, distance: float, ahead: bool, braked: bool
) -> None:
    """Where the car points to, or as far on the other side; it needs 19.1 m, and 3.9 m are its own."""
    x, y = distance * math.cos(turned), distance * math.sin(turned)
    seen = perception(ego(13.0, heading_error=turned), walkers=[Walker(x, y if ahead else -y)])
    assert (catalog.build("aeb").decide(seen).because == "person0") is braked


@pytest.mark.parametrize(("across", "braked"), [(2.4, True), (2.9, False)])
def test_a_standing_vehicle_that_juts_into_the_way_is_braked_for_whichever_way_it_faces(
    across: float, braked: bool
) -> None:
    # A van that waits to turn left across the ego's lane: 6.5 m long, 2.2 m wide, turned by 10 degrees.
    van = Car(15.0, across, 0.0, heading_error=-2.97, length=6.5, width=2.2)
    controller = catalog.build("aeb")
    assert (controller.decide(perception(ego(13.0), cars=[van])).because == "car0") is braked


@pytest.mark.long
@settings(deadline=None, max_examples=150)
@given(
    speed=st.floats(0.0, 40.0),
    places=st.lists(
        st.tuples(st.floats(-20.0, 60.0), st.floats(-8.0, 8.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)),
        max_size=5,
    ),
    interval=st.sampled_from([0.05, 0.1, 1.0]),
)
def test_whoever_is_around_the_command_is_finite_and_possible(
    speed: float, places: list[tuple[float, float, float, float]], interval: float
) -> None:
    controller = catalog.build("aeb")
    walkers = [Walker(*place) for place in places]
    for step in range(3):
        seen = perception(ego(speed, plan_interval=interval, time=step * interval), walkers=walkers)
        command = controller.plan(seen, controller.decide(seen)).command
        assert np.isfinite(command.acceleration).all()
        assert np.isfinite(command.steering).all()
        assert command.acceleration.min() >= -seen.ego.drive.max_deceleration
