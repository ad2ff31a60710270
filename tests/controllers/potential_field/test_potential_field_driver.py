"""The potential-field controller in closed loop on the road without SUMO."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from analysis.geometry import signed_distance, to_frame
from controllers import catalog
from controllers.catalog import CatalogError
from cosim.pedestrians.crossing_direction import CrossingDirection
from cosim.step.toy_road import Motion, ToyCrossing, ToyRoad, walk
from tests.controllers.toy_runs import Ride, ride

ROAD = ToyRoad(lanes=2, lane_width=4.0, speed_limit=25.0)


def drive(
    road: ToyRoad,
    walkers: Sequence[Motion] = (),
    vehicles: Sequence[Motion] = (),
    *,
    speed: float = 12.0,
    duration: float = 12.0,
    lane: int = 0,
    step: float = 0.1,
    **parameters: Any,
) -> Ride:
    """Drive ``potential_field`` with those parameters."""
    return ride(road, walkers, vehicles, speed, duration, lane, parameters, "potential_field", step)


def assert_on_the_road(record: Ride, road: ToyRoad) -> None:
    """Check the four corners of the ego's body after every step, and that all numbers are finite."""
    assert np.isfinite(record.track).all()
    assert np.isfinite(record.commands).all()
    for snapshot in record.snapshots:
        ego = snapshot.egos[0]
        for back in (0.0, ego.body.length):
            for side in (-0.5, 0.5):
                y = ego.y - back * np.sin(ego.heading) + side * ego.body.width * np.cos(ego.heading)
                assert -0.5 * road.lane_width - 0.05 < y < (road.lanes - 0.5) * road.lane_width + 0.05


def struck(record: Ride) -> list[str]:
    """Return the first pedestrian touched by an ego faster than 0.5 m/s that could have stopped.

    The pedestrians of the script see nothing: they step out just before a car, and walk into one that has
    stopped for them. It could have stopped if, when they stepped out, they were farther away than its stopping
    distance with 7.8 m/s² after 0.5 s.
    """
    could_stop: dict[str, bool] = {}
    found: dict[str, float] = {}
    for snapshot in record.snapshots:
        ego, persons = snapshot.egos[0], snapshot.persons
        ahead, beside = to_frame(persons.x - ego.x, persons.y - ego.y, ego.heading)
        half = 0.5 * ego.body.length
        apart = signed_distance(ahead + half, beside, half, 0.5 * ego.body.width) - persons.radius
        for i, name in enumerate(persons.names):
            if persons.x_speed[i] or persons.y_speed[i]:
                room = ahead[i] - persons.radius[i] - 0.5 * ego.speed - ego.speed**2 / (2.0 * 7.8)
                could_stop.setdefault(name, bool(room > 0.0))
            if apart[i] <= 0.0:
                found.setdefault(name, ego.speed)
    return [name for name, speed in found.items() if speed > 0.5 and could_stop[name]]


def test_without_pedestrians_it_keeps_its_lane() -> None:
    record = drive(ROAD, speed=15.0, duration=6.0)
    assert np.abs(record.track[1]).max() < 0.02
    assert record.track[2, -1] > 18.0


def test_it_goes_round_somebody_who_stands_beside_the_middle_of_its_lane() -> None:
    record = drive(ROAD, [walk(90.0, 4.9, 0.0, 0.0)], speed=25.0, duration=7.0, lane=1)
    assert record.clearance() > 0.5
    assert record.track[2].min() > 24.5, "without braking"
    assert record.track[1].min() < 3.3
    assert abs(record.track[1, -1] - 4.0) < 0.4, "and back"
    assert {plan.passing for plan in record.plans} == {"right=p0", ""}
    assert all(plan.solved for plan in record.plans)


