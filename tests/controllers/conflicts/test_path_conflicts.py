"""Who is in conflict with the ego's path, and when."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from controllers.conflicts.expected_behaviour import PedestrianAssumptions, Watch, expected
from controllers.conflicts.path_conflicts import STRAIGHT_ON, Conflicts
from controllers.interface import CrossingKind
from controllers.prediction.constant_velocity import ConstantVelocity
from controllers.prediction.forecast import Forecast
from tests.controllers.conflicts.found import (
    HORIZON,
    REACH,
    REAR,
    TIMES,
    found_among,
    on_zebra,
    position_bounds,
)
from tests.controllers.scenes import FRONT, Walker, ego, perception, straight_road, zebra


def test_the_overlap_begins_and_ends_where_the_grown_disc_meets_the_band() -> None:
    found = found_among([Walker(30.0, -1.75 - 2.6, 0.0, 1.3)])
    assert found.enter[0] == pytest.approx(2.0)
    assert found.leave[0] == pytest.approx(2.0 + 2 * REACH / 1.3)
    assert found.across_speed[0] == 1.3


def test_the_overlap_is_the_same_from_the_other_side() -> None:
    right, left = found_among([Walker(30.0, -4.0, 0.0, 1.1)]), found_among([Walker(30.0, 4.0, 0.0, -1.1)])
    assert right.enter[0] == pytest.approx(left.enter[0])
    assert right.leave[0] == pytest.approx(left.leave[0])


def test_somebody_in_the_band_has_entered_already_and_leaves_ahead() -> None:
    found = found_among([Walker(30.0, 0.0, 0.0, 1.0)])
    assert found.enter[0] == 0.0
    assert found.leave[0] == pytest.approx(REACH)


def test_whoever_walks_away_or_comes_later_than_the_horizon_is_no_conflict() -> None:
    assert len(found_among([Walker(30.0, -2.0, 0.0, -1.3)])) == 0
    assert len(found_among([Walker(30.0, -REACH - 1.3 * HORIZON - 0.1, 0.0, 1.3)])) == 0
    assert len(found_among([Walker(30.0, -REACH - 1.3 * HORIZON + 0.1, 0.0, 1.3)])) == 1


def test_conflicts_are_sorted_by_entry_and_ties_keep_their_order() -> None:
    walkers = [Walker(30.0, -8.0, 0.0, 1.3), Walker(40.0, 3.0, 0.0, -1.3), Walker(35.0, -3.0, 0.0, 1.3)]
    found = found_among(walkers)
    assert found.names == ("person1", "person2", "person0")
    assert found.index.tolist() == [1, 2, 0]
    assert (np.diff(found.enter) >= 0.0).all()


def test_somebody_behind_the_car_is_no_conflict_and_does_not_hide_who_is_ahead() -> None:
    behind = Walker(-3.0, 0.0, 3.0, 0.0)
    ahead = Walker(8.0, -3.0, 0.0, 1.3)
    found = found_among([], perception(ego(speed=0.0), walkers=[behind, ahead]))
    assert found.names == ("person1",)
    assert len(found_among([], perception(ego(speed=0.0), walkers=[replace(behind, along=8.0)]))) == 1


def test_somebody_who_waits_at_a_zebra_is_expected_to_cross_once_they_move() -> None:
    waiting = Walker(30.0, -5.0, 0.0, 0.0, 0, waiting=True)
    assert (
        len(found_among([], on_zebra([waiting]), assume=PedestrianAssumptions(yield_to_standing=False))) == 0
    )
    assert (
        len(found_among([], on_zebra([waiting]), assume=PedestrianAssumptions(yield_to_standing=True))) == 1
    )
    # Walking along the kerb counts as being about to turn, at no less than the assumed speed.
    found = found_among([], on_zebra([replace(waiting, along_speed=0.9)]))
    assert found.across_speed[0] == pytest.approx(1.2)
    from_left = found_among([], on_zebra([replace(waiting, across=5.0, along_speed=-1.5)]))
    assert from_left.across_speed[0] == pytest.approx(-1.5)


def test_somebody_who_waits_where_vehicles_have_priority_is_expected_to_wait() -> None:
    waiting = Walker(30.0, -5.0, 0.5, 0.5, 0, waiting=True)
    assert len(found_among([], on_zebra([waiting], CrossingKind.UNMARKED))) == 0


def test_somebody_who_walks_to_wait_where_their_crossing_begins_in_the_lane_is_expected_there() -> None:
    crossing = replace(zebra(28.0, CrossingKind.UNMARKED), right=-1.1)
    walks, stands = Walker(30.0, -5.0, 0.5, 0.5, 0, waiting=True), Walker(30.0, -5.0, 0, 0, 0, waiting=True)
    scene = perception(road=straight_road(3, 1), walkers=[walks, stands], crossings=[crossing])
    found = found_among([], scene)
    assert found.names == ("person0",)
    assert found.across_speed[0] == pytest.approx(1.2)
    # Once there, they keep their velocity until they stand.
    there = perception(road=straight_road(3, 1), walkers=[replace(walks, across=-1.3)], crossings=[crossing])
    assert found_among([], there).across_speed[0] == pytest.approx(1.2)


def test_somebody_who_walks_through_the_lane_to_where_their_crossing_begins_is_expected_to() -> None:
    crossing = replace(zebra(28.0, CrossingKind.UNMARKED), right=-1.9, left=9.0)
    walks = Walker(30.0, 2.5, -1.0, -0.8, 0, waiting=True)
    found = found_among([], perception(road=straight_road(3, 1), walkers=[walks], crossings=[crossing]))
    assert found.across_speed[0] < -1.0
    outside = replace(walks, across=-4.0, across_speed=0.8)
    assert (
        len(found_among([], perception(road=straight_road(3, 1), walkers=[outside], crossings=[crossing])))
        == 0
    )


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_somebody_who_walks_past_the_waiting_place_without_stopping_crosses_whoever_has_priority(
    side: float,
) -> None:
    crossing = replace(zebra(28.0, CrossingKind.UNMARKED), right=-3.0, left=3.0)

    def found(across: float, across_speed: float) -> Conflicts:
        walker = Walker(30.0, -side * across, 0.0, side * across_speed, 0, waiting=True)
        return found_among([], perception(walkers=[walker], crossings=[crossing]))

    assert len(found(2.7, 1.1)) == 1
    assert len(found(3.3, 1.1)) == 0
    assert len(found(2.7, 0.0)) == 0
    assert len(found(2.7, -1.1)) == 0


@pytest.mark.parametrize("green", [True, False])
def test_somebody_who_waits_at_a_signal_is_expected_to_cross_at_green(green: bool) -> None:
    waiting = Walker(30.0, -5.0, 0.5, 0.5, 0, waiting=True)
    crossing = replace(zebra(28.0, CrossingKind.SIGNAL), pedestrians_have_green=green)
    scene = perception(road=straight_road(3, 1), walkers=[waiting], crossings=[crossing])
    assert len(found_among([], scene)) == int(green)


def test_who_stands_at_a_crossing_may_set_off_and_leave_at_any_time() -> None:
    stands = found_among([], on_zebra([Walker(30.0, -5.0, 0.0, 0.0, 0, waiting=True)]))
    assert np.isfinite(stands.enter).all()
    assert np.isposinf(stands.leave).all()
    walks = found_among([], on_zebra([Walker(30.0, -5.0, 0.0, 1.2, 0, waiting=True)]))
    assert np.isfinite(walks.leave).all()


@pytest.mark.parametrize(("inwards", "expected"), [(1.3, 1), (-1.3, 0)])
def test_somebody_who_stops_in_the_road_may_walk_on(inwards: float, expected: int) -> None:
    """Towards the path they are in conflict while they stand beside it, away from it they are not."""
    watch, road = Watch(), straight_road(3, 1)
    found_among([], perception(road=road, walkers=[Walker(30.0, -3.0, 0.0, inwards)]), watch)
    stands = [Walker(30.0, -2.5, 0.0, 0.0)]
    found = found_among([], perception(road=road, walkers=stands), watch)
    assert len(found) == expected
    assert all(found.across_speed == 1.2)
    assert np.isfinite(found.leave).all()
    # Somebody who has not been seen to walk, or stands beside the road, stays there.
    assert len(found_among([], perception(road=road, walkers=stands))) == 0
    beside = [Walker(30.0, road.right_edge - 0.3, 0.0, 0.0)]
    assert len(found_among([], perception(road=road, walkers=beside), watch)) == 0


@pytest.mark.parametrize(("across", "enters"), [(-1.9, False), (-1.6, True)])
def test_somebody_who_came_to_the_kerb_and_walks_along_it_stays_there(across: float, enters: bool) -> None:
    """On the road itself they may walk on; on the kerb they keep to it, however they came there."""
    watch, assume = Watch(), PedestrianAssumptions()
    for time, walker in enumerate((Walker(20.0, across - 0.3, -1.2, 0.3), Walker(19.0, across, -1.2, 0.05))):
        known = expected(perception(ego(time=float(time)), walkers=[walker]), watch, assume, None)
    assert known.enters.all() == enters


def test_somebody_who_stands_in_the_path_stays_there() -> None:
    found = found_among([Walker(25.0, 0.5)])
    assert found.enter[0] == 0.0
    assert found.leave[0] == np.inf


def test_somebody_who_strolls_off_the_road_is_not_considered() -> None:
    assert len(found_among([Walker(30.0, -3.0, 1.0, 0.4)])) == 0
    assert len(found_among([Walker(30.0, -3.0, 1.0, 0.6)])) == 1


SAMPLES = np.linspace(0.0, HORIZON, 61)


def _bent(*corners: tuple[float, float, float], reach: float = 0.0) -> Forecast:
    """Return one pedestrian's way over corners of time, along and across; the reach grows with time."""
    times, along, across = np.array(corners).T
    return Forecast(
        SAMPLES,
        np.interp(SAMPLES, times, along)[None, :],
        np.interp(SAMPLES, times, across)[None, :],
        reach * SAMPLES[None, :],
    )


