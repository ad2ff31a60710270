"""Do intervals cover the planted values? ``python -m studies.validation.planted`` prints the table.

In synthetic recordings, pedestrians choose gaps by a known logit model and walk at known speeds, and cars
follow at known headways. The estimators of ``cosim calibrate`` have to recover these values.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping

import numpy as np
import pandas as pd

from analysis.markdown import table_of
from analysis.recording.reading import Area
from analysis.validation.comparison import compare
from analysis.validation.estimate import Estimate
from analysis.validation.estimators import estimates
from analysis.validation.observed import Observed

REPEATS, FIRST_SEED = 100, 1001
"""Number of recordings, and first seed; seeds from 1 on were used to develop the estimators."""
CRITICAL_GAP_S, SLOPE = 5.0, 1.5
WALKING_MPS, WALKING_SD_MPS = 1.35, 0.2
HEADWAY_S, HEADWAY_SD_S = 2.2, 0.35
PLANTED = {
    "critical_gap": CRITICAL_GAP_S,
    "gap_slope": SLOPE,
    "walking_speed": WALKING_MPS,
    "walking_speed_sd": WALKING_SD_MPS,
    "time_headway": HEADWAY_S,
}
"""True values of the estimated parameters."""
CROSSING = Area(":c", "crossing", "unmarked", 4.0, np.array([[0.0, -4.0], [0.0, 4.0]]))
PEOPLE, STEP_S, SPEED_MPS = 80, 0.1, 10.0
BEHIND_M, ROAD_M = 12.0, 8.0
EFFECT, GROUP = 0.2, 393
"""Difference in standard deviations, and number of road users per side that show it with a power of 80 %."""


def recording(seed: int) -> Observed:
    """Return a recording of a street with a crossing, of which all parameters are known."""
    rng = np.random.default_rng(seed)
    passing = np.cumsum(np.concatenate([[5.0], rng.exponential(4.0, 40 * PEOPLE) + 1.0]))
    people = []
    for number in range(PEOPLE):
        arrival = 10.0 + 40.0 * number + float(rng.uniform(0.0, 10.0))
        speed = max(0.5, float(rng.normal(WALKING_MPS, WALKING_SD_MPS)))
        people.append(_walk(f"p{number}", arrival, _entry(arrival, passing, rng), speed))
    vehicles = [_pass(f"v{number}", time) for number, time in enumerate(passing[passing < 40.0 * PEOPLE])]
    vehicles += _followers(rng)
    return Observed(
        pd.concat(vehicles, ignore_index=True).sort_values(["id", "time_s"], ignore_index=True),
        pd.concat(people, ignore_index=True).sort_values(["id", "time_s"], ignore_index=True),
        pd.DataFrame({"ped_id": [], "entered": []}),
        (CROSSING,),
        STEP_S,
    )


def _entry(arrival: float, passing: np.ndarray, rng: np.random.Generator) -> float:
    """Return when a pedestrian steps onto the crossing: at the beginning of the first accepted gap [s]."""
    begin = arrival
    for end in passing[passing > arrival]:
        if rng.random() < 1.0 / (1.0 + np.exp(-SLOPE * (end - begin - CRITICAL_GAP_S))):
            return begin
        begin = float(end)
    raise AssertionError("the traffic ended")


def _walk(name: str, arrival: float, entry: float, speed: float) -> pd.DataFrame:
    stands = np.arange(arrival, entry + 0.5 * STEP_S, STEP_S)
    walks = np.arange(1, int(ROAD_M / speed / STEP_S)) * STEP_S
    time = np.concatenate([stands, stands[-1] + walks])
    # One step after the entry, so that the first sample on the crossing lies within the accepted gap.
    moving = np.concatenate([np.zeros(len(stands)), np.full(len(walks), speed)])
    phase = ["waiting"] * len(stands) + ["crossing"] * len(walks)
    y = np.concatenate([np.full(len(stands), -4.0), -4.0 + walks * speed])
    columns = {"id": name, "time_s": time, "x_m": 0.0, "y_m": y, "speed_mps": moving}
    return pd.DataFrame({**columns, "phase": phase, "crossing": CROSSING.name})


def _pass(name: str, time: float) -> pd.DataFrame:
    at = time + STEP_S * np.arange(-2, 3)
    columns = {"id": name, "class": "passenger", "time_s": at, "x_m": SPEED_MPS * (at - time), "y_m": 0.0}
    more = {"speed_mps": SPEED_MPS, "lane": f"l{name}", "length_m": 4.5, "along_m": SPEED_MPS * (at - time)}
    return pd.DataFrame({**columns, **more, "across_m": 0.0})


def _followers(rng: np.random.Generator) -> list[pd.DataFrame]:
    """Return pairs of cars far from the crossing, each pair with its own headway."""
    found = []
    steps = np.arange(60)
    for number in range(60):
        headway = max(0.8, float(rng.normal(HEADWAY_S, HEADWAY_SD_S)))
        begin = 10000.0 + 100.0 * number
        speed = float(rng.uniform(6.0, 9.0))
        for name, ahead in ((f"lead {number}", speed * headway), (f"follow {number}", 0.0)):
            along = ahead + speed * STEP_S * steps
            noise = rng.normal(0.0, 0.05, len(steps))
            columns = {"id": name, "class": "passenger", "time_s": np.round(begin + STEP_S * steps, 3)}
            more = {"x_m": 500.0 + along, "y_m": 50.0, "speed_mps": speed + noise, "lane": f"pair {number}"}
            found.append(
                pd.DataFrame({**columns, **more, "length_m": 4.5, "along_m": along, "across_m": 0.0})
            )
    return found


def covers(found: Estimate, truth: float) -> bool:
    """Return whether an interval covers the truth."""
    return found.low <= truth <= found.high


def coverage(repeats: int = REPEATS) -> Mapping[str, int]:
    """Return in how many repeats each interval covers the planted value."""
    counts = dict.fromkeys(PLANTED, 0)
    for seed in range(FIRST_SEED, FIRST_SEED + repeats):
        found = estimates(recording(seed))
        for name, truth in PLANTED.items():
            counts[name] += covers(found[name], truth)
    return counts


def power(repeats: int = REPEATS) -> int:
    """Return in how many repeats a difference of a fifth of a standard deviation is found."""
    found = 0
    for seed in range(FIRST_SEED, FIRST_SEED + repeats):
        rng = np.random.default_rng(seed)
        one = compare(rng.normal(0.0, 1.0, GROUP), rng.normal(EFFECT, 1.0, GROUP))
        found += one.verdict == "different"
    return found


def main() -> None:
    """Print the table."""
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else REPEATS
    counts = coverage(repeats)
    rows = [
        {"parameter": name, "planted": f"{PLANTED[name]:g}", "covered": f"{count} of {repeats}"}
        for name, count in counts.items()
    ]
    print(table_of(rows))
    print(
        f"\nA difference of {EFFECT:g} standard deviations between {GROUP} and {GROUP} road users, "
        f"power 80 %: found in {power(repeats)} of {repeats}."
    )


if __name__ == "__main__":
    main()
