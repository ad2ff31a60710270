"""All parameters that are estimated from a recording of real traffic."""

from __future__ import annotations

import numpy as np
import pandas as pd

from analysis.arrays import FloatArray
from analysis.validation.car_following import car_following
from analysis.validation.estimate import Estimate, mean, spread
from analysis.validation.gap_acceptance import critical_gap, gaps
from analysis.validation.observed import Observed
from analysis.validation.quantities import (
    FOLLOWING_S,
    headways,
    strongest_acceleration,
    strongest_braking,
    time_headway,
    walking_speed,
)

FREE_SPEED_MPS = 13.89
"""Desired speed if nobody was free to show it [m/s]."""
LEAST_FREE = 0.6
"""Cars below this share of ``FREE_SPEED_MPS`` turn or stop, and do not show their desired speed."""
STEADY_MPS2 = 0.3


def free_speeds(seen: Observed) -> FloatArray:
    """Return the speed of each car while it is steady and follows nobody within 4 s [m/s].

    Drivers who turn or approach a stop line drive more slowly than they would like, so speeds below 60 % of
    50 km/h are left out. So are cars that were free for less than a second.
    """
    cars = seen.vehicles[seen.vehicles["class"] == "passenger"]
    found = headways(seen)
    following = found[found["headway_s"] < FOLLOWING_S]
    held = pd.MultiIndex.from_arrays([following["id"], following["time_s"]])
    apart = round(1.0 / seen.step_s)
    group = cars.groupby("id")["speed_mps"]
    steady = ((cars["speed_mps"] - group.shift(apart)).abs() < STEADY_MPS2) & (
        (cars["speed_mps"] - group.shift(-apart)).abs() < STEADY_MPS2
    )
    free = cars[steady & (cars["speed_mps"] > LEAST_FREE * FREE_SPEED_MPS)]
    free = free[~pd.MultiIndex.from_arrays([free["id"], free["time_s"]]).isin(held)]
    each = free.groupby("id")["speed_mps"]
    return np.asarray(each.median()[each.size() >= apart].to_numpy(np.float64))


def estimates(seen: Observed) -> dict[str, Estimate]:
    """Return all parameters by name; those about which the recording says too little are undefined."""
    walking = walking_speed(seen).to_numpy(np.float64)
    free = free_speeds(seen)
    desired = mean("desired_speed", "m/s", free)
    found = [
        mean("walking_speed", "m/s", walking),
        spread("walking_speed_sd", "m/s", walking),
        desired,
        spread("desired_speed_sd", "m/s", free),
        mean("time_headway", "s", time_headway(seen).to_numpy(np.float64)),
        mean("acceleration", "m/s²", strongest_acceleration(seen).to_numpy(np.float64)),
        mean("braking", "m/s²", strongest_braking(seen).to_numpy(np.float64)),
        *car_following(seen, desired.value * 1.1 if desired.known else FREE_SPEED_MPS),
        *critical_gap(gaps(seen)),
    ]
    return {one.name: one for one in found}