def test_constant_velocities_give_the_same_conflicts_as_their_forecast() -> None:
    drawn = np.random.default_rng(11)
    walkers = [
        Walker(*place)
        for place in zip(
            drawn.uniform(-5.0, 60.0, 300),
            drawn.uniform(-7.0, 7.0, 300),
            drawn.uniform(-1.5, 1.5, 300),
            drawn.uniform(-2.0, 2.0, 300),
            strict=True,
        )
    ]
    scene = perception(road=straight_road(3, 1), walkers=walkers)
    closed = found_among([], scene)
    sampled = found_among([], scene, forecast=ConstantVelocity().predict(scene, SAMPLES))
    assert len(closed) > 100
    assert sampled.names == closed.names
    np.testing.assert_allclose(sampled.enter, closed.enter, atol=1e-9)
    np.testing.assert_allclose(sampled.across_speed, closed.across_speed, atol=1e-9)
    within = closed.leave < HORIZON - 0.1
    np.testing.assert_allclose(sampled.leave[within], closed.leave[within], atol=1e-9)
    assert (sampled.leave[~within] >= HORIZON - 0.1).all()
    # Along the road as well, until the closed form stops believing in it.
    early = TIMES[TIMES <= STRAIGHT_ON]
    np.testing.assert_allclose(sampled.along_at(early), closed.along_at(early), atol=1e-9)


