"""The velocity-obstacle paper's problem solved by another method: SciPy's SLSQP from many starts.

It shares no code with the controllers: it uses the paper's frame (x right, y forward), its own Euler steps,
and cones as angles. Each passing class is a problem of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import Bounds, minimize

from cosim.arrays import FloatArray

STEERING_LIMIT = np.deg2rad(9.4)
TURN_LIMIT = np.deg2rad(10.0)
SPEED_LIMIT, CHANGE_LIMIT = 15.0, 8.0
FEASIBLE = 1e-5
"""Starts whose solution violates a constraint by more than this are discarded [m, m/s, rad]."""
WHEEL_UNIT = 0.02
"""Unit of the searched changes of the wheel angle, so that they are as large as those of the speed [rad]."""


@dataclass(frozen=True, slots=True)
class Task:
    """One problem in the paper's frame."""

    steps: int
    pedestrian_y: float
    """y of the pedestrian at 1 s, when they are at x = 6 m [m]."""
    side: float
    """+1 to pass on the left of the line of sight, ahead of the pedestrian; −1 to pass behind them."""
    exact: bool = False
    """Whether distances over time replace a cone at every step."""
    steers: bool = False
    steering_weight: float = 1.0
    end_x: float | None = None
    """Lane in which to end, with straight heading and wheels [m]."""
    radius: float = 2.0
    speed: float = 7.5
    wheelbase: float = 2.6


@dataclass(frozen=True, slots=True)
class Answer:
    """The best local solution found."""

    cost: float
    changes: FloatArray
    """Changes of the speed, then of the wheel angle [m/s, rad]."""
    feasible: int
    """Number of starts that ended feasible."""


def best_of(task: Task, starts: int, seed: int) -> Answer:
    """Return the best of the local solutions from several starts.

    Parameters
    ----------
    task : what to solve
    starts : number of starts; each changes to another speed in the first step, with disturbances
    seed : seed of the disturbances

    Raises
    ------
    ArithmeticError
        If no start ends feasible.
    """
    drawn = np.random.default_rng(seed)
    n = task.steps
    size = 2 * n if task.steers else n
    unit = np.ones(size)
    unit[n:] = WHEEL_UNIT
    turn = STEERING_LIMIT / WHEEL_UNIT
    limits = np.concatenate((np.full(n, CHANGE_LIMIT), np.full(size - n, turn)))
    constraints: list[Any] = [
        {"type": "ineq", "fun": lambda z: _margins(unit * z, task)},
        {"type": "eq", "fun": lambda z: _ends(unit * z, task)},
    ]
    best: FloatArray | None = None
    found = 0
    for index in range(starts):
        begin = np.zeros(size)
        # The starts range from clearly slower to clearly faster.
        begin[0] = np.linspace(-4.0, 5.0, starts)[index]
        begin[:n] += drawn.normal(0.0, 0.1, n)
        begin[n:] = drawn.normal(0.0, 0.5, size - n)
        result = minimize(  # type: ignore[call-overload]  # lambdas of the stubs take no arrays
            lambda z: _cost(unit * z, task),
            begin,
            jac=lambda z: unit * _cost_slope(unit * z, task),
            method="SLSQP",
            bounds=Bounds(-limits, limits),
            constraints=constraints,
            options={"maxiter": 400, "ftol": 1e-10},
        )
        z = unit * np.asarray(result.x)
        off = max(-_margins(z, task).min(), np.abs(_ends(z, task)).max(initial=0.0))
        if off > FEASIBLE:
            continue
        found += 1
        if best is None or _cost(z, task) < _cost(best, task):
            best = z
    if best is None:
        raise ArithmeticError(f"none of {starts} starts ended feasible for {task}")
    return Answer(_cost(best, task), best, found)


def _cost(z: FloatArray, task: Task) -> float:
    n = task.steps
    return float(z[:n] @ z[:n] + task.steering_weight * z[n:] @ z[n:])


def _cost_slope(z: FloatArray, task: Task) -> FloatArray:
    weights = np.ones(len(z))
    weights[task.steps :] = task.steering_weight
    return np.asarray(2.0 * weights * z)


def _motion(z: FloatArray, task: Task) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return x, y, heading, speed and wheel angle at 0, 1, ... seconds."""
    n = task.steps
    x, y, heading, speed, wheel = 0.0, 0.0, 0.5 * np.pi, task.speed, 0.0
    rows = [(x, y, heading, speed, wheel)]
    for i in range(n):
        x, y = x + speed * np.cos(heading), y + speed * np.sin(heading)
        heading = heading + speed / task.wheelbase * np.tan(wheel)
        speed += z[i]
        wheel += z[n + i] if task.steers else 0.0
        rows.append((x, y, heading, speed, wheel))
    columns = np.array(rows, dtype=np.float64).T
    return columns[0], columns[1], columns[2], columns[3], columns[4]


def _margins(z: FloatArray, task: Task) -> FloatArray:
    x, y, heading, speed, _ = _motion(z, task)
    times = np.arange(0.0, task.steps + 1.0)
    dx, dy = 7.0 - times - x, task.pedestrian_y - 1.0 + times - y
    if task.exact:
        apart = _least_distances(dx, dy) - task.radius
        # The class depends on where the vehicle is when the pedestrian walks through x = 0, at 7 s.
        passed = np.array([task.side * -dy[7]])
        avoided = np.concatenate((apart, passed))
    else:
        vx, vy = speed * np.cos(heading), speed * np.sin(heading)
        sight = np.arctan2(dy[1:], dx[1:])
        course = np.arctan2(vy[1:] - 1.0, vx[1:] + 1.0)
        distance = np.hypot(dx[1:], dy[1:])
        half = np.arcsin(np.minimum(task.radius / distance, 1.0))
        # The sine keeps to one side of the cone and stays smooth when the pedestrian is behind.
        avoided = np.concatenate((np.sin(task.side * (course - sight) - half), distance - task.radius))
    turn = np.diff(heading)
    return np.concatenate((avoided, speed[1:], SPEED_LIMIT - speed[1:], TURN_LIMIT - turn, TURN_LIMIT + turn))


def _least_distances(dx: FloatArray, dy: FloatArray) -> FloatArray:
    """Return the smallest distance within each step, for motion in straight lines [m]."""
    step_x, step_y = np.diff(dx), np.diff(dy)
    squared = step_x**2 + step_y**2
    share = np.clip(-(dx[:-1] * step_x + dy[:-1] * step_y) / squared, 0.0, 1.0)
    return np.asarray(np.hypot(dx[:-1] + share * step_x, dy[:-1] + share * step_y))


def _ends(z: FloatArray, task: Task) -> FloatArray:
    if task.end_x is None:
        return np.zeros(0)
    x, _, heading, _, wheel = _motion(z, task)
    return np.array([x[-1] - task.end_x, heading[-1] - 0.5 * np.pi, wheel[-1]])
