"""Speed and steering planned together: what the joint program is, and the cones in closed loop."""

from __future__ import annotations

import numpy as np
import pytest

from controllers.interface import Body
from controllers.optimisation.settings import SolverSettings
from controllers.velocity_obstacle.cones import Cone
from controllers.velocity_obstacle.mpc.cone_program import NEAR, ConeProgram
from controllers.velocity_obstacle.mpc.cone_rows import ConeSettings, Motion, Outline, Walkers, rows
from controllers.velocity_obstacle.mpc.horizon import growing_grid
from controllers.velocity_obstacle.mpc.lateral import LateralProgram, SteeringTask, SteeringWeights
from controllers.velocity_obstacle.mpc.longitudinal import (
    LongitudinalProgram,
    SpeedLimits,
    SpeedTask,
    SpeedWeights,
)
from cosim.step.plant import CAR_DRIVE
from cosim.step.toy_road import ToyCrossing, ToyRoad, walk
from tests.controllers.toy_runs import ride

N = 12
DT = growing_grid(N, 0.1, 0.7)
TIMES = np.cumsum(DT)
FREE = np.full(N, np.inf)
BODY, DRIVE = Body(), CAR_DRIVE
ROAD = ToyRoad(crossings=(ToyCrossing(60.0),))
WANTED, KEPT = np.full(N, 13.0), np.full(N, 10.0)
SPEED = SpeedTask(10.0, 0.0, 0.0, WANTED, WANTED, 10.0 * TIMES, KEPT, FREE, -FREE, FREE, FREE)
STEERING = SteeringTask(
    0.1, 0.0, 0.0, 0.0, np.full(N, 11.0), np.zeros(N), np.zeros(N), np.full(N, -0.85), np.full(N, 0.85)
)


def _program(kind: Cone = Cone.VO, solver: str = "daqp") -> ConeProgram:
    solving = SolverSettings(solver, 1e-6)
    speed = LongitudinalProgram(DT, DRIVE.drive_lag, SpeedWeights(), SpeedLimits(), solving)
    steering = LateralProgram(
        DT, DRIVE.steering_lag, BODY.wheelbase, BODY.front, 0.6, 0.6, SteeringWeights(), solving
    )
    outline = Outline(2.25 + 1.0, 0.9 + 0.6, 1.3, None)
    return ConeProgram(speed, steering, ConeSettings(kind, outline, np.inf), 3)


def _walkers(count: int, y: float = -5.0, pace: float = 1.3, side: float = -1.0) -> Walkers:
    along = 35.0 + np.arange(count)[:, None] + 0.0 * TIMES
    return Walkers(
        along,
        y + pace * TIMES + 0.0 * along,
        0.0 * along,
        pace + 0.0 * along,
        np.full(count, 0.25),
        np.full(count, side),
    )


def _nominal() -> Motion:
    return Motion(10.0 * TIMES, np.full(N, 0.1), np.zeros(N), np.full(N, 10.0), 0.0, 10.0)


def test_without_pedestrians_the_joint_plan_is_the_two_plans() -> None:
    program = _program()
    joint = program.solve(SPEED, STEERING, _walkers(0), _nominal())
    speed, steering = program.speed.solve(SPEED), program.steering.solve(STEERING)
    assert joint.speed.found
    assert joint.steering.found
    assert joint.speed.position == pytest.approx(speed.position, abs=1e-4)
    assert joint.steering.across == pytest.approx(steering.across, abs=1e-4)
    both = speed.cost + steering.cost + program.steering.build(STEERING).cost
    assert joint.speed.cost == pytest.approx(both, abs=1e-4)


@pytest.mark.parametrize("kind", [Cone.VO, Cone.IVO, Cone.HYBRID])
def test_the_rows_of_the_program_are_the_linearised_cones(kind: Cone) -> None:
    """``h - G z`` without slack is the cone's value plus its gradient times the change of the motion."""
    program = _program(kind)
    walkers, nominal = _walkers(2), _nominal()
    response = program.build(SPEED, STEERING, walkers, nominal)
    z = np.zeros(len(program.problem.q))
    drawn = np.random.default_rng(1)
    split = len(program.speed.problem.q)
    z[:N], z[split : split + N] = drawn.normal(size=N) * 0.3, drawn.normal(size=N) * 0.02
    road = response.speed_free + program.speed.horizon.gain @ z[:N]
    lane = response.steering.free + response.steering.gain @ z[split : split + N]
    about = rows(program.settings, walkers, nominal)
    speed, heading = road[1] - nominal.speed, lane[1] - nominal.heading
    wanted = about.value + about.position * (road[0] - nominal.position) + about.speed * speed
    wanted = wanted + about.across * (lane[0] - nominal.across) + about.heading * heading
    wanted[:, 1:] += about.speed_before[:, 1:] * speed[:-1] + about.heading_before[:, 1:] * heading[:-1]
    cones = slice(len(program.speed.problem.h) + len(program.steering.problem.h), None)
    room = (program.problem.h - program.problem.G @ z)[cones]
    assert room[: 2 * N] == pytest.approx(wanted.reshape(-1))
    assert np.isinf(room[2 * N :]).all()


