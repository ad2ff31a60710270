"""The steering program: lane keeping, lane changes, bends and the corridor."""

from __future__ import annotations

import numpy as np
import pytest

from controllers.arrays import FloatArray
from controllers.driving.lanes.minimum_jerk import minimum_jerk
from controllers.interface import Body
from controllers.optimisation.settings import SolverSettings
from controllers.velocity_obstacle.mpc.horizon import growing_grid
from controllers.velocity_obstacle.mpc.lateral import (
    LateralProgram,
    SteeringPlan,
    SteeringTask,
    SteeringWeights,
)
from cosim.step.plant import CAR_DRIVE

N = 20
DT = growing_grid(N, 0.1, 0.7)
TIMES = np.cumsum(DT)
BODY, DRIVE = Body(), CAR_DRIVE


def _program(solver: str = "daqp") -> LateralProgram:
    return LateralProgram(
        DT,
        DRIVE.steering_lag,
        BODY.wheelbase,
        BODY.front,
        DRIVE.max_steering,
        DRIVE.max_steering_rate,
        SteeringWeights(),
        SolverSettings(solver),
    )


def _task(
    across: float = 0.0,
    heading_error: float = 0.0,
    speed: float = 10.0,
    curvature: float = 0.0,
    target: FloatArray | float = 0.0,
    steering: float = 0.0,
    right: float = -0.85,
    left: float = 0.85,
) -> SteeringTask:
    return SteeringTask(
        across=across,
        heading_error=heading_error,
        steering=steering,
        command=steering,
        speed=np.full(N, speed),
        curvature=np.full(N, curvature),
        target=np.broadcast_to(np.asarray(target, dtype=float), N).copy(),
        right=np.full(N, right),
        left=np.full(N, left),
    )


def _assert_within_limits(plan: SteeringPlan, command: float = 0.0) -> None:
    assert plan.found
    rate = np.diff(plan.command, prepend=command) / DT
    assert np.abs(rate).max() <= DRIVE.max_steering_rate + 1e-3
    assert np.abs(plan.command).max() <= DRIVE.max_steering + 1e-3


def test_in_the_middle_of_a_straight_lane_nothing_is_steered() -> None:
    plan = _program().solve(_task())
    assert plan.command == pytest.approx(np.zeros(N), abs=1e-4)
    assert plan.across == pytest.approx(np.zeros(N), abs=1e-4)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_ego_beside_the_middle_returns_without_overshooting_much(side: float) -> None:
    plan = _program().solve(_task(across=0.6 * side))
    _assert_within_limits(plan)
    assert abs(plan.across[-1]) < 0.05
    assert (side * plan.across).min() > -0.1


@pytest.mark.parametrize("speed", [5.0, 10.0, 15.0])
def test_a_lane_change_follows_its_profile(speed: float) -> None:
    profile = 3.5 * minimum_jerk(TIMES / 4.5)
    plan = _program().solve(_task(speed=speed, target=profile, left=4.35))
    _assert_within_limits(plan)
    # Smoother than the profile: it starts earlier and ends later.
    assert np.abs(plan.across - profile).max() < 0.7
    assert plan.across[-1] == pytest.approx(3.5, abs=0.2)
    assert plan.heading_error[-1] == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize("curvature", [0.02, -0.02, 0.1])
def test_in_a_bend_the_wheels_follow_the_lane(curvature: float) -> None:
    speed = min(np.sqrt(2.0 / abs(curvature)), 8.0)
    angle = BODY.wheelbase * curvature
    plan = _program().solve(_task(speed=speed, curvature=curvature, steering=angle))
    _assert_within_limits(plan, angle)
    assert plan.command == pytest.approx(np.full(N, angle), abs=0.01)
    assert np.abs(plan.across).max() < 0.05


def test_the_body_stays_in_its_corridor_with_the_front_too() -> None:
    # A target outside is not followed beyond the border.
    plan = _program().solve(_task(target=2.0))
    _assert_within_limits(plan)
    assert plan.across.max() < 0.85 + 0.02
    assert (plan.across + BODY.front * plan.heading_error).max() < 0.85 + 0.02
    assert plan.slack < 0.02


def test_an_ego_outside_its_corridor_comes_back_and_says_how_far_out_it_was() -> None:
    plan = _program().solve(_task(across=1.4))
    _assert_within_limits(plan)
    assert 0.4 < plan.slack < 0.7
    assert abs(plan.across[-1]) < 0.2


def test_a_speed_near_zero_still_gives_a_plan() -> None:
    plan = _program().solve(_task(across=0.5, heading_error=0.2, speed=0.5))
    _assert_within_limits(plan)
    assert np.isfinite(plan.across).all()


def test_left_and_right_are_treated_alike() -> None:
    left = _program().solve(_task(across=0.4, heading_error=-0.05))
    right = _program().solve(_task(across=-0.4, heading_error=0.05))
    assert left.across == pytest.approx(-right.across, abs=2e-3)
    assert left.command == pytest.approx(-right.command, abs=2e-3)


def test_cost_with_its_constant_is_the_objective() -> None:
    program = _program()
    task = _task(across=0.5)
    plan = program.solve(task)
    built = program.build(task)
    steering = built.free[2] + built.gain[2] @ plan.inputs[:N]
    w = SteeringWeights()
    of_angle = w.steering + w.lateral_acceleration * (10.0**2 / BODY.wheelbase) ** 2
    terms = w.across * plan.across**2 + w.heading * plan.heading_error**2 + of_angle * steering**2
    terms += w.rate * plan.inputs[:N] ** 2
    assert plan.cost + built.cost == pytest.approx(float(DT @ terms), rel=1e-3)


def test_another_solver_finds_the_same_plan() -> None:
    for task in (_task(across=0.6), _task(target=2.0), _task(curvature=0.03, speed=7.0)):
        ours, other = _program().solve(task), _program("osqp").solve(task)
        assert ours.across == pytest.approx(other.across, abs=0.03)
