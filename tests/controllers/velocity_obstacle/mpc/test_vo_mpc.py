"""The velocity-obstacle controller in closed loop: yielding, going ahead, following, changing lanes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import qpsolvers

from controllers import catalog
from controllers.interface import EgoState, Manoeuvre, Perception, Plan, Solves
from controllers.safety.last_check import WAY_OUT
from controllers.velocity_obstacle.decision_rules import Rule
from controllers.velocity_obstacle.mpc.driver import VelocityObstacleMpc
from cosim.step.toy_road import ToyCrossing, ToyRoad, walk
from tests.controllers.drives import drive
from tests.controllers.faulty_solvers import fails, installed
from tests.controllers.scenes import FRONT, Car, Walker, ego, perception, straight_road, zebra
from tests.controllers.toy_runs import Ride, ride

ONE_LANE = ToyRoad(crossings=(ToyCrossing(60.0),))
TWO_LANES = ToyRoad(lanes=2)
CHANGES = (Manoeuvre.CHANGE_LEFT, Manoeuvre.CHANGE_RIGHT)


def _classes(record: Ride) -> set[str]:
    return {plan.passing for plan in record.plans} - {""}


def _solved(record: Ride) -> float:
    return float(np.mean([plan.solved for plan in record.plans]))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_it_yields_to_somebody_who_crosses_and_then_goes_on(side: float) -> None:
    record = ride(ONE_LANE, [walk(62.0, -6.0 * side, 0.0, 1.3 * side)], duration=14.0)
    assert record.clearance() > 1.0
    assert "behind=p0 ahead=" in _classes(record)
    # The pedestrian is across the ego's path from about 3.3 to 6 s.
    assert record.arrival(60.0) > 5.0
    assert record.track[3].min() > -3.2
    assert record.track[2][-1] > 12.0
    assert _solved(record) > 0.98


def test_it_goes_ahead_of_somebody_who_comes_late_and_does_not_brake_for_them() -> None:
    record = ride(ONE_LANE, [walk(62.0, -9.5, 0.0, 1.2)])
    assert record.clearance() > 1.0
    assert record.arrival(70.0) < 6.0
    assert record.track[3].min() > -0.5


def test_of_two_it_may_pass_between_them() -> None:
    first, second = walk(61.0, -3.5, 0.0, 1.4), walk(63.0, 12.0, 0.0, -1.1)
    record = ride(ONE_LANE, [first, second])
    assert record.clearance() > 0.8
    assert "behind=p0 ahead=p1" in _classes(record)


def test_it_waits_for_somebody_who_stops_in_its_path() -> None:
    record = ride(ONE_LANE, [walk(62.0, -5.0, 0.0, 1.3, stop=4.0)], duration=15.0)
    assert record.clearance() > 0.5
    assert record.track[2][-1] < 0.1
    assert record.track[0].max() < 62.0


@pytest.mark.long
def test_it_goes_round_somebody_who_stays_in_its_path_for_good() -> None:
    """It stood half a metre short of where it had to stop, which did not count as being kept from moving."""
    record = ride(ONE_LANE, [walk(62.0, -5.0, 0.0, 1.3, stop=4.0)], duration=60.0)
    assert record.clearance() > 0.0
    assert record.track[0].max() > 70.0


def test_it_stops_behind_a_standing_vehicle_and_stays() -> None:
    record = ride(ToyRoad(), vehicles=[walk(80.0, 0.0, 0.0, 0.0)], duration=20.0)
    gap = 80.0 - 4.5 - record.track[0][-1]
    # After some seconds it counts as parked, and room to steer round it is kept.
    assert 1.0 < gap < 14.0
    assert record.track[2][-1] < 0.05
    assert record.track[3].min() > -3.5


def test_it_does_not_dawdle_before_the_end_of_a_slow_stretch() -> None:
    """To the program, being fast at once behind the stretch would be worth the time lost in it."""
    limits = np.array([13.89, 2.5, 13.89])

    def scene(state: EgoState, gone: float) -> Perception:
        road = replace(straight_road(), limit_along=np.array([-100.0, 40.0, 55.0]) - gone, limit=limits)
        return perception(state, road=road)

    track = drive(catalog.build("vo_mpc"), scene, 10.0, 20.0)
    _, travelled, _, speed, _ = track.T
    in_it = speed[(travelled > 42.0) & (travelled < 55.0)]
    assert in_it.min() > 0.85 * limits[1]
    assert in_it.max() < limits[1] + 0.5
    assert speed[-1] > 10.0


def test_it_follows_a_slower_leader_at_the_time_gap() -> None:
    record = ride(ToyRoad(), vehicles=[walk(45.0, 0.0, 8.0, 0.0)], speed=13.0, duration=25.0)
    gap = 45.0 + 8.0 * 25.0 - 4.5 - record.track[0][-1]
    assert record.distance_to_vehicles() > 2.5
    assert record.track[2][-1] == pytest.approx(8.0, abs=0.3)
    assert gap == pytest.approx(2.5 + 1.0 * 8.0, abs=3.0)


@pytest.fixture(scope="module")
def overtaking() -> Ride:
    """A slow vehicle ahead, a free lane beside, and somebody fast behind in neither."""
    return ride(TWO_LANES, vehicles=[walk(60.0, 0.0, 4.0, 0.0)], duration=14.0)


def test_it_changes_lanes_round_a_slow_vehicle_and_touches_nobody(overtaking: Ride) -> None:
    assert any(decision.manoeuvre in CHANGES for decision in overtaking.decisions)
    assert overtaking.track[1][-1] == pytest.approx(3.5, abs=0.3)
    assert overtaking.distance_to_vehicles() > 0.5
    assert overtaking.track[0][-1] > 60.0 + 4.0 * 14.0  # it is past


def test_a_change_says_under_which_rule_and_where_to(overtaking: Ride) -> None:
    changing = [d for d in overtaking.decisions if d.manoeuvre is Manoeuvre.CHANGE_LEFT]
    assert changing
    assert all(d.target_lane == 1 and d.rule in (Rule.AUTONOMOUS, Rule.LANE_CHANGE) for d in changing)
    assert all(d.rule is not None for d in overtaking.decisions)


def test_without_lane_changes_it_stays_behind() -> None:
    record = ride(
        TWO_LANES, vehicles=[walk(60.0, 0.0, 4.0, 0.0)], duration=14.0, parameters={"lane_changes": False}
    )
    assert all(decision.manoeuvre is Manoeuvre.KEEP for decision in record.decisions)
    assert np.abs(record.track[1]).max() < 0.2
    assert record.distance_to_vehicles() > 1.0


def test_it_does_not_change_lanes_into_somebody_beside() -> None:
    beside = walk(-4.0, 3.5, 12.0, 0.0)
    slow = walk(60.0, 0.0, 6.0, 0.0)
    record = ride(TWO_LANES, vehicles=[slow, beside], duration=4.0)
    assert record.distance_to_vehicles() > 0.5
    assert not any(d.manoeuvre in CHANGES for d in record.decisions[:10])


def test_it_does_not_begin_a_change_near_a_crossing() -> None:
    road = ToyRoad(lanes=2, crossings=(ToyCrossing(70.0),))
    record = ride(road, vehicles=[walk(60.0, 0.0, 5.0, 0.0)], duration=12.0)
    starts = [
        snapshot.egos[0].x
        for before, now, snapshot in zip(
            record.decisions, record.decisions[1:], record.snapshots[1:], strict=False
        )
        if before.manoeuvre is Manoeuvre.KEEP and now.manoeuvre in CHANGES
    ]
    assert all(x < 70.0 - 35.0 + 2.0 or x > 74.0 + 4.5 for x in starts)
    assert record.distance_to_vehicles() > 0.5


def test_a_change_is_aborted_when_somebody_comes_up_in_the_other_lane() -> None:
    controller = catalog.build("vo_mpc")
    road = straight_road(2, 0)
    slow = Car(35.0, 0.0, 3.0)
    free = perception(ego(speed=12.0), road, cars=[slow])
    decision = controller.decide(free)
    assert decision.manoeuvre is Manoeuvre.CHANGE_LEFT
    controller.plan(free, decision)
    rushing = Car(-3.0, 3.5, 22.0)
    closed = perception(ego(speed=12.0, time=0.3, across=0.05), road, cars=[slow, rushing])
    decision = controller.decide(closed)
    assert decision.manoeuvre is Manoeuvre.ABORT_CHANGE
    assert decision.target_lane == 0
    assert decision.because == "car1"
    assert controller.plan(closed, decision).solved


@pytest.mark.parametrize("across", [-0.95, 0.95])
def test_it_goes_round_somebody_who_stands_on_the_crossing_and_waits_for_it_to_leave(across: float) -> None:
    """In SUMO, pedestrians wait on the crossing for a vehicle that waits for the ego."""
    controller, statuses = catalog.build("vo_mpc"), []
    stands = Walker(FRONT + 1.8, across, 0.0, 0.0, 0, on_crossing=True)
    for tick in range(80):
        state = ego(speed=0.0, time=0.1 * tick)
        seen = perception(state, straight_road(2), [stands], crossings=[zebra(FRONT + 1.0)])
        statuses.append(controller.plan(seen, controller.decide(seen)).status)
    assert statuses[-1] == WAY_OUT


def test_the_same_inputs_give_the_same_outputs() -> None:
    walkers = [walk(61.0, -6.0, 0.0, 1.3), walk(63.0, 7.0, 0.0, -1.2)]
    road = ToyRoad(lanes=2, crossings=(ToyCrossing(60.0),))
    first, second = (ride(road, walkers, [walk(50.0, 3.5, 5.0, 0.0)], duration=6.0) for _ in range(2))
    assert np.array_equal(first.commands, second.commands)
    assert np.array_equal(first.track, second.track)
    assert [plan.passing for plan in first.plans] == [plan.passing for plan in second.plans]


@pytest.mark.parametrize(("gap", "moves"), [(2.3, False), (3.2, True), (4.0, True)])
def test_a_standing_ego_moves_up_where_there_is_room_and_holds_its_brake_where_there_is_none(
    gap: float, moves: bool
) -> None:
    """However slowly: one that waited for a faster plan stood for minutes before 1 m of free road."""
    controller, stands = catalog.build("vo_mpc"), ego(speed=0.0)
    seen = perception(stands, cars=[Car(stands.body.front + gap + 4.5, 0.0)])
    plan = controller.plan(seen, controller.decide(seen))
    assert (plan.command.acceleration > 0.0).any() == moves
    assert plan.along[-1] <= gap


class Moody:
    """A solver that works until it does not."""

    works = True

    def __call__(self, problem: qpsolvers.Problem) -> qpsolvers.Solution:
        """Solve, or fail."""
        return qpsolvers.solve_problem(problem, "daqp") if self.works else fails(problem)


@pytest.fixture
def moody(monkeypatch: pytest.MonkeyPatch) -> Moody:
    """Install it as ``moody``."""
    solver = Moody()
    installed(monkeypatch, "moody", solver)
    return solver


def _plan(controller: object, time: float, walkers: list[Walker]) -> Plan:
    assert isinstance(controller, VelocityObstacleMpc)
    crossings = [zebra(14.0)] if walkers else []
    seen = perception(ego(speed=10.0, time=time), straight_road(), walkers, crossings=crossings)
    return controller.plan(seen, controller.decide(seen))


def test_when_the_solver_fails_the_last_plan_is_followed_and_then_a_stop(moody: Moody) -> None:
    controller = catalog.build("vo_mpc", solver="moody")
    good = _plan(controller, 0.0, [])
    assert good.solved
    assert good.solves == Solves("moody", 2, 0)
    moody.works = False
    after = _plan(controller, 0.2, [])
    assert (after.solved, after.status) == (False, "fallback_last_plan")
    assert after.solves == Solves("moody", 1, 1)
    # What is left of the last command: its fifth entry begins 0.2 s in.
    assert np.array_equal(after.command.acceleration, good.command.acceleration[4:])
    stopping = _plan(controller, 1.0, [])
    assert stopping.status == "fallback_comfortable_stop"
    assert stopping.command.acceleration.tolist() == [-3.0]
    emergency = _plan(controller, 1.1, [Walker(15.0, -1.0, 0.0, 1.3, 0, True)])
    assert emergency.status == "fallback_emergency_stop"
    assert emergency.command.acceleration.tolist() == [-8.0]


def test_a_first_plan_that_fails_stops_at_once(moody: Moody) -> None:
    moody.works = False
    controller = catalog.build("vo_mpc", solver="moody")
    assert _plan(controller, 0.0, []).status == "fallback_comfortable_stop"


@pytest.mark.long
@pytest.mark.parametrize("solver", ["osqp", "piqp"])
def test_a_solver_by_name_drives_the_same_way(solver: str) -> None:
    scene = [walk(62.0, -6.0, 0.0, 1.3)]
    ours = ride(ONE_LANE, scene, duration=8.0)
    other = ride(ONE_LANE, scene, duration=8.0, parameters={"solver": solver})
    assert {plan.solves.solver for plan in other.plans if plan.solves} == {solver}
    assert other.clearance() > 1.0
    assert np.abs(ours.track[0] - other.track[0]).max() < 0.1


@pytest.mark.parametrize(("controller", "solver"), [("vo_mpc", "daqp"), ("vo_paper", "osqp")])
def test_the_default_solver_is_the_one_that_runs(controller: str, solver: str) -> None:
    record = ride(ONE_LANE, [walk(62.0, -6.0, 0.0, 1.3)], duration=5.0, controller=controller)
    solves = [plan.solves for plan in record.plans if plan.solves is not None]
    assert {one.solver for one in solves} == {solver}
    assert sum(one.programs for one in solves) > 10
    assert not any(one.unsolved for one in solves)


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"steps": 1}, "steps = 1: expected at least 2"),
        ({"first_step_s": 0.9}, "first_step_s = 0.9 must be at most last_step_s"),
        ({"class_hysteresis": 0.0}, "class_hysteresis"),
        ({"emergency_braking_mps2": 1.0}, "emergency_braking_mps2 = 1.0 must be at least comfortable_"),
        ({"margin_across_m": -0.1}, "margin_across_m = -0.1: expected at least 0"),
        ({"truncation_s": 0.0}, "truncation_s = 0.0: expected more than 0"),
        ({"disc_radius_m": -1.0}, "disc_radius_m = -1.0: expected more than 0"),
        ({"cone": "round"}, "cone = 'round'"),
        ({"shape": "star"}, "shape = 'star'"),
    ],
)
def test_a_parameter_out_of_range_is_refused_by_name(parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        catalog.build("vo_mpc", **parameters)


@pytest.mark.parametrize("name", ["vo_mpc", "vo_paper"])
def test_a_solver_that_is_not_there_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match=r"unknown solver 'no such'; installed are.*osqp"):
        catalog.build(name, solver="no such")
    with pytest.raises(ValueError, match=r"pip install 'qpsolvers\[gurobi\]'"):
        catalog.build(name, solver="gurobi")
