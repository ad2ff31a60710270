"""Lane changes for the route, and the gaps they need."""

from __future__ import annotations

import numpy as np
import pytest

from controllers import catalog
from controllers.driving.lanes.gap_acceptance import blocker
from controllers.driving.lanes.lane_choice import LaneChoice
from controllers.driving.lanes.lane_for_route import lane_for_route
from controllers.interface import EgoState, Manoeuvre, Perception, RoadAhead
from tests.controllers.drives import Scene, drive
from tests.controllers.scenes import (
    FRONT,
    LANE_WIDTH,
    Car,
    ego,
    lanes_that_follow,
    perception,
    straight_road,
    zebra,
)

REAR = FRONT - ego().body.length


def _ending(lanes: int = 2, reference: int = 0, **distances: float) -> RoadAhead:
    named = {int(key.removeprefix("lane")): value for key, value in distances.items()}
    return lanes_that_follow(straight_road(lanes, reference), named)


def test_a_lane_that_serves_the_route_is_kept() -> None:
    assert LaneChoice().choose(perception(road=straight_road(3, 1))) == (1, "")


def test_a_lane_that_ends_soon_is_left() -> None:
    assert LaneChoice().choose(perception(road=_ending(lane0=80.0))) == (1, "lane end")
    assert LaneChoice().choose(perception(road=_ending(reference=1, lane1=80.0))) == (0, "lane end")


def test_a_lane_that_ends_far_away_is_kept_for_now() -> None:
    assert LaneChoice().choose(perception(road=_ending(lane0=400.0))) == (0, "")


def test_a_lane_end_beyond_the_route_s_end_does_not_matter() -> None:
    assert lane_for_route(perception(road=_ending(lane0=80.0))) == 1
    assert lane_for_route(perception(road=_ending(1, lane0=80.0))) is None


def test_several_changes_lead_to_the_side_where_there_are_more_lanes() -> None:
    # Five lanes, the ego in the second; only the leftmost goes on, and it is out of view.
    road = _ending(5, 1, lane0=150.0, lane1=150.0, lane2=150.0)
    assert lane_for_route(perception(road=road)) == 2
    road = _ending(5, 3, lane2=150.0, lane3=150.0, lane4=150.0)
    assert lane_for_route(perception(road=road)) == 2


def test_a_lane_that_serves_the_route_worse_is_never_changed_to() -> None:
    # The right lane turns with the route and ends an edge later, the left one ends at this junction.
    assert lane_for_route(perception(road=_ending(lane0=200.0, lane1=80.0))) is None
    assert lane_for_route(perception(road=_ending(reference=1, lane0=200.0, lane1=80.0))) == 0


def test_lanes_that_differ_by_a_bend_s_width_end_at_the_same_place() -> None:
    # Four lanes, the ego in the second; the fourth goes on, and the first is longer by the bend alone.
    road = _ending(4, 1, lane0=105.0, lane1=100.0, lane2=95.0)
    assert lane_for_route(perception(road=road)) == 2


@pytest.mark.parametrize(
    "car",
    [
        Car(FRONT + 0.5, LANE_WIDTH, 13.0),  # beside
        Car(FRONT + 4.5 + 10.0, LANE_WIDTH, 13.0),  # ahead, nearer than 2.5 m + 1 s
        Car(FRONT + 4.5 + 30.0, LANE_WIDTH, 2.0),  # ahead, much slower
        Car(-10.0, LANE_WIDTH, 13.0),  # behind, too near
        Car(-30.0, LANE_WIDTH, 22.0),  # behind, much faster
        Car(REAR - 2.0, LANE_WIDTH, 0.2),  # behind, creeping up
        Car(REAR - 0.2, LANE_WIDTH, 0.0),  # behind, so near that it is rather beside
        Car(FRONT, 2 * LANE_WIDTH, 13.0, across_speed=-1.0),  # comes over from the third lane
    ],
)
def test_no_change_is_begun_into_a_gap_that_is_too_small(car: Car) -> None:
    seen = perception(road=_ending(3, 0, lane0=80.0), cars=[car])
    assert blocker(seen, 1) == "car0"
    assert LaneChoice().choose(seen) == (0, "car0")


