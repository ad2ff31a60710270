"""The same plan as one non-linear program, for CasADi and IPOPT.

A kinematic bicycle along a lane, the commanded acceleration and steering angle lagged by the actuators, on
the same horizon; the same weights, bounds and soft constraints. Speed and steering are one program, the
stopping distance ``v^2 / 2b`` and the bicycle stay non-linear. It is built once; a step sets parameters and
bounds, and starts from the solution of the step before.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from controllers.velocity_obstacle.mpc.arithmetic.speed_program import FAST, SLOW
from controllers.velocity_obstacle.mpc.horizon import lagged_ramp
from controllers.velocity_obstacle.mpc.lateral import SteeringTask
from controllers.velocity_obstacle.mpc.longitudinal import SpeedTask
from measuring.tasks import Layout, Step

FloatArray = NDArray[np.float64]

LONG, ACROSS = 4, 4
"""States of each motion; as in ``controllers.velocity_obstacle.mpc.arithmetic``."""
UPPER, LOWER, HEADWAY, EMERGENCY, CORRIDOR = range(5)
SLACKS = 5
SLOWEST = 0.5
"""Speed that steering reckons with at least [m/s]."""
CORNER = 1e-4
"""Squared width of the smooth corner where that begins to matter [m^2/s^2]."""


@dataclass(frozen=True, slots=True)
class Optimum:
    """What IPOPT found."""

    found: bool
    speed: FloatArray
    command: FloatArray
    steering: FloatArray
    across: FloatArray
    cost: float
    iterations: int


class NonLinearProgram:
    """Built once; see the module's docstring.

    Parameters
    ----------
    layout
        Horizon, weights, limits and actuators.
    """

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.dt = layout.speed.dt
        n = self.n = len(self.dt)
        self._x = ca.MX.sym("x", LONG + ACROSS, n)
        self._u = ca.MX.sym("u", 2, n)
        self._slack = ca.MX.sym("slack", SLACKS)
        self._start = ca.MX.sym("start", LONG + ACROSS)
        self._reference, self._curvature, self._target = (ca.MX.sym(name, n) for name in ("v", "k", "y"))
        rows = [*self._dynamics(), *self._bounded()]
        program = {
            "x": ca.veccat(self._x, self._u, self._slack),
            "p": ca.veccat(self._start, self._reference, self._curvature, self._target),
            "f": self._cost(),
            "g": ca.veccat(*rows),
        }
        quiet = {"print_level": 0, "sb": "yes", "tol": 1e-6, "max_iter": 200}
        warm = {
            "warm_start_init_point": "yes",
            "warm_start_bound_push": 1e-6,
            "warm_start_mult_bound_push": 1e-6,
            "warm_start_slack_bound_push": 1e-6,
            "mu_init": 1e-4,
        }
        # Expanded to scalar operations, which evaluate several times faster.
        common = {"print_time": False, "error_on_fail": False, "expand": True}
        self._cold = ca.nlpsol("cold", "ipopt", program, {**common, "ipopt": quiet})
        self._warm = ca.nlpsol("warm", "ipopt", program, {**common, "ipopt": {**quiet, **warm}})
        self._last: dict[str, Any] | None = None

    def forget(self) -> None:
        """Begin the next solve without an earlier solution."""
        self._last = None

    def solve(self, step: Step) -> Optimum:
        """Solve one step, from the last solution if there is one."""
        speed, steering = step.speed, step.steering
        start = np.array(
            [
                *(0.0, speed.speed, speed.acceleration, speed.command),
                *(steering.across, steering.heading_error, steering.steering, steering.command),
            ]
        )
        arguments = {
            "p": np.concatenate((start, speed.reference, steering.curvature, steering.target)),
            **self._limits(speed, steering),
        }
        if self._last is None:
            solver = self._cold
            arguments["x0"] = self._guess(start)
        else:
            solver = self._warm
            arguments |= {
                "x0": self._last["x"],
                "lam_x0": self._last["lam_x"],
                "lam_g0": self._last["lam_g"],
            }
        answer = solver(**arguments)
        stats = solver.stats()
        found = bool(stats["success"])
        self._last = answer if found else None
        x = np.asarray(answer["x"]).ravel()
        table = x[: 8 * self.n].reshape(self.n, 8)
        return Optimum(
            found,
            table[:, 1],
            table[:, 3],
            table[:, 7],
            table[:, 4],
            float(answer["f"]),
            int(stats["iter_count"]),
        )

    def _before(self, k: int) -> Any:
        return self._start if k == 0 else self._x[:, k - 1]

    def _dynamics(self) -> list[Any]:
        """Return ``x_k - f(x_(k-1), u_k)``, to be zero."""
        drive, wheelbase = self.layout.drive, self.layout.steering.wheelbase
        along, turning = lagged_ramp(self.dt, drive.drive_lag), lagged_ramp(self.dt, drive.steering_lag)
        rows = []
        for k, h in enumerate(self.dt):
            p, v, a, c, y, heading, angle, commanded = ca.vertsplit(self._before(k))
            jerk, rate = self._u[0, k], self._u[1, k]
            lag = along.lag
            moved = p + h * v + lag * along.ramp[k] * a + along.double[k] * c + along.triple[k] * jerk
            faster = v + along.first[k] * a + along.ramp[k] * c + along.double[k] * jerk
            pulled = along.decay[k] * a + (1.0 - along.decay[k]) * c + along.ramp[k] * jerk
            turned = turning.decay[k] * angle + (1.0 - turning.decay[k]) * commanded + turning.ramp[k] * rate
            # The lagged angle's integral and double integral are exact; tan and sin are of its means.
            mean = (turning.first[k] * angle + turning.ramp[k] * commanded + turning.double[k] * rate) / h
            pace = self._pace(0.5 * (v + self._x[1, k]))
            turn = pace * (ca.tan(mean) / wheelbase - self._curvature[k])
            twice = turning.lag * turning.ramp[k] * angle
            twice += turning.double[k] * commanded + turning.triple[k] * rate
            drift = pace * (ca.tan(twice / h**2) / wheelbase - 0.5 * self._curvature[k])
            ahead = y + pace * h * ca.sin(heading + drift * h)
            rows += [
                self._x[0, k] - moved,
                self._x[1, k] - faster,
                self._x[2, k] - pulled,
                self._x[3, k] - (c + h * jerk),
                self._x[4, k] - ahead,
                self._x[5, k] - (heading + turn * h),
                self._x[6, k] - turned,
                self._x[7, k] - (commanded + h * rate),
            ]
        return rows

    @staticmethod
    def _pace(speed: Any) -> Any:
        """Return the larger of speed and ``SLOWEST``, without a kink."""
        over = speed - SLOWEST
        return SLOWEST + 0.5 * (over + ca.sqrt(over**2 + CORNER))

    def _bounded(self) -> list[Any]:
        """Return what has an upper or lower bound of its own at each step, by block."""
        p, v, c = (self._x[i, :].T for i in (0, 1, 3))
        y, heading = self._x[4, :].T, self._x[5, :].T
        s, limits = self._slack, self.layout.speed.limits
        front = y + self.layout.steering.front * heading
        return [
            p - s[UPPER],
            p + v * v / (2.0 * limits.freeze_braking) - s[UPPER],
            p + s[LOWER],
            p + limits.headway * v - s[HEADWAY],
            c + s[EMERGENCY],
            y - s[CORRIDOR],
            y + s[CORRIDOR],
            front - s[CORRIDOR],
            front + s[CORRIDOR],
        ]

    def _cost(self) -> Any:
        w, z = self.layout.speed.weights, self.layout.steering.weights
        wheelbase = self.layout.steering.wheelbase
        total = 0.0
        for k, h in enumerate(self.dt):
            v, a, y, heading, angle = (self._x[i, k] for i in (1, 2, 4, 5, 6))
            before = self._before(k)[1]
            pace = self._pace(0.5 * (before + v))
            angle_weight = z.steering + z.lateral_acceleration * (pace**2 / wheelbase) ** 2
            total += h * (
                w.speed * (v - self._reference[k]) ** 2
                + w.acceleration * a**2
                + w.jerk * self._u[0, k] ** 2
                + z.across * (y - self._target[k]) ** 2
                + z.heading * heading**2
                + angle_weight * (angle - wheelbase * self._curvature[k]) ** 2
                + z.rate * self._u[1, k] ** 2
            )
        s = self._slack
        total += w.violation * (s[UPPER] + s[LOWER]) + w.violation_squared * (s[UPPER] ** 2 + s[LOWER] ** 2)
        total += w.headway * s[HEADWAY] + w.headway_squared * s[HEADWAY] ** 2
        total += w.emergency * s[EMERGENCY] + w.emergency_squared * s[EMERGENCY] ** 2
        return total + z.leaving * (s[CORRIDOR] + s[CORRIDOR] ** 2)

    def _limits(self, speed: SpeedTask, steering: SteeringTask) -> dict[str, FloatArray]:
        """Return bounds of variables and rows for one step."""
        n, limits, drive = self.n, self.layout.speed.limits, self.layout.drive
        # The same bounds on speed as the controller's program, from the program itself.
        program = self.layout.speed
        free = program.build(speed)
        rows = program.problem.h
        fast, slow = (slice(block * n, (block + 1) * n) for block in (FAST, SLOW))
        low, high = np.full((8, n), -np.inf), np.full((8, n), np.inf)
        high[1] = rows[fast] / program._scale[FAST] + free[1]
        low[1] = free[1] - rows[slow] / program._scale[SLOW]
        high[3] = max(limits.acceleration, speed.command)
        low[7], high[7] = -drive.max_steering, drive.max_steering
        most = np.tile([limits.jerk, drive.max_steering_rate], (n, 1)).ravel()
        slack_most = np.full(SLACKS, np.inf)
        slack_most[EMERGENCY] = limits.emergency_braking - limits.comfortable_braking
        none = np.full(n, np.inf)
        left, right = steering.left, steering.right
        upper = (speed.upper, speed.stoppable, none, speed.headway, none, left, none, left, none)
        braking = np.full(n, -limits.comfortable_braking)
        lower = (-none, -none, speed.lower, -none, braking, -none, right, -none, right)
        zeros = np.zeros(8 * n)
        return {
            "lbx": np.concatenate((low.T.ravel(), -most, np.zeros(SLACKS))),
            "ubx": np.concatenate((high.T.ravel(), most, slack_most)),
            "lbg": np.concatenate((zeros, *lower)),
            "ubg": np.concatenate((zeros, *upper)),
        }

    def _guess(self, start: FloatArray) -> FloatArray:
        """Return a first guess: on at the present speed."""
        states = np.tile(start, (self.n, 1))
        states[:, 0] = start[1] * np.cumsum(self.dt)
        return np.concatenate((states.ravel(), np.zeros(2 * self.n + SLACKS)))