def test_somebody_on_the_sidewalk_is_considered_when_the_forecast_leads_onto_the_road() -> None:
    walker = Walker(30.0, -4.0, 1.2, 0.0)
    stays = _bent((0.0, 30.0, -4.0), (6.0, 37.2, -4.0))
    turns = _bent((0.0, 30.0, -4.0), (2.0, 32.4, -4.0), (6.0, 32.4, 1.2))
    assert len(found_among([walker], forecast=stays)) == 0
    found = found_among([walker], forecast=turns)
    assert found.enter[0] == pytest.approx(2.0 + (4.0 - REACH) / 1.3)
    assert found.across_speed[0] == pytest.approx(1.3)
    upper, *_ = position_bounds(found, 1, TIMES, FRONT, REAR, 1.0, np.zeros(len(TIMES)))
    assert upper[TIMES == 5.0] == pytest.approx(32.4 - 1.25 - FRONT)


def test_somebody_who_comes_back_is_let_pass_until_they_have_left_for_good() -> None:
    there_and_back = _bent(
        (0.0, 30.0, -2.4), (1.0, 30.0, -1.4), (2.0, 30.0, -2.4), (3.0, 30.0, -1.4), (4.0, 30.0, -2.4)
    )
    found = found_among([Walker(30.0, -2.4, 0.0, 1.0)], forecast=there_and_back)
    assert found.enter[0] == pytest.approx(0.65)
    assert found.leave[0] == pytest.approx(3.35)


