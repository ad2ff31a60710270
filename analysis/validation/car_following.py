"""Parameters of car following, from the Intelligent Driver Model [Treiber2000]_ fitted to tracks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.optimize import least_squares

from analysis.arrays import FloatArray
from analysis.validation.estimate import Estimate, median
from analysis.validation.observed import Observed
from analysis.validation.quantities import headways

LEAST_S = 8.0
"""Shorter episodes of following say too little [s]."""
FARTHEST_M = 50.0
"""A car farther behind does not follow [m]."""
MOST_STEPS = 400
NAMES = (
    ("time_gap", "s"),
    ("standstill_gap", "m"),
    ("idm_acceleration", "m/s²"),
    ("idm_deceleration", "m/s²"),
)
START = np.array([1.2, 2.0, 1.5, 2.0])
LOW, HIGH = np.array([0.3, 0.5, 0.3, 0.5]), np.array([4.0, 6.0, 4.5, 6.0])
EXPONENT = 4.0
MARGIN = 0.02
"""An estimate nearer to a bound than this share of its range counts as the bound and is left out."""


@dataclass(frozen=True, slots=True)
class Episode:
    """Samples of a car behind a leader."""

    car: str
    gap: FloatArray
    """Gap from the car's front to the leader's rear [m]."""
    speed: FloatArray
    leader_speed: FloatArray
    step_s: float


def episodes(seen: Observed) -> Iterator[Episode]:
    """Yield each car's longest episode of following one leader."""
    found = headways(seen)
    near = found[(found["gap_m"] > 0.0) & (found["gap_m"] < FARTHEST_M)].sort_values(["id", "time_s"])
    for name, rows in near.groupby("id"):
        time = rows["time_s"].to_numpy()
        other = rows["leader"].to_numpy()
        breaks = np.flatnonzero((np.diff(time) > 1.5 * seen.step_s) | (other[1:] != other[:-1])) + 1
        piece = max(np.split(np.arange(len(rows)), breaks), key=len)[:MOST_STEPS]
        moved = rows["speed_mps"].to_numpy()[piece]
        if len(piece) * seen.step_s >= LEAST_S and moved.max() > 3.0 and np.ptp(moved) > 1.0:
            part: pd.DataFrame = rows.iloc[piece]
            yield Episode(
                str(name),
                part["gap_m"].to_numpy(np.float64),
                moved,
                part["leader_speed_mps"].to_numpy(np.float64),
                seen.step_s,
            )


def simulated_gap(parameters: FloatArray, episode: Episode, desired_speed: float) -> FloatArray:
    """Return the gaps that the model keeps behind the recorded leader [m].

    dv/dt = a (1 - (v / v0)^4 - (s* / s)^2) with s* = s0 + max(0, v T + v (v - v_leader) / (2 sqrt(a b))).

    Parameters
    ----------
    parameters : T [s], s0 [m], a and b [m/s^2]
    episode
    desired_speed : v0 [m/s]
    """
    time_gap, standstill, acceleration, braking = (float(one) for one in parameters)
    root = 2.0 * (acceleration * braking) ** 0.5
    gap, speed = float(episode.gap[0]), float(episode.speed[0])
    step, gaps = episode.step_s, np.empty(len(episode.gap))
    for at, leader in enumerate(episode.leader_speed.tolist()):
        gaps[at] = gap
        wanted = standstill + max(0.0, speed * time_gap + speed * (speed - leader) / root)
        pull = 1.0 - (speed / desired_speed) ** EXPONENT - (wanted / max(gap, 0.1)) ** 2
        after = max(0.0, speed + step * max(acceleration * pull, -9.0))
        gap += step * (leader - 0.5 * (speed + after))
        speed = after
    return gaps


def fit(episode: Episode, desired_speed: float) -> FloatArray:
    """Return the parameters with the smallest squared relative error of the gap, by least squares."""
    weight = 1.0 / np.maximum(episode.gap, 2.0)

    def residual(parameters: FloatArray) -> FloatArray:
        return (simulated_gap(parameters, episode, desired_speed) - episode.gap) * weight

    found = least_squares(residual, START, bounds=(LOW, HIGH), x_scale=START, max_nfev=40)
    return np.asarray(found.x)


def car_following(seen: Observed, desired_speed: float) -> list[Estimate]:
    """Return time gap, standstill gap, acceleration and deceleration: medians over cars, with intervals.

    A parameter about which an episode says nothing ends at a bound and is left out for that car.
    """
    fitted = [fit(one, desired_speed) for one in episodes(seen)]
    table = np.array(fitted).reshape(-1, len(NAMES))
    width = MARGIN * (HIGH - LOW)
    inside = (table > LOW + width) & (table < HIGH - width)
    return [median(name, unit, table[inside[:, column], column]) for column, (name, unit) in enumerate(NAMES)]