@pytest.mark.long
def test_it_stops_for_who_walks_where_no_way_past_is_free() -> None:
    walls = [walk(60.0, y, 0.0, 0.0) for y in np.arange(-1.5, 6.0, 1.0)]
    record = drive(ROAD, walls, speed=14.0, duration=12.0)
    assert record.clearance() > 0.3
    assert record.track[2, -1] < 0.1
    assert {plan.status for plan in record.plans} >= {"no free path"}
    assert not all(plan.solved for plan in record.plans)


NARROW = ToyRoad(lanes=1, lane_width=3.25, speed_limit=13.9)


@pytest.mark.long
def test_on_a_road_too_narrow_to_go_round_it_combines_braking_with_steering() -> None:
    """The paper's constant speed leaves no free way there, so that it could only stop."""
    crossing = [walk(55.0, -5.5, 0.0, 1.5)]
    combined = drive(NARROW, crossing, speed=13.9, duration=9.0)
    constant = drive(NARROW, crossing, speed=13.9, duration=9.0, steady_braking_mps2=0.0)
    acted = [
        sum(plan.own is not None and plan.own.acts for plan in one.plans) for one in (combined, constant)
    ]
    applied = [plan.own for plan in combined.plans if plan.own is not None and plan.own.applies]
    assert acted[0] >= 0.9 * len(applied) > 10
    assert acted[1] == 0
    assert combined.clearance() > 0.3
    assert combined.track[3].min() > -3.1, "no more than the steady braking"
    assert combined.track[2].min() > 5.0, "it does not stop"
    assert_on_the_road(combined, NARROW)


@pytest.mark.long
def test_steady_braking_is_no_way_past_somebody_who_stays() -> None:
    record = drive(NARROW, [walk(60.0, 0.2, 0.0, 0.0)], speed=12.0, duration=12.0)
    assert record.track[2, -1] < 0.1
    assert record.clearance() > 0.5
    assert not any(plan.own is not None and plan.own.acts for plan in record.plans)


@pytest.mark.long
def test_a_vehicle_beside_keeps_it_in_its_lane() -> None:
    """On the free road it goes into the other lane; with a car there it waits for the pedestrian."""
    blocker = [walk(52.0, 0.3, 0.0, 0.0)]
    free = drive(ROAD, blocker, speed=14.0, duration=9.0)
    assert free.track[1].max() > 1.5
    assert free.clearance() > 0.25
    column = [walk(x, 4.0, 14.0, 0.0) for x in (-26.0, -13.0, 0.0, 13.0, 26.0)]
    beside = drive(ROAD, blocker, column, speed=14.0, duration=5.0)
    assert beside.distance_to_vehicles() > 0.5
    assert beside.clearance() > 0.1
    assert beside.track[1].max() < 1.0


def test_braking_none_never_brakes_for_a_pedestrian() -> None:
    crossing = [walk(70.0, -4.0, 0.0, 1.3)]
    record = drive(ROAD, crossing, speed=25.0, duration=5.0, braking="none")
    assert record.track[2].min() > 24.9
    with_brake = drive(ROAD, [walk(60.0, y, 0.0, 0.0) for y in (-1.0, 0.0, 1.0)], speed=25.0, duration=2.0)
    assert with_brake.track[3].min() < -2.0


def test_the_axis_decides_when_it_begins() -> None:
    """The needed axis is above 15 m at 25 m/s, so a fixed one of 15 m begins later."""
    person = [walk(90.0, 4.9, 0.0, 0.0)]
    tracks = {
        axis: drive(ROAD, person, speed=25.0, duration=4.0, lane=1, axis=axis).track
        for axis in ("variable", "fixed")
    }
    begins = {axis: float(t[0][np.abs(t[1] - 4.0) > 0.1][0]) for axis, t in tracks.items()}
    assert begins["variable"] < begins["fixed"] - 2.0


def _drawn_walk(
    road: ToyRoad, x: float, *, from_left: bool, start: float, drawn: np.random.Generator
) -> Motion:
    """Return somebody who walks from kerb to kerb in a drawn direction, and stays there."""
    right, width = -0.5 * road.lane_width, road.lanes * road.lane_width
    angle = CrossingDirection().draw(width, 0.0, 0.0, drawn)
    x_speed, y_speed = 1.25 * np.cos(angle), 1.25 * np.sin(angle) * (-1.0 if from_left else 1.0)
    y = right + width if from_left else right
    return walk(x, y, x_speed, y_speed, start, start + width / abs(y_speed))


