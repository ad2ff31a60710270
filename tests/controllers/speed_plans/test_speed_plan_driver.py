"""Closed loops of ``trapezoid`` and ``intermediate_speed`` on the road without SUMO."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from controllers import catalog
from controllers.interface import CrossingKind, EgoState, Perception, Signal, SignalState
from controllers.prediction import by_name
from controllers.speed_plans.intermediate_speed import safe_distance
from controllers.speed_plans.trapezoid_profile import PlanningLimits
from cosim.step.plant import CAR_DRIVE
from cosim.step.toy_road import Motion, ToyCrossing, ToyRoad, walk
from tests.controllers.drives import drive
from tests.controllers.scenes import FRONT, Car, Walker, ego, perception, straight_road, zebra
from tests.controllers.toy_runs import Ride, ride

BOTH = pytest.mark.parametrize("name", ["trapezoid", "intermediate_speed"])
VARIANTS: dict[str, dict[str, Any]] = {
    "plain": {},
    "predict": {"predict": True},
    "smooth": {"jerk_mps3": 3.0},
    "both": {"predict": True, "jerk_mps3": 3.0},
    "periodic": {"replanning": "periodic", "period_s": 0.5},
    "measured": {"plan_from": "measured"},
}
IDEAL = replace(CAR_DRIVE, drive_lag=0.0, steering_lag=0.0)


def _ride(
    name: str,
    road: ToyRoad,
    walkers: Sequence[Motion] = (),
    vehicles: Sequence[Motion] = (),
    duration: float = 40.0,
    **given: Any,
) -> Ride:
    return ride(road, walkers, vehicles, duration=duration, controller=name, **given)


def _crowd(count: int, place: float, seed: int) -> list[Motion]:
    """Return people who cross a zebra from both sides, one after the other."""
    drawn = np.random.default_rng(seed)
    people = []
    for _ in range(count):
        side = float(drawn.choice([-1.0, 1.0]))
        begin = 1.75 if side > 0.0 else -1.75
        people.append(
            walk(
                place + float(drawn.uniform(0.5, 3.5)),
                begin + side * float(drawn.uniform(1.0, 8.0)),
                0.0,
                -side * float(drawn.uniform(0.8, 1.6)),
                start=float(drawn.uniform(0.0, 0.6 * count)),
            )
        )
    return people


@pytest.mark.long
@pytest.mark.parametrize(
    ("variant", "count"),
    [
        *((variant, 5) for variant in (*VARIANTS, "trapezoid")),
        *((variant, 2) for variant in ("plain", "both", "trapezoid")),
        ("both", 20),
        pytest.param("trapezoid", 20, marks=pytest.mark.slow),
    ],
)
def test_nobody_who_crosses_a_zebra_is_touched_and_the_ego_drives_on(variant: str, count: int) -> None:
    name = "trapezoid" if variant == "trapezoid" else "intermediate_speed"
    road = ToyRoad(crossings=(ToyCrossing(70.0),))
    record = _ride(
        name, road, _crowd(count, 70.0, count), duration=20.0 + count, parameters=VARIANTS.get(variant)
    )
    assert record.clearance() > 0.3
    assert record.arrival(90.0) < 19.0 + count
    assert record.track[3].min() > -6.0
    assert all(plan.solved for plan in record.plans)


@BOTH
def test_people_cross_in_front_of_a_queue_of_traffic(name: str) -> None:
    # A leader at 8 m/s stops for nobody here; a van stands beside the road's only lane, far ahead.
    road = ToyRoad(crossings=(ToyCrossing(120.0),))
    vehicles = [walk(50.0, 0.0, 8.0, 0.0, start=-10.0, stop=9.0)]
    record = _ride(name, road, _crowd(5, 120.0, 3), vehicles, duration=32.0)
    assert record.track[0, -1] > 190.0
    assert record.track[2, -1] < 0.5
    assert record.clearance() > 0.3
    assert record.distance_to_vehicles() > 1.0


@BOTH
@pytest.mark.parametrize(
    ("interval", "distance"), [(0.05, 60.0), (0.1, 90.0), (0.5, 60.0), (1.0, 90.0), (1.0, 60.0)]
)
def test_a_pedestrian_who_stands_in_the_path_is_stopped_for_and_left_when_they_are_gone(
    name: str, distance: float, interval: float
) -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        walkers = [Walker(distance - travelled, 0.2)] if state.time < 16.0 else []
        return perception(state, walkers=walkers)

    rows = drive(catalog.build(name), scene, 13.0, 28.0, interval)
    waiting = rows[(rows[:, 0] < 16.0) & (rows[:, 0] > 14.0)]
    clearance = distance - 0.25 - FRONT - waiting[:, 1]
    assert waiting[:, 3].max() < 0.02
    assert 2.2 < clearance.min() <= clearance.max() < 2.9
    assert rows[-1, 3] > 12.0
    assert rows[:, 4].min() > -4.0


@BOTH
def test_a_pedestrian_who_steps_out_late_is_braked_for_as_hard_as_it_takes(name: str) -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        walkers = [Walker(30.0 - travelled, 0.0)] if state.time > 0.45 else []
        return perception(state, walkers=walkers)

    rows = drive(catalog.build(name), scene, 12.0, 8.0)
    assert (30.0 - 0.25 - FRONT - rows[:, 1]).min() > 0.5
    assert rows[:, 4].min() < -4.0


@BOTH
def test_where_no_braking_is_enough_it_brakes_fully_and_says_so(name: str) -> None:
    controller = catalog.build(name)
    seen = perception(walkers=[Walker(FRONT + 3.0, 0.0)])
    plan = controller.plan(seen, controller.decide(seen))
    assert not plan.solved
    assert plan.status == "emergency_braking"
    assert plan.command.acceleration.min() == pytest.approx(-8.0)


@BOTH
@pytest.mark.parametrize("brakes", [True, False])
def test_whom_no_plan_is_made_for_the_emergency_brake_stops_for(name: str, brakes: bool) -> None:
    controller = catalog.build(name, emergency_brake=brakes)
    seen = perception(ego(13.0), cars=[Car(FRONT + 4.5 + 6.0, 2.2, 4.0, across_speed=-1.5)])
    decision = controller.decide(seen)
    plan = controller.plan(seen, decision)
    assert (decision.because == "car0") is brakes
    assert (plan.status == "emergency_braking") is brakes
    assert plan.solved is not brakes


@BOTH
def test_with_somebody_inside_the_body_it_stands(name: str) -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        return perception(state, walkers=[Walker(1.0, 0.3)])

    rows = drive(catalog.build(name), scene, 3.0, 4.0)
    assert rows[-1, 3] == 0.0


@pytest.mark.parametrize(
    ("variant", "lag"), [("plain", 0.0), ("plain", 0.3), ("smooth", 0.3), ("periodic", 0.3)]
)
def test_behind_a_steady_leader_the_gap_becomes_the_safe_one(variant: str, lag: float) -> None:
    speed = 8.0

    def scene(state: EgoState, travelled: float) -> Perception:
        return perception(state, cars=[Car(70.0 + speed * state.time - travelled, 0.0, speed)])

    controller = catalog.build("intermediate_speed", **VARIANTS[variant])
    limits = replace(IDEAL, drive_lag=lag)
    rows = drive(controller, scene, 13.0, 40.0, limits=limits)
    gap = 70.0 - 4.5 - FRONT + speed * rows[-1, 0] - rows[-1, 1]
    wanted = safe_distance(speed, PlanningLimits(deceleration=2.0, actuator_delay=0.3))
    assert gap == pytest.approx(wanted, abs=0.35)
    assert rows[-1, 3] == pytest.approx(speed, abs=0.05)
    gaps = 70.0 - 4.5 - FRONT + speed * rows[:, 0] - rows[:, 1]
    assert gaps.min() > 0.95 * wanted


def test_a_leader_who_stops_dead_is_stopped_behind() -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        moved = 10.0 * min(state.time, 12.0)
        return perception(
            state, cars=[Car(50.0 + moved - travelled, 0.0, 10.0 if state.time < 12.0 else 0.0)]
        )

    rows = drive(catalog.build("intermediate_speed"), scene, 10.0, 40.0)
    gap = 50.0 + 120.0 - 4.5 - FRONT - rows[:, 1]
    assert gap.min() > 1.2
    assert rows[-1, 3] == 0.0


@BOTH
def test_a_red_light_is_stopped_at_while_nobody_is_ahead(name: str) -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        light = Signal("tl", 80.0 - travelled, SignalState.RED if state.time < 15.0 else SignalState.GREEN)
        return perception(state, signals=[light])

    rows = drive(catalog.build(name), scene, 13.0, 25.0)
    stopped = rows[(rows[:, 0] > 13.0) & (rows[:, 0] < 15.0)]
    assert stopped[:, 3].max() < 0.1
    assert (stopped[:, 1] + FRONT).max() < 80.0
    assert rows[-1, 3] > 8.0


@BOTH
def test_a_lower_limit_ahead_is_kept(name: str) -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        road = replace(
            straight_road(),
            limit_along=np.array([-500.0, 80.0 - travelled]),
            limit=np.array([13.89, 8.33]),
        )
        return perception(state, road)

    rows = drive(catalog.build(name), scene, 13.0, 20.0)
    beyond = rows[rows[:, 1] + FRONT > 81.0]
    assert beyond[:, 3].max() < 8.33 + 0.3
    assert beyond[-1, 3] > 8.0


def test_the_own_top_speed_is_driven_where_the_road_allows_more() -> None:
    def scene(state: EgoState, travelled: float) -> Perception:
        return perception(state)

    rows = drive(catalog.build("intermediate_speed", max_speed_mps=9.0), scene, 0.0, 15.0)
    assert rows[-1, 3] == pytest.approx(9.0, abs=0.01)
    assert rows[:, 3].max() < 9.05


def test_a_standing_car_is_driven_round_where_there_is_another_lane() -> None:
    road = ToyRoad(lanes=2)
    record = _ride("intermediate_speed", road, vehicles=[walk(70.0, 0.0, 0.0, 0.0)], duration=30.0)
    assert record.arrival(100.0) < 25.0
    assert record.distance_to_vehicles() > 0.2


@pytest.mark.long
@BOTH
@pytest.mark.parametrize(
    ("lanes", "step"),
    [
        *((1, step) for step in (0.05, 0.1, 0.2, 0.5, 1.0)),
        *((2, step) for step in (0.1, 0.5, 1.0)),
        *(pytest.param(2, step, marks=pytest.mark.slow) for step in (0.05, 0.2)),
    ],
)
def test_a_standing_car_is_never_touched_at_low_speed_whatever_the_step(
    name: str, step: float, lanes: int
) -> None:
    """It has reached the end of its way and stays there; the ego comes up to it slowly, or begins near it.

    The least gap is what full braking takes after one step and the drive's lag; with less, any driver touches.
    Within 4 s the ego stands or has passed.
    """
    road = ToyRoad(lanes=lanes, lane_width=3.5, speed_limit=13.9)
    for speed in (0.3, 0.9, 2.0):
        least = speed * (step + CAR_DRIVE.drive_lag) + speed**2 / (2.0 * CAR_DRIVE.max_deceleration)
        for gap in (least + 0.1, least + 1.0, 6.0):
            car = walk(FRONT + gap + 4.5, 0.0, 0.0, 0.0)
            record = _ride(name, road, vehicles=[car], speed=speed, duration=4.0, step=step)
            assert record.distance_to_vehicles() > 0.05, f"{speed} m/s, {gap} m"


@pytest.mark.long
def test_with_prediction_a_pedestrian_who_leaves_need_not_be_stopped_for() -> None:
    road = ToyRoad(crossings=(ToyCrossing(60.0),))
    walker = [walk(62.0, -6.0, 0.0, 1.0)]
    rides = [
        _ride("intermediate_speed", road, walker, duration=20.0, parameters={"predict": flag})
        for flag in (False, True)
    ]
    slowest = [float(record.track[2].min()) for record in rides]
    assert slowest[1] > slowest[0] + 2.0
    assert rides[1].arrival(70.0) < rides[0].arrival(70.0)
    assert min(record.clearance() for record in rides) > 0.5


@pytest.mark.long
def test_with_prediction_a_pedestrian_who_stops_after_all_is_stopped_for() -> None:
    road = ToyRoad(crossings=(ToyCrossing(60.0),))
    for stop in np.arange(2.0, 7.0, 1.0):
        walker = [walk(62.0, -6.0, 0.0, 1.0, stop=float(stop))]
        record = _ride("intermediate_speed", road, walker, duration=12.0, parameters={"predict": True})
        assert record.clearance() > 0.0


def test_a_smooth_plan_is_driven_with_a_limited_jerk() -> None:
    record = _ride(
        "intermediate_speed",
        ToyRoad(),
        vehicles=[walk(90.0, 0.0, 6.0, 0.0, start=-10.0)],
        duration=30.0,
        parameters={"jerk_mps3": 1.5},
    )
    commands = np.concatenate([plan.command.acceleration for plan in record.plans])
    assert np.abs(np.diff(commands)).max() < 1.5 * 0.05 * 1.5


def test_what_is_recorded_says_whom_the_plan_is_for() -> None:
    road = ToyRoad(crossings=(ToyCrossing(60.0, kind=CrossingKind.ZEBRA),))
    record = _ride("intermediate_speed", road, [walk(62.0, -4.0, 0.0, 0.8)], duration=8.0)
    plan, decision = record.plans[30], record.decisions[30]
    assert decision.because == "p0"
    assert plan.passing == "behind=p0 ahead="
    assert plan.overlay["obstacles"].shape == (1, 2)
    assert (np.diff(plan.along) >= 0.0).all()
    np.testing.assert_allclose(plan.along[-1], 59.0 - record.track[0, 29], atol=0.5)


@pytest.mark.long
def test_the_same_run_twice_is_the_same() -> None:
    road = ToyRoad(crossings=(ToyCrossing(70.0),))
    first, second = (
        _ride("intermediate_speed", road, _crowd(5, 70.0, 1), duration=20.0).track for _ in range(2)
    )
    np.testing.assert_array_equal(first, second)


@BOTH
@pytest.mark.parametrize(
    ("parameter", "value"),
    [
        ("acceleration_mps2", 0.0),
        ("deceleration_mps2", -2.0),
        ("emergency_deceleration_mps2", 1.0),
        ("max_speed_mps", 0.0),
        ("actuator_delay_s", -0.1),
        ("standoff_m", -1.0),
        ("period_s", 0.0),
        ("time_margin_s", -1.0),
        ("side_margin_m", float("inf")),
        ("predictor", "crystal_ball"),
    ],
)
def test_parameters_out_of_range_are_refused_in_one_line(name: str, parameter: str, value: Any) -> None:
    with pytest.raises(catalog.CatalogError, match=parameter) as caught:
        catalog.build(name, **{parameter: value})
    assert "\n" not in str(caught.value)


def test_a_jerk_of_zero_is_refused() -> None:
    with pytest.raises(catalog.CatalogError, match="jerk_mps3"):
        catalog.build("intermediate_speed", jerk_mps3=0.0)


@BOTH
@pytest.mark.parametrize("predictor", by_name.names())
def test_any_predictor_of_pedestrians_can_be_asked(name: str, predictor: str) -> None:
    controller = catalog.build(name, predictor=predictor)
    seen = perception(walkers=[Walker(30.0, -1.0, 0.0, 1.2, 0, True)], crossings=[zebra(28.0)])
    assert controller.decide(seen).because == "person0"
