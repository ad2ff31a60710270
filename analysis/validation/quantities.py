"""Quantities compared between street and simulation: one value per road user, never one per sample."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from analysis.stretches import stretches
from analysis.validation.observed import Observed

Values = pd.Series
"""Values indexed by road user."""

MOVING_MPS, WALKING_MPS = 1.0, 0.3
"""Above these speeds, a vehicle counts as moving and a pedestrian as walking [m/s]."""
FOLLOWING_S, FOLLOWING_MPS = 4.0, 3.0
"""A car follows another if its time headway is below the first [s] and its speed above the second [m/s]."""
WINDOW_S = 1.0
"""Accelerations are changes of speed over this time, because from sample to sample tracks are noisy [s]."""
LEAST_S = 2.0
"""Road users who were seen for less than this time have no value [s]."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """One quantity of road users."""

    name: str
    unit: str
    meaning: str
    values: Callable[[Observed], Values]


def _cars(seen: Observed) -> pd.DataFrame:
    return seen.vehicles[seen.vehicles["class"] == "passenger"]


def _mean_speed(vehicles: pd.DataFrame, step_s: float) -> Values:
    moving = vehicles[vehicles["speed_mps"] > MOVING_MPS]
    return _series(_long_enough(moving, step_s)["speed_mps"].mean())


def _long_enough(frame: pd.DataFrame, step_s: float) -> Any:
    """Return the groups of road users who were seen for long enough, with samples ``step_s`` apart [s]."""
    count = frame.groupby("id")["time_s"].transform("size")
    return frame[count * step_s >= LEAST_S].groupby("id")


def _series(values: Any) -> Values:
    return pd.Series(values, dtype=np.float64)


def _changes(seen: Observed) -> pd.DataFrame:
    """Return the changes of cars' speeds over a second [m/s^2]."""
    cars = _cars(seen)
    apart = round(WINDOW_S / seen.step_s)
    group = cars.groupby("id")
    time = group["time_s"].diff(apart)
    change = group["speed_mps"].diff(apart) / time
    known = (time - WINDOW_S).abs() < 0.5 * seen.step_s
    return pd.DataFrame({"id": cars["id"], "change": change})[known]


def strongest_acceleration(seen: Observed) -> Values:
    """Return the strongest acceleration over a second of each car that reaches 1 m/s^2 or more [m/s^2]."""
    most = _changes(seen).groupby("id")["change"].max()
    return most[most >= 1.0]


def strongest_braking(seen: Observed) -> Values:
    """Return the strongest deceleration over a second of each car that reaches 1 m/s^2 or more [m/s^2]."""
    most = -_changes(seen).groupby("id")["change"].min()
    return most[most >= 1.0]


def headways(seen: Observed) -> pd.DataFrame:
    """Return the times from the front of a leader to the front of the car behind it in the same lane.

    Returns
    -------
    DataFrame
        ``id``, ``leader``, ``time_s``, ``headway_s``, ``gap_m`` (front to the leader's rear), ``speed_mps``,
        ``leader_speed_mps``.
    """
    drivers = seen.vehicles[seen.vehicles["along_m"].notna() & (seen.vehicles["class"] != "bicycle")]
    ordered = drivers.sort_values(["time_s", "lane", "along_m"], kind="stable")
    ahead = ordered.shift(-1)
    same = (ordered["time_s"] == ahead["time_s"]) & (ordered["lane"] == ahead["lane"])
    way = ahead["along_m"] - ordered["along_m"]
    found = pd.DataFrame(
        {
            "id": ordered["id"],
            "class": ordered["class"],
            "leader": ahead["id"],
            "time_s": ordered["time_s"],
            "headway_s": way / ordered["speed_mps"].where(ordered["speed_mps"] > 0.0),
            "gap_m": way - ahead["length_m"],
            "speed_mps": ordered["speed_mps"],
            "leader_speed_mps": ahead["speed_mps"],
        }
    )
    return found[same & (found["class"] == "passenger")]


def time_headway(seen: Observed) -> Values:
    """Return each car's median time headway while it follows."""
    found = headways(seen)
    follows = (found["speed_mps"] > FOLLOWING_MPS) & (found["headway_s"] < FOLLOWING_S)
    return _series(_long_enough(found[follows], seen.step_s)["headway_s"].median())


def lateral_offset(seen: Observed) -> Values:
    """Return each car's mean distance to the left of its lane's axis while it moves."""
    cars = _cars(seen)
    moving = cars[(cars["speed_mps"] > MOVING_MPS) & (cars["across_m"].abs() < 2.0)]
    return _series(_long_enough(moving, seen.step_s)["across_m"].mean())