def test_places_without_a_pedestrian_bind_nothing_whoever_had_them_before() -> None:
    program = _program(Cone.HYBRID)
    for count in (3, 0, 1):
        program.build(SPEED, STEERING._replace(curvature=np.full(N, 0.01)), _walkers(count), _nominal())
        bounded = np.isfinite(program.problem.h[-3 * N :]).reshape(3, N)
        assert bounded[:count].all()
        assert not bounded[count:].any()


def test_a_plan_meets_the_cones_about_itself() -> None:
    program = _program()
    walkers, nominal = _walkers(1), _nominal()
    task = SPEED._replace(speed=8.0, expected=np.full(N, 8.0))
    for _ in range(8):
        plan = program.solve(task, STEERING, walkers, nominal)
        assert plan.speed.found
        nominal = Motion(
            plan.speed.position,
            plan.steering.across,
            plan.steering.heading_error,
            plan.speed.speed,
            0.0,
            8.0,
        )
    value = rows(program.settings, walkers, nominal).value
    near = TIMES < NEAR
    assert value[:, near].min() > -plan.speed.slack - 0.1
    assert value[:, ~near].min() > -0.1


def test_osqp_and_daqp_agree_on_the_joint_plan() -> None:
    plans = [
        _program(solver=solver).solve(SPEED, STEERING, _walkers(2), _nominal()) for solver in ("osqp", "daqp")
    ]
    assert all(plan.speed.found for plan in plans)
    assert plans[0].speed.cost == pytest.approx(plans[1].speed.cost, rel=1e-2, abs=0.1)
    assert plans[0].speed.position == pytest.approx(plans[1].speed.position, abs=0.1)


VARIANTS = [
    {"cone": "vo"},
    {"cone": "ivo"},
    {"cone": "hybrid"},
    {"cone": "vo", "truncation_s": 3.0},
    {"cone": "vo", "shape": "disc"},
    {"cone": "hybrid", "shape": "disc", "truncation_s": 3.0},
]


@pytest.mark.parametrize("parameters", VARIANTS, ids=str)
def test_a_cone_keeps_clear_of_one_pedestrian_who_crosses(parameters: dict[str, object]) -> None:
    """The disc and the infinite cones buy part of the clearance by steering; they are not the default."""
    record = ride(ROAD, [walk(62.0, -6.0, 0.0, 1.3)], duration=8.0, parameters={**parameters})
    assert record.clearance() > 0.4
    assert any(plan.passing == "behind=p0 ahead=" for plan in record.plans)
    assert np.mean([plan.solved for plan in record.plans]) > 0.95
    # Within its own lane, 3.5 m wide, apart from what the corridor's slack gives away.
    assert np.abs(record.track[1]).max() + 0.9 < 1.75 + 0.4


def test_a_cone_goes_ahead_of_somebody_who_comes_late() -> None:
    record = ride(
        ROAD, [walk(62.0, -9.5, 0.0, 1.2)], duration=7.0, parameters={"cone": "vo", "truncation_s": 3.0}
    )
    assert record.clearance() > 1.0
    assert record.track[3].min() > -0.5


def test_a_cone_changes_nothing_where_nobody_crosses() -> None:
    plain = ride(ToyRoad(), duration=4.0, speed=9.0)
    cone = ride(ToyRoad(), duration=4.0, speed=9.0, parameters={"cone": "hybrid"})
    assert np.array_equal(plain.commands, cone.commands)


def test_a_cone_gives_the_same_outputs_for_the_same_inputs() -> None:
    first, second = (
        ride(ROAD, [walk(62.0, -6.0, 0.0, 1.3)], duration=2.0, parameters={"cone": "hybrid"})
        for _ in range(2)
    )
    assert np.array_equal(first.commands, second.commands)


@pytest.mark.long
def test_whoever_finds_no_slot_is_not_forgotten() -> None:
    """Eight people cross one after the other; six have a cone, the others bound the position."""
    walkers = [walk(62.0 + 0.3 * i, -6.0 - 0.8 * i, 0.0, 1.3) for i in range(8)]
    record = ride(ROAD, walkers, duration=6.0, parameters={"cone": "vo", "truncation_s": 3.0})
    assert any(plan.passing.count("p") >= 8 for plan in record.plans)
    assert record.clearance() > 0.0