@pytest.mark.parametrize(
    "car",
    [
        Car(FRONT + 4.5 + 16.0, LANE_WIDTH, 13.0),
        Car(-17.0, LANE_WIDTH, 13.0),
        Car(REAR - 0.5, LANE_WIDTH, 0.0),  # stands: it may be letting the ego in
    ],
)
def test_a_change_is_begun_when_the_gaps_are_large_enough(car: Car) -> None:
    seen = perception(road=_ending(lane0=80.0), cars=[car])
    assert blocker(seen, 1) is None


def test_a_lane_that_does_not_exist_is_no_target() -> None:
    assert blocker(perception(), 7) == "no such lane"


def test_a_change_persists_while_the_reference_lane_becomes_another() -> None:
    choice = LaneChoice()
    assert choice.choose(perception(road=_ending(lane0=80.0)))[0] == 1
    assert choice.choose(perception(ego(across=1.0), road=_ending(lane0=70.0)))[0] == 1
    arrived = lanes_that_follow(straight_road(2, 1), {0: 60.0})
    assert choice.choose(perception(ego(across=-1.6), road=arrived)) == (1, "")


def test_a_change_is_given_up_when_somebody_jumps_into_the_gap() -> None:
    controller = catalog.build("aeb")
    assert controller.decide(perception(road=_ending(lane0=80.0))).manoeuvre is Manoeuvre.CHANGE_LEFT
    jumped = perception(ego(across=0.8), road=_ending(lane0=75.0), cars=[Car(1.0, LANE_WIDTH, 13.0)])
    decision = controller.decide(jumped)
    assert (decision.manoeuvre, decision.target_lane, decision.because) == (Manoeuvre.ABORT_CHANGE, 0, "car0")
    assert controller.decide(jumped).manoeuvre is Manoeuvre.KEEP


def in_its_lane(state: EgoState, interval: float = 0.1) -> tuple[int, EgoState]:
    """Return the lane that the ego is in, and its state relative to that lane."""
    reference = int(state.across > 0.5 * LANE_WIDTH)
    return reference, ego(
        state.speed, state.across - reference * LANE_WIDTH, state.heading_error, interval, state.time,
        state.acceleration, state.steering,
    )  # fmt: skip


def behind_a_standing_vehicle(rear: float, blocked_until: float, width: float = 1.8) -> Scene:
    """Return the scene of an ego behind a vehicle in its lane; up to a time, another one keeps beside it."""

    def scene(state: EgoState, travelled: float) -> Perception:
        reference, seen = in_its_lane(state)
        cars = [Car(rear + 4.5 - travelled, -reference * LANE_WIDTH, 0.0, width=width)]
        if state.time < blocked_until:
            cars.append(Car(2.0, (1 - reference) * LANE_WIDTH, state.speed))
        return perception(seen, straight_road(2, reference), cars=cars)

    return scene


@pytest.mark.parametrize("interval", [0.1, 1.0])
def test_the_aeb_driver_leaves_an_ending_lane_in_time(interval: float) -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        reference, seen = in_its_lane(state, interval)
        road = lanes_that_follow(straight_road(2, reference), {0: 160.0 - travelled})
        return perception(seen, road)

    rows = drive(catalog.build("aeb"), scene, 12.0, 15.0, interval)
    assert rows[-1, 2] == pytest.approx(LANE_WIDTH, abs=0.1)
    assert rows[:, 3].min() > 6.0
    assert rows[np.argmax(rows[:, 2] > LANE_WIDTH - 0.3), 1] < 160.0


