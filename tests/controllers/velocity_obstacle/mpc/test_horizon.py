"""The horizon's closed forms against numerical integration of the differential equations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from controllers.arrays import FloatArray
from controllers.velocity_obstacle.mpc.arithmetic import steering_program
from controllers.velocity_obstacle.mpc.arithmetic.speed_program import ACCELERATION, COMMAND, POSITION, SPEED
from controllers.velocity_obstacle.mpc.horizon import LateralHorizon, LongitudinalHorizon, growing_grid

WHEELBASE = 2.6
DT = growing_grid(8, 0.1, 0.7)
ENDS = np.cumsum(DT)


def _interval(time: float) -> int:
    return min(int(np.searchsorted(ENDS, time, side="right")), len(DT) - 1)


def _integrated(rate: object, start: FloatArray) -> FloatArray:
    """Integrate interval by interval, because the inputs jump between them."""
    states, now, rows = np.asarray(start, dtype=float), 0.0, []
    for end in ENDS:
        answer = solve_ivp(rate, (now, end - 1e-12), states, rtol=1e-11, atol=1e-12)  # type: ignore[call-overload] # a plain function
        states, now = answer.y[:, -1], end
        rows.append(states)
    return np.array(rows).T


def test_a_growing_grid_begins_and_ends_where_it_should_and_grows_by_one_ratio() -> None:
    grid = growing_grid(20, 0.1, 0.7)
    assert grid[0] == pytest.approx(0.1)
    assert grid[-1] == pytest.approx(0.7)
    ratios = grid[1:] / grid[:-1]
    assert np.allclose(ratios, ratios[0])


@pytest.mark.parametrize("lag", [0.3, 0.05])
def test_the_longitudinal_maps_are_the_integrals_of_a_lagged_ramp(lag: float) -> None:
    jerk = np.random.default_rng(1).uniform(-5.0, 5.0, len(DT))
    start = np.array([0.0, 12.0, -1.5, 0.7])

    def rate(time: float, x: FloatArray) -> list[float]:
        return [x[1], x[2], (x[3] - x[2]) / lag, jerk[_interval(time)]]

    horizon = LongitudinalHorizon(DT, lag)
    # Inputs are what the command has changed by at the end of each interval; it ramps in between.
    states = horizon.start @ np.array([0.0, 12.0, -1.5, 0.7]) + horizon.gain @ np.cumsum(jerk * DT)
    assert np.allclose(horizon.jerk @ np.cumsum(jerk * DT), jerk)
    assert np.allclose(states, _integrated(rate, start), atol=1e-8)


def test_without_lag_the_acceleration_is_the_command() -> None:
    jerk = np.linspace(-3.0, 3.0, len(DT))
    horizon = LongitudinalHorizon(DT, 0.0)
    states = horizon.start @ np.array([0.0, 10.0, -4.0, 1.0]) + horizon.gain @ np.cumsum(jerk * DT)
    assert np.allclose(states[ACCELERATION], states[COMMAND])
    assert np.allclose(states[COMMAND], 1.0 + np.cumsum(jerk * DT))
    # Over the first interval: v = v0 + c h + u h^2 / 2, s = v0 h + c h^2 / 2 + u h^3 / 6.
    h, u = DT[0], jerk[0]
    assert states[SPEED, 0] == pytest.approx(10.0 + h + u * h**2 / 2.0)
    assert states[POSITION, 0] == pytest.approx(10.0 * h + h**2 / 2.0 + u * h**3 / 6.0)


def _free(horizon: LateralHorizon, start: FloatArray, speed: FloatArray, curvature: FloatArray) -> FloatArray:
    """Write the gains for a speed profile, and return the states without input."""
    gain = horizon.gain.reshape(4 * len(DT), len(DT))
    return steering_program.maps(horizon.bicycle, gain, start, speed, curvature)


@pytest.mark.parametrize("lag", [0.0, 0.1])
def test_the_lateral_maps_integrate_the_linearised_bicycle(lag: float) -> None:
    drawn = np.random.default_rng(2)
    rates = drawn.uniform(-0.2, 0.2, len(DT))
    speed = drawn.uniform(3.0, 14.0, len(DT))
    curvature = drawn.uniform(-0.02, 0.02, len(DT))
    start = np.array([0.4, -0.05, 0.02, 0.02])

    def rate(time: float, x: FloatArray) -> list[float]:
        i = _interval(time)
        wheel = (x[3] - x[2]) / lag if lag > 0.0 else rates[i]
        return [speed[i] * x[1], speed[i] * (x[2] / WHEELBASE - curvature[i]), wheel, rates[i]]

    lateral = LateralHorizon(DT, lag, WHEELBASE)
    free = _free(lateral, start, speed, curvature)
    assert np.allclose(free + lateral.gain @ rates, _integrated(rate, start), atol=1e-7)


def test_an_input_changes_nothing_that_came_before_it() -> None:
    gains = LongitudinalHorizon(DT, 0.3).gain
    lateral = LateralHorizon(DT, 0.1, WHEELBASE)
    _free(lateral, np.zeros(4), np.full(len(DT), 8.0), np.zeros(len(DT)))
    for gain in (*gains, *lateral.gain):
        assert np.allclose(np.triu(gain, 1), 0.0)