def test_somebody_who_may_be_elsewhere_is_met_earlier_longer_and_wider() -> None:
    way = (0.0, 30.0, -4.35), (6.0, 30.0, 3.45)
    walker = Walker(30.0, -4.35, 0.0, 1.3)
    exact, vague = (
        found_among([walker], forecast=_bent(*way)),
        found_among([walker], forecast=_bent(*way, reach=0.2)),
    )
    assert exact.enter[0] == pytest.approx(2.0)
    assert vague.enter[0] == pytest.approx(2.6 / 1.5)
    assert vague.leave[0] > exact.leave[0]
    sharp, *_ = position_bounds(exact, 1, TIMES, FRONT, REAR, 1.0, np.zeros(len(TIMES)))
    blurred, *_ = position_bounds(vague, 1, TIMES, FRONT, REAR, 1.0, np.zeros(len(TIMES)))
    assert (sharp - blurred)[TIMES == 2.0] == pytest.approx(0.4)


def test_what_is_assumed_of_somebody_who_waits_goes_before_the_forecast() -> None:
    waiting = Walker(30.0, -5.0, 0.0, 0.3, 0, waiting=True)
    goes_away = _bent((0.0, 30.0, -5.0), (6.0, 30.0, -9.0))
    comes = _bent((0.0, 30.0, -5.0), (6.0, 30.0, 5.0))
    assert len(found_among([], on_zebra([waiting]), forecast=goes_away)) == 1
    unmarked = on_zebra([waiting], CrossingKind.UNMARKED)
    assert len(found_among([], unmarked, forecast=comes)) == 0


def test_a_forecast_between_and_beyond_its_samples() -> None:
    forecast = _bent((0.0, 30.0, -4.0), (6.0, 36.0, 2.0), reach=0.1)
    there = forecast.at(np.array([0.0, 0.05, 3.33, 9.0]))
    assert there.along[0] == pytest.approx([30.0, 30.05, 33.33, 36.0])
    assert there.reach[0] == pytest.approx([0.0, 0.005, 0.333, 0.6])
    along, across = forecast.velocities()
    assert along == pytest.approx(np.ones((1, 61)))
    assert across == pytest.approx(np.ones((1, 61)))


def test_who_comes_to_a_crossing_from_the_far_side_waits_there() -> None:
    """The crossing reaches 1.75 m to the right and 5.25 m to the left; its middle is at 1.75 m."""
    crossing = replace(zebra(28.0, CrossingKind.UNMARKED), right=-1.75, left=5.25)
    far = perception(walkers=[Walker(30.0, 7.0, 0.0, -1.2, 0, waiting=True)], crossings=[crossing])
    assert len(found_among([], far)) == 0