def test_a_driver_that_finds_no_gap_stops_before_the_lane_ends_and_goes_on_when_there_is_one() -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        reference, seen = in_its_lane(state)
        road = lanes_that_follow(straight_road(2, reference), {0: 120.0 - travelled})
        blocking = [Car(2.0, (1 - reference) * LANE_WIDTH, state.speed)] if state.time < 30.0 else []
        return perception(seen, road, cars=blocking)

    rows = drive(catalog.build("aeb"), scene, 12.0, 60.0)
    waiting = rows[rows[:, 0] < 30.0]
    assert waiting[-1, 3] == pytest.approx(0.0, abs=0.05)
    assert waiting[:, 1].max() + FRONT < 120.0
    assert rows[-1, 2] == pytest.approx(LANE_WIDTH, abs=0.1)
    assert rows[-1, 3] > 10.0


@pytest.mark.parametrize("blocked_until", [0.0, 25.0])
def test_the_aeb_driver_gets_around_a_standing_vehicle(blocked_until: float) -> None:
    rows = drive(catalog.build("aeb"), behind_a_standing_vehicle(120.0, blocked_until), 12.0, 45.0)
    assert rows[-1, 1] > 160.0
    # From far away, or from where it waits with room to steer.
    beside = rows[(rows[:, 1] + FRONT > 120.0) & (rows[:, 1] - 0.95 < 124.5)]
    # The bodies are 1.8 m wide each; the ego's corner moves with its heading, which is small by then.
    assert beside[:, 2].min() > 1.8
    assert rows[:, 4].min() > -5.0


@pytest.mark.long
@pytest.mark.parametrize("rear", [40.0, 60.0])
def test_vo_mpc_sets_out_to_pass_a_standing_vehicle_once_it_has_waited(rear: float) -> None:
    """The vehicle counts only until its lane is left: waiting for that instant, the ego never set out."""
    rows = drive(catalog.build("vo_mpc"), behind_a_standing_vehicle(rear, 20.0, width=2.5), 0.0, 40.0)
    assert rows[rows[:, 0] < 20.0, 1].max() + FRONT < rear
    assert rows[-1, 1] > rear + 50.0


@pytest.mark.parametrize("gap", [3.0, 4.5, 7.0])
def test_a_car_that_stands_close_behind_swings_out_without_touching(gap: float) -> None:
    rear = FRONT + gap
    rows = drive(catalog.build("aeb"), behind_a_standing_vehicle(rear, 0.0, width=2.2), 0.0, 20.0)
    assert rows[-1, 1] > rear + 20.0
    headings = np.arctan2(np.gradient(rows[:, 2]), np.maximum(np.gradient(rows[:, 1]), 1e-9))
    for (_, along, across, _, _), heading in zip(rows, headings, strict=True):
        # The right flank against the left rear corner, and the right front corner against the left side.
        corner = across + FRONT * np.sin(heading) - 0.9 * np.cos(heading)
        reached = along + FRONT * np.cos(heading) + 0.9 * np.sin(heading)
        assert reached < rear or reached > rear + 4.5 or corner > 1.1
        if along < rear < reached:
            flank = across + (rear - along) * np.tan(heading) - 0.9 / np.cos(heading)
            assert flank > 1.1


def test_a_car_in_an_equal_queue_keeps_its_lane() -> None:
    queue = [Car(FRONT + 30.0, 0.0, 5.0), Car(FRONT + 30.0, LANE_WIDTH, 5.0)]
    assert LaneChoice().choose(perception(ego(8.0), straight_road(2), cars=queue)) == (0, "")


def test_no_change_for_a_better_lane_begins_before_a_crossing() -> None:
    slow = [Car(FRONT + 30.0, 0.0, 5.0)]
    assert LaneChoice().choose(perception(ego(8.0), straight_road(2), cars=slow))[0] == 1
    near = perception(ego(8.0), straight_road(2), cars=slow, crossings=[zebra(30.0)])
    assert LaneChoice().choose(near) == (0, "")


def test_no_change_leads_into_a_lane_that_soon_leaves_the_route() -> None:
    slow = [Car(FRONT + 30.0, 0.0, 5.0)]
    assert LaneChoice().choose(perception(ego(8.0), _ending(lane1=100.0), cars=slow)) == (0, "")
