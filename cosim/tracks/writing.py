"""Writes trajectories as the files of a recorded run without egos, so that all tools can read them."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analysis.files import write_json
from analysis.manifest import CLAIM, MANIFEST
from analysis.recording.columns import EGOS, NEIGHBOURS, PLANS, SCHEMA_VERSION, TIMING, TRAFFIC
from analysis.sealing import seal_recording
from analysis.trajectories.table import PEDESTRIAN
from cosim.recording import provenance
from cosim.recording.parquet_sink import ParquetSink
from cosim.recording.provenance import Inputs
from cosim.recording.recorder import TRAFFIC_PER_CHUNK
from cosim.recording.rows import map_entry
from cosim.sumo.levels import other_levels
from cosim.sumo.map_areas import CELL, areas_near, cells_of_crossings
from cosim.sumo.network import Network
from cosim.tracks.crossing_phases import CrossingPhases
from cosim.tracks.lanes import SUMO_CLASS
from cosim.tracks.projection import Location

DRIVER = "tracks"
"""Name written in place of a simulated run's controller."""


def write_recording(
    folder: Path,
    frame: pd.DataFrame,
    network: Network,
    location: Location,
    inputs: Inputs,
    facts: Mapping[str, Any],
) -> None:
    """Write the files of a recorded run.

    Parameters
    ----------
    folder : empty folder
    frame : placed samples, as `cosim.tracks.fit.placed` returns them
    network, location
    inputs : inputs that the numbers depend on
    facts : further keys of ``run.json``
    """
    description = provenance.describe(inputs, SCHEMA_VERSION)
    write_json(folder / "run.json", description)
    for table in (EGOS, NEIGHBOURS, PLANS, TIMING):
        with closing(ParquetSink(folder / table.file, table.schema)):
            pass  # no road user is an ego
    with closing(ParquetSink(folder / TRAFFIC.file, TRAFFIC.schema, TRAFFIC_PER_CHUNK)) as sink:
        for rows in _traffic(frame, network, inputs.step_s):
            sink.add_columns([rows[column.name] for column in TRAFFIC.columns])
    cells = cells_of_crossings(network) | _cells(frame)
    areas = areas_near(network, cells, location.to_degrees, other_levels(network))
    write_json(folder / "map.json", {"areas": [map_entry(area) for area in areas]})
    steps = int(frame["step"].max() - frame["step"].min()) + 1
    description.update(
        duration_s=round(steps * inputs.step_s, 6), n_steps=steps, valid=True, invalid_reason=None, **facts
    )
    description[CLAIM] = MANIFEST
    write_json(folder / "run.json", description)
    seal_recording(folder)


def _cells(frame: pd.DataFrame) -> set[tuple[int, int]]:
    cells = np.unique(np.round(frame[["x_m", "y_m"]].to_numpy() / CELL).astype(np.int64), axis=0)
    return {(int(x), int(y)) for x, y in cells}


def _traffic(frame: pd.DataFrame, network: Network, step_s: float) -> list[dict[str, Any]]:
    """Return the columns of ``traffic.parquet`` in chunks, sorted by time with pedestrians first."""
    people = (frame["kind"] == PEDESTRIAN).to_numpy()
    phases = CrossingPhases(network).of(frame[people], step_s)
    frame = frame.assign(phase=None, crossing=None, is_vehicle=~people)
    frame["phase"] = frame["phase"].astype(object)
    frame["crossing"] = frame["crossing"].astype(object)
    frame.loc[people, "phase"] = phases.phase
    frame.loc[people, "crossing"] = phases.crossing
    frame = frame.sort_values(["step", "is_vehicle", "id"], kind="stable", ignore_index=True)
    limits = {name: lane.speed for name, lane in network.lanes.items()}
    return [
        _columns(frame.iloc[first : first + TRAFFIC_PER_CHUNK], limits)
        for first in range(0, len(frame), TRAFFIC_PER_CHUNK)
    ]


def _columns(part: pd.DataFrame, limits: Mapping[str, float]) -> dict[str, Any]:
    vehicle = part["is_vehicle"].to_numpy()
    heading = np.where(vehicle, part["heading_rad"], np.nan)
    speed = part["speed_mps"].to_numpy()
    half = np.where(vehicle, 0.5 * part["length_m"], 0.0)
    direction = part["heading_rad"].to_numpy()
    cosine, sine = np.cos(direction), np.sin(direction)
    kinds = part["kind"].to_list()
    return {
        "time_s": np.round(part["time_s"].to_numpy(), 3),
        "object_id": part["id"].to_list(),
        "object_kind": ["vehicle" if one else "pedestrian" for one in vehicle],
        "object_type": kinds,
        "vehicle_class": [
            SUMO_CLASS[kind] if one else None for kind, one in zip(kinds, vehicle.tolist(), strict=True)
        ],
        "is_ego": [False if one else None for one in vehicle],
        "x_m": np.round(part["x_m"].to_numpy() + half * cosine, 3),
        "y_m": np.round(part["y_m"].to_numpy() + half * sine, 3),
        "heading_rad": _absent(np.round(heading, 3)),
        "x_speed_mps": np.round(speed * cosine, 3),
        "y_speed_mps": np.round(speed * sine, 3),
        "acceleration_mps2": _absent(np.round(np.where(vehicle, part["acceleration_mps2"], np.nan), 3)),
        "speed_limit_mps": _absent(
            np.array(
                [
                    limits.get(place, np.nan) if one else np.nan
                    for place, one in zip(part["place"], vehicle, strict=True)
                ]
            )
        ),
        "length_m": part["length_m"].to_numpy(),
        "width_m": part["width_m"].to_numpy(),
        "edge_or_lane": part["place"].to_list(),
        "crossing_id": part["crossing"].to_list(),
        "phase": part["phase"].to_list(),
        "signal": [None] * len(part),
    }


def _absent(values: np.ndarray) -> list[float | None]:
    return [None if value != value else value for value in values.tolist()]