@pytest.mark.long
@pytest.mark.parametrize(
    ("count", "seed"), [(2, 1), *(pytest.param(*one, marks=pytest.mark.slow) for one in ((5, 2), (20, 1)))]
)
def test_several_pedestrians_and_traffic_are_survived_on_the_road(count: int, seed: int) -> None:
    road = ToyRoad(lanes=2, lane_width=3.5, speed_limit=13.89, crossings=(ToyCrossing(55.0),))
    drawn = np.random.default_rng(seed)
    walkers = [
        _drawn_walk(
            road,
            float(drawn.uniform(45.0, 100.0)),
            from_left=bool(drawn.integers(2)),
            start=float(drawn.uniform(0.0, 6.0)),
            drawn=drawn,
        )
        for _ in range(count)
    ]
    traffic = [walk(35.0, 0.0, 11.0, 0.0), walk(-15.0, 3.5, 12.0, 0.0), walk(14.0, 3.5, 12.0, 0.0)]
    record = drive(road, walkers, traffic, speed=12.0, duration=12.0)
    assert_on_the_road(record, road)
    assert record.distance_to_vehicles() > 0.1
    assert not struck(record)


@pytest.mark.parametrize("step", [0.05, 0.5, 1.0])
def test_any_plan_interval_steers_round_somebody(step: float) -> None:
    record = drive(ROAD, [walk(80.0, 4.9, 0.0, 0.0)], speed=20.0, duration=6.0, lane=1, step=step)
    assert_on_the_road(record, ROAD)
    assert record.clearance() > 0.2


@pytest.mark.long
def test_the_same_scene_gives_the_same_commands() -> None:
    walkers = [walk(50.0, -2.5, 0.2, 1.2), walk(60.0, 5.5, 0.0, -1.0)]
    first, second = (drive(ROAD, walkers, speed=14.0, duration=4.0) for _ in range(2))
    np.testing.assert_array_equal(first.commands, second.commands)


def test_the_plan_carries_what_a_replay_draws() -> None:
    record = drive(ROAD, [walk(50.0, 4.9, 0.0, 0.0)], speed=20.0, duration=0.2, lane=1)
    plan = record.plans[0]
    assert len(plan.times) == len(plan.along) == len(plan.across) == len(plan.speed) > 20
    assert set(plan.overlay) == {"conflict_points_m", "obstacle_ellipses_m", "candidate_paths_m"}
    assert all(values.ndim == 2 and values.shape[1] == 2 for values in plan.overlay.values())
    np.testing.assert_allclose(plan.overlay["conflict_points_m"], [[50.0, 0.9]], atol=1e-9)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"fixed_axis_m": 0.0}, "fixed_axis_m = 0.0: expected more than 0"),
        ({"shift_acceleration_mps2": -1.0}, "shift_acceleration_mps2 = -1.0: expected more than 0"),
        ({"line_width_m": 0.0}, "line_width_m = 0.0: expected more than 0"),
        ({"side_margin_m": -0.1}, "side_margin_m = -0.1: expected at least 0"),
        ({"obstacle_gain": float("inf")}, "obstacle_gain = inf: expected a finite number"),
        ({"axis": "round"}, "axis = 'round': expected 'variable' or 'fixed'"),
        ({"braking": "soft"}, "braking = 'soft': expected 'aeb' or 'none'"),
        ({"predictor": "tea leaves"}, "predictor = 'tea leaves': expected 'constant_velocity'"),
    ],
)
def test_parameters_out_of_range_are_refused_in_one_line(parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(CatalogError, match=message) as caught:
        catalog.build("potential_field", **parameters)
    assert "\n" not in str(caught.value)
