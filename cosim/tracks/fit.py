"""How well trajectories fit a network, for each class; trajectories that do not fit at all are refused."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from analysis.errors import RecordingError
from analysis.trajectories.table import PEDESTRIAN
from cosim.sumo.network import Network
from cosim.tracks.lanes import SUMO_CLASS, LaneMatcher, Walkways

MOVING_MPS = 1.0
"""Above this speed, a vehicle's heading is known [m/s]."""
LANE_M, LANE_DEG, GROUND_M = 1.0, 20.0, 0.5
"""A vehicle is on a lane within this distance of its axis [m] and this angle of its direction [deg]; a
pedestrian is on their ground within the last distance [m]."""
LEAST_SHARE = 0.5
"""Share of samples that must lie within `OFF_M` of the network; with fewer, the projection is wrong."""
OFF_M = 10.0


@dataclass(frozen=True, slots=True)
class ClassFit:
    """How well the road users of one class fit the network."""

    kind: str
    n_tracks: int
    n_samples: int
    """Number of samples that count: those of moving vehicles, or all of pedestrians."""
    share_samples: float
    """Share within 1.0 m of a lane's axis and 20° of its heading, or within 0.5 m of pedestrians' ground."""
    share_tracks: float
    """Share of tracks of which at least half of the samples are within these limits."""
    median_m: float
    """Median distance from the lane's axis, or from the pedestrians' ground [m]."""


@dataclass(frozen=True, slots=True)
class Placed:
    """Samples placed on a network."""

    frame: pd.DataFrame
    """Samples with ``place`` (lane or pedestrians' ground; empty for none), ``across_m`` and ``along_m``."""
    fits: tuple[ClassFit, ...]


def placed(frame: pd.DataFrame, network: Network, source: str) -> Placed:
    """Return the samples with their places on a network.

    Parameters
    ----------
    frame : samples as `cosim.tracks.resampling.on_clock` returns them
    network
    source : name of the trajectories in messages

    Raises
    ------
    RecordingError
        If less than half of the samples are on or near the network.
    """
    parts, fits, near, total = [], [], 0, 0
    worst: tuple[float, int] = (-1.0, 0)
    for kind in [name for name in SUMO_CLASS if (frame["kind"] == name).any()]:
        part = frame[frame["kind"] == kind].copy()
        x, y = part["x_m"].to_numpy(), part["y_m"].to_numpy()
        if kind == PEDESTRIAN:
            away, good, counted = _on_foot(part, network, x, y)
        else:
            away, good, counted = _driving(part, network, kind, x, y)
        off = np.where(np.isfinite(away), away, np.inf)
        near += int(np.count_nonzero(off <= OFF_M))
        total += len(part)
        if off.max() > worst[0]:
            worst = float(off.max()), int(part["row"].to_numpy()[int(np.argmax(off))])
        fits.append(_fit(kind, part, np.abs(away), good, counted))
        parts.append(part)
    if near < LEAST_SHARE * total:
        distance = "nowhere near it" if np.isinf(worst[0]) else f"{worst[0]:.0f} m from it"
        raise RecordingError(
            f"{source}: row {worst[1]}: the projection does not fit: {total - near} of {total} samples are "
            f"more than {OFF_M:g} m from every lane and sidewalk of the network, this one is {distance}"
        )
    return Placed(pd.concat(parts).sort_values(["id", "step"], ignore_index=True), tuple(fits))


def _on_foot(
    part: pd.DataFrame, network: Network, x: np.ndarray, y: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    ground = Walkways(network)
    found, away = ground.nearest(x, y)
    names = np.array([*ground.names, ""], dtype=object)
    part["place"] = np.where(away <= OFF_M, names[found], "")
    part["across_m"] = part["along_m"] = np.nan
    return away, away <= GROUND_M, np.ones(len(x), dtype=np.bool_)


def _driving(
    part: pd.DataFrame, network: Network, kind: str, x: np.ndarray, y: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    match = LaneMatcher(network, kind).match(x, y, part["heading_rad"].to_numpy())
    names = np.array([*match.names, ""], dtype=object)
    part["place"] = names[match.lane]
    part["across_m"], part["along_m"] = match.across, match.along
    good = (np.abs(match.across) <= LANE_M) & (np.abs(match.angle) <= np.radians(LANE_DEG))
    return match.across, good, part["speed_mps"].to_numpy() > MOVING_MPS


def _fit(kind: str, part: pd.DataFrame, away: np.ndarray, good: np.ndarray, counted: np.ndarray) -> ClassFit:
    names = part["id"].to_numpy()[counted]
    good = good[counted]
    by_track = pd.Series(good).groupby(names).median() >= 0.5
    known = away[counted][np.isfinite(away[counted])]
    return ClassFit(
        kind,
        int(part["id"].nunique()),
        int(np.count_nonzero(counted)),
        float(good.mean()) if len(good) else float("nan"),
        float(by_track.mean()) if len(by_track) else float("nan"),
        float(np.median(known)) if len(known) else float("nan"),
    )


def as_rows(fits: tuple[ClassFit, ...]) -> list[Mapping[str, object]]:
    """Return a row for each class, for a table or a file; undefined values are ``None``."""
    return [
        {
            "class": one.kind,
            "n_tracks": one.n_tracks,
            "n_samples": one.n_samples,
            "share_samples": _known(one.share_samples, 4),
            "share_tracks": _known(one.share_tracks, 4),
            "median_distance_m": _known(one.median_m, 3),
        }
        for one in fits
    ]


def _known(value: float, decimals: int) -> float | None:
    return round(value, decimals) if np.isfinite(value) else None
