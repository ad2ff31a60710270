"""The prediction horizon: its time grid and the linear maps from inputs to states.

Both motions of the ego are chains of integrators behind a first-order actuator lag. Over an interval of
length ``h`` in which the commanded value ``c`` ramps at the constant rate ``u`` (jerk along the lane,
steering rate across it), the lagged value ``a`` obeys ``a' = (c - a) / lag``, and it, its integral and its
double integral have closed forms. States are condensed away: every state at every step is an affine
function of the inputs, so a quadratic program holds inputs and slacks only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.velocity_obstacle.mpc.arithmetic import steering_program
from controllers.velocity_obstacle.mpc.arithmetic.steering_program import STEERING, STEERING_COMMAND


def growing_grid(steps: int, first: float, last: float) -> FloatArray:
    """Return ``steps`` interval lengths that grow geometrically from ``first`` to ``last`` [s].

    Near steps need the resolution of the command; for far steps, a rough idea of what follows is enough.

    >>> growing_grid(3, 0.1, 0.4).round(3).tolist()
    [0.1, 0.2, 0.4]
    """
    if steps == 1:
        return np.array([first])
    return first * (last / first) ** (np.arange(steps) / (steps - 1))


@dataclass(frozen=True, slots=True)
class LaggedRamp:
    """Responses of a first-order lag, its integral and double integral over intervals ``h``.

    With ``e = exp(-h / lag)``: ``decay = e``, ``first = lag (1 - e)``, ``ramp = h - first``,
    ``double = h^2 / 2 - lag ramp`` and ``triple = h^3 / 6 - lag double``. All have the shape of ``h``.
    """

    h: FloatArray
    lag: float
    decay: FloatArray
    first: FloatArray
    ramp: FloatArray
    double: FloatArray
    triple: FloatArray


def lagged_ramp(h: FloatArray, lag: float) -> LaggedRamp:
    """Return the responses for intervals ``h`` [s] and a time constant ``lag`` >= 0 [s]."""
    decay = np.exp(-h / lag) if lag > 0.0 else np.zeros_like(h)
    first = lag * (1.0 - decay)
    ramp = h - first
    double = h**2 / 2.0 - lag * ramp
    triple = h**3 / 6.0 - lag * double
    return LaggedRamp(h, lag, decay, first, ramp, double, triple)


class LongitudinalHorizon:
    """Position, speed, acceleration and commanded acceleration, driven by the change of the command.

    Each input is the change of the command from now to the end of an interval; in between, the command ramps.
    Jerks would be equivalent, but as inputs of a triple integrator they make the quadratic program so badly
    conditioned that OSQP needs several times the iterations. The maps do not depend on the state, so they are
    built once.

    Attributes
    ----------
    start
        Map from the states at the start to all states, shape (4, N, 4).
    gain
        Map from inputs to states, shape (4, N, N).
    jerk
        Map from inputs to jerks, shape (N, N), bidiagonal.

    Parameters
    ----------
    dt
        Interval lengths, shape (N,) [s].
    lag
        Time constant of drive and brake [s].
    """

    def __init__(self, dt: FloatArray, lag: float) -> None:
        n = len(dt)
        r = lagged_ramp(dt, lag)
        self.start = np.zeros((4, n, 4))
        self.gain = np.zeros((4, n, n))
        self.jerk = (np.eye(n) - np.eye(n, k=-1)) / dt[:, None]
        start = np.eye(4)
        gain = np.zeros((4, n))
        for k in range(n):
            step = np.array(
                [
                    [1.0, dt[k], lag * r.ramp[k], r.double[k]],
                    [0.0, 1.0, r.first[k], r.ramp[k]],
                    [0.0, 0.0, r.decay[k], 1.0 - r.decay[k]],
                    [0.0, 0.0, 0.0, 1.0],
                ]
            )
            start = step @ start
            gain = step @ gain
            gain[:, k] += (r.triple[k], r.double[k], r.ramp[k], dt[k])
            self.start[:, k] = start
            self.gain[:, k] = gain @ self.jerk


class LateralHorizon:
    """Offset, heading error, steering angle and commanded angle, driven by the steering rate.

    Linearised kinematic bicycle along a lane of curvature ``kappa``, for small heading errors, with the
    speed given: ``across' = v heading``, ``heading' = v (steering / wheelbase - kappa)``.

    Parameters
    ----------
    dt
        Interval lengths, shape (N,) [s].
    lag
        Time constant of the steering [s].
    wheelbase
        Distance between the axles [m].

    Attributes
    ----------
    gain
        Map from inputs to states, shape (4, N, N); offset and heading are rewritten for each speed profile.
    bicycle
        Data from which these rows are computed.
    """

    def __init__(self, dt: FloatArray, lag: float, wheelbase: float) -> None:
        r = lagged_ramp(dt, lag)
        n = len(dt)
        # Steering and command do not depend on the speed. Columns: the inputs, then both at the start.
        steering, command = np.zeros((n + 1, n + 2)), np.zeros((n + 1, n + 2))
        steering[0, n], command[0, n + 1] = 1.0, 1.0
        for k in range(n):
            steering[k + 1] = r.decay[k] * steering[k] + (1.0 - r.decay[k]) * command[k]
            steering[k + 1, k] += r.ramp[k]
            command[k + 1] = command[k]
            command[k + 1, k] += dt[k]
        # What one interval adds to the heading per v / wheelbase, and to the offset per v^2 / wheelbase.
        turned = r.first[:, None] * steering[:-1] + r.ramp[:, None] * command[:-1]
        turned[range(n), range(n)] += r.double
        moved = (lag * r.ramp)[:, None] * steering[:-1] + r.double[:, None] * command[:-1]
        moved[range(n), range(n)] += r.triple
        self.gain = np.empty((4, n, n))
        self.gain[STEERING], self.gain[STEERING_COMMAND] = steering[1:, :n], command[1:, :n]
        at_start = [np.ascontiguousarray(states[1:, n:]) for states in (steering, command)]
        self.bicycle = steering_program.Bicycle(dt, turned, moved, at_start[0], at_start[1], wheelbase)

    @property
    def steering_gain(self) -> FloatArray:
        """Map from inputs to the commanded steering angle, independent of the speed, shape (N, N)."""
        gain: FloatArray = self.gain[STEERING_COMMAND]
        return gain
