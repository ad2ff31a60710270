"""A recording of everybody near crossings, real or simulated, as tables from which values are computed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pandas as pd
import shapely

from analysis.arrays import FloatArray
from analysis.errors import RecordingError
from analysis.files import read_csv, read_json
from analysis.manifest import read_verified
from analysis.recording.columns import TRAFFIC
from analysis.recording.reading import Area, read_map
from analysis.results.traffic_rows import TRAFFIC_ENCOUNTERS

_COLUMNS = (
    "time_s",
    "object_id",
    "object_kind",
    "vehicle_class",
    "x_m",
    "y_m",
    "x_speed_mps",
    "y_speed_mps",
    "length_m",
    "edge_or_lane",
    "crossing_id",
    "phase",
)
COARSEST_S = 0.1
"""Samples are thinned to this step, so that recordings of different steps give the same values [s]."""


@dataclass(frozen=True, slots=True)
class Observed:
    """One recording."""

    vehicles: pd.DataFrame
    """Sorted by id and time: ``id``, ``class``, ``time_s``, ``x_m``, ``y_m`` (front), ``speed_mps``,
    ``lane``, ``along_m`` and ``across_m`` of that lane (nan without one)."""
    people: pd.DataFrame
    """Sorted likewise: ``id``, ``time_s``, ``x_m``, ``y_m``, ``speed_mps``, ``phase``, ``crossing``."""
    encounters: pd.DataFrame
    """Rows of traffic_encounters.csv as texts."""
    crossings: tuple[Area, ...]
    step_s: float

    def between(self, begin_s: float, end_s: float) -> Observed:
        """Return the part with the road users who first appear within a span of time."""
        people = self.people[_appear(self.people, begin_s, end_s)]
        vehicles = self.vehicles[_appear(self.vehicles, begin_s, end_s)]
        own = self.encounters["ped_id"].isin(set(people["id"]))
        return replace(self, people=people, vehicles=vehicles, encounters=self.encounters[own])


def _appear(frame: pd.DataFrame, begin_s: float, end_s: float) -> pd.Series:
    first = frame.groupby("id")["time_s"].transform("min")
    return (first >= begin_s) & (first < end_s)


def observe(folder: Path) -> Observed:
    """Read the recording of a run's folder.

    Raises
    ------
    RecordingError
        If the folder does not contain the traffic near crossings, or a file in it is damaged.
    """
    path = folder / TRAFFIC.file
    if not path.is_file():
        raise RecordingError(f"{folder}: no {TRAFFIC.file}; expected a run that recorded everybody")
    table = pd.read_parquet(BytesIO(read_verified(path)), columns=list(_COLUMNS))
    step = float(read_json(folder / "run.json")["step_s"])
    every = max(1, round(COARSEST_S / step))
    numbers = np.round(table["time_s"].to_numpy() / step).astype(np.int64)
    table = table[numbers % every == 0]
    table = table.assign(
        id=table["object_id"].astype(str),
        speed_mps=np.hypot(table["x_speed_mps"].to_numpy(), table["y_speed_mps"].to_numpy()),
    ).sort_values(["id", "time_s"], kind="stable")
    areas = read_map(folder)
    vehicle = (table["object_kind"] == "vehicle").to_numpy()
    encounters = pd.DataFrame(read_csv(folder / TRAFFIC_ENCOUNTERS.file), columns=TRAFFIC_ENCOUNTERS.names())
    return Observed(
        _on_lanes(table[vehicle], areas),
        table[~vehicle].rename(columns={"crossing_id": "crossing"}).reset_index(drop=True),
        encounters,
        tuple(area for area in areas if area.kind == "crossing"),
        step * every,
    )


def _on_lanes(vehicles: pd.DataFrame, areas: tuple[Area, ...]) -> pd.DataFrame:
    made = vehicles.rename(columns={"vehicle_class": "class", "edge_or_lane": "lane"}).reset_index(drop=True)
    shapes = {area.name: area.shape for area in areas if area.kind == "lane"}
    along, across = np.full(len(made), np.nan), np.full(len(made), np.nan)
    x, y = made["x_m"].to_numpy(), made["y_m"].to_numpy()
    for lane, rows in made.groupby("lane", sort=False).indices.items():
        if lane in shapes:
            along[rows], across[rows] = _beside(shapes[str(lane)], x[rows], y[rows])
    return made.assign(along_m=along, across_m=across)


def _beside(shape: FloatArray, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the distances of points along a line and to its left [m]."""
    line, points = shapely.LineString(shape), shapely.points(x, y)
    along = np.asarray(shapely.line_locate_point(line, points), dtype=np.float64)
    ahead = shapely.line_interpolate_point(line, np.minimum(along + 0.1, line.length))
    back = shapely.line_interpolate_point(line, np.maximum(np.minimum(along + 0.1, line.length) - 0.2, 0.0))
    way = shapely.get_coordinates(ahead) - shapely.get_coordinates(back)
    foot = shapely.get_coordinates(shapely.line_interpolate_point(line, along))
    off = np.column_stack([x, y]) - foot
    side = np.sign(way[:, 0] * off[:, 1] - way[:, 1] * off[:, 0])
    return along, side * np.hypot(off[:, 0], off[:, 1])