def lateral_spread(seen: Observed) -> Values:
    """Return each car's mean distance from its lane's axis while it moves."""
    cars = _cars(seen)
    moving = cars[(cars["speed_mps"] > MOVING_MPS) & (cars["across_m"].abs() < 2.0)]
    moving = moving.assign(off=moving["across_m"].abs())
    return _series(_long_enough(moving, seen.step_s)["off"].mean())


def car_speed(seen: Observed) -> Values:
    """Return each car's mean speed while it moves."""
    return _mean_speed(_cars(seen), seen.step_s)


def bicycle_speed(seen: Observed) -> Values:
    """Return each bicycle's mean speed while it moves."""
    return _mean_speed(seen.vehicles[seen.vehicles["class"] == "bicycle"], seen.step_s)


def walking_speed(seen: Observed) -> Values:
    """Return each pedestrian's median speed while they walk."""
    walking = seen.people[seen.people["speed_mps"] > WALKING_MPS]
    return _series(_long_enough(walking, seen.step_s)["speed_mps"].median())


def crossing_time(seen: Observed) -> Values:
    """Return each pedestrian's mean time on a crossing, over walks that were seen from end to end."""
    found = {}
    for name, rows in seen.people.groupby("id"):
        on = (rows["phase"] == "crossing").to_numpy()
        time = rows["time_s"].to_numpy()
        walks = [time[b] - time[a] for a, b in stretches(on) if a > 0 and b < len(on) - 1]
        walks = [walk for walk in walks if walk >= LEAST_S]
        if walks:
            found[str(name)] = float(np.mean(walks))
    return pd.Series(found, dtype=np.float64)


def waiting_time(seen: Observed) -> Values:
    """Return how long each pedestrian who walked over a crossing stood before it."""
    people = seen.people
    stood = (people["phase"] == "waiting") & (people["speed_mps"] < WALKING_MPS)
    waited = stood.groupby(people["id"]).sum() * seen.step_s
    crossed = (people["phase"] == "crossing").groupby(people["id"]).any()
    return waited[crossed]


def _of_encounters(seen: Observed, column: str, pick: str) -> Values:
    rows = seen.encounters[seen.encounters["entered"] == "1"]
    values = pd.to_numeric(rows[column], errors="coerce")
    group = values[values.notna()].groupby(rows["ped_id"][values.notna()])
    return group.min() if pick == "min" else group.mean()


def smallest_distance(seen: Observed) -> Values:
    """Return each pedestrian's smallest distance from any vehicle they met."""
    return _of_encounters(seen, "min_dist_m", "min")


def smallest_pet(seen: Observed) -> Values:
    """Return each pedestrian's smallest PET."""
    return _of_encounters(seen, "pet_area_s", "min")


def yielding(seen: Observed) -> Values:
    """Return for each pedestrian the share of vehicles that let them go first, of those that could."""
    return _of_encounters(seen, "yielded", "mean")


QUANTITIES: tuple[Quantity, ...] = (
    Quantity("car_speed", "m/s", "mean speed of a moving car", car_speed),
    Quantity("car_acceleration", "m/s²", "a car's strongest acceleration over 1 s", strongest_acceleration),
    Quantity("car_braking", "m/s²", "a car's strongest deceleration over 1 s", strongest_braking),
    Quantity("time_headway", "s", "median time headway of a car that follows, front to front", time_headway),
    Quantity("lateral_offset", "m", "mean offset of a car to the left of its lane's axis", lateral_offset),
    Quantity("lateral_spread", "m", "mean distance of a car from its lane's axis", lateral_spread),
    Quantity("bicycle_speed", "m/s", "mean speed of a moving bicycle", bicycle_speed),
    Quantity("walking_speed", "m/s", "median speed of a walking pedestrian", walking_speed),
    Quantity("crossing_time", "s", "time of a walk over a crossing", crossing_time),
    Quantity("waiting_time", "s", "time that a pedestrian stands before a crossing", waiting_time),
    Quantity("smallest_distance", "m", "a pedestrian's smallest distance from a vehicle", smallest_distance),
    Quantity("smallest_pet", "s", "a pedestrian's smallest PET", smallest_pet),
    Quantity("yielding", "1", "share of vehicles that let a pedestrian go first", yielding),
)
"""Outcomes in the order of the tables; quantities from which the demand was rebuilt are not among them."""
