"""Tracks that tests make themselves: a straight street along x, one crossing of it at x = 100 m."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pandas as pd

STEP_S = 0.1


def track(
    name: str,
    kind: str,
    start: tuple[float, float],
    velocity: tuple[float, float],
    begin_s: float = 0.0,
    duration_s: float = 10.0,
    step_s: float = STEP_S,
) -> pd.DataFrame:
    """Return the samples of somebody who moves straight on."""
    time = begin_s + step_s * np.arange(round(duration_s / step_s) + 1)
    x = start[0] + velocity[0] * (time - begin_s)
    y = start[1] + velocity[1] * (time - begin_s)
    return pd.DataFrame({"id": name, "class": kind, "time_s": np.round(time, 4), "x_m": x, "y_m": y})


def write(path: Path, tracks: Iterable[pd.DataFrame]) -> Path:
    """Write tracks as a plain CSV."""
    pd.concat(list(tracks), ignore_index=True).to_csv(path, index=False)
    return path


def car(name: str = "car", speed: float = 10.0, **more: float) -> pd.DataFrame:
    """Return a car that drives east, in the lane of `tests.cosim.tracks.networks.street`."""
    return track(name, "car", (20.0, -1.6), (speed, 0.0), **more)


def walker(name: str = "walker", begin_s: float = 0.0, speed: float = 1.4) -> pd.DataFrame:
    """Return a pedestrian who walks north over the crossing, from one sidewalk to the other."""
    return track(name, "pedestrian", (100.0, -5.5), (0.0, speed), begin_s, 11.0 / speed)


def crowd() -> list[pd.DataFrame]:
    """Return cars and pedestrians who pass at many distances in time; the crossing is 80 m from a car's start."""
    tracks = []
    for number, (late, speed) in enumerate(
        ((2.0, 10.0), (4.4, 10.0), (6.0, 8.0), (8.5, 12.0), (3.6, 9.0), (5.2, 10.0))
    ):
        begin = 30.0 * number
        tracks.append(car(f"car {number}", speed, begin_s=begin, duration_s=14.5))
        tracks.append(walker(f"walker {number}", begin + late, 1.2 + 0.1 * number))
    return tracks


def rush() -> list[pd.DataFrame]:
    """Return ten cars and ten pedestrians, one of each every 20 s, who walk at 1.0 to 1.9 m/s."""
    tracks = []
    for number in range(10):
        tracks.append(car(f"car {number}", 9.0 + 0.3 * number, begin_s=20.0 * number, duration_s=14.0))
        tracks.append(walker(f"walker {number}", 20.0 * number + 9.0, 1.0 + 0.1 * number))
    return tracks
