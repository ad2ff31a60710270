"""Writes small recorded runs whose numbers can be derived by hand."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from analysis.recording.columns import EGOS, NEIGHBOURS, PLANS, SCHEMA_VERSION, TIMING, TRAFFIC

Motion = Callable[[float], tuple[float, float]]
"""Time -> position."""

ZEBRA = {
    "name": "zebra",
    "kind": "crossing",
    "crossing_kind": "zebra",
    "width_m": 4.0,
    "shape_m": [[32.5, -5.0], [32.5, 5.0]],
}


@dataclass
class Ego:
    """An ego; the motion is that of its centre, speed and acceleration are its derivatives."""

    motion: Motion
    name: str = "ego"
    start: float = 0.0
    end: float = 1e9
    length: float = 4.5
    width: float = 1.8
    columns: dict[str, Callable[[float], Any]] = field(default_factory=dict)


@dataclass
class Person:
    """A pedestrian; the phase is a function of time, and the crossing may be one."""

    motion: Motion
    name: str = "ped"
    start: float = 0.0
    end: float = 1e9
    radius: float = 0.25
    crossing: str | Callable[[float], str] | None = "zebra"
    phase: Callable[[float], str] = lambda t: "crossing"


@dataclass
class Vehicle:
    """Another vehicle; the motion is that of its centre, heading east."""

    motion: Motion
    name: str = "car"
    start: float = 0.0
    end: float = 1e9
    length: float = 4.5
    width: float = 1.8
    heading: float = 0.0


def line(x: float, y: float, u: float, v: float) -> Motion:
    """Return uniform motion from (x, y) at t = 0."""
    return lambda t: (x + u * t, y + v * t)


def _velocity(motion: Motion, t: float) -> np.ndarray:
    h = 1e-4
    velocity: np.ndarray = (np.array(motion(t + h)) - np.array(motion(t - h))) / (2 * h)
    return velocity


def _acceleration(motion: Motion, t: float) -> np.ndarray:
    h = 1e-3
    acceleration: np.ndarray = (_velocity(motion, t + h) - _velocity(motion, t - h)) / (2 * h)
    return acceleration


def _ego_row(ego: Ego, t: float, last_heading: dict[str, float]) -> dict[str, Any]:
    x, y = ego.motion(t)
    velocity = _velocity(ego.motion, t)
    speed = float(np.hypot(*velocity))
    if speed > 1e-6:
        last_heading[ego.name] = float(np.arctan2(velocity[1], velocity[0]))
    heading = last_heading.get(ego.name, 0.0)
    acceleration = float(_acceleration(ego.motion, t) @ [np.cos(heading), np.sin(heading)])
    row: dict[str, Any] = dict.fromkeys(EGOS.names())
    row.update(
        time_s=t,
        ego_id=ego.name,
        length_m=ego.length,
        width_m=ego.width,
        front_x_m=x + 0.5 * ego.length * np.cos(heading),
        front_y_m=y + 0.5 * ego.length * np.sin(heading),
        heading_rad=heading,
        speed_mps=speed if speed > 1e-6 else 0.0,
        acceleration_mps2=round(acceleration, 6),
        steering_rad=0.0,
        speed_limit_mps=13.89,
        intervention=False,
        handed_back=False,
        planned=True,
        solved=True,
        plan_status="ok",
        passing="",
        slack_m=0.0,
        lane_number=0,
    )
    row.update({name: value(t) for name, value in ego.columns.items()})
    return row


def _person_row(person: Person, t: float) -> dict[str, Any]:
    x, y = person.motion(t)
    u, v = _velocity(person.motion, t)
    return {
        "time_s": t,
        "object_id": person.name,
        "object_kind": "pedestrian",
        "object_type": "adult",
        "x_m": x,
        "y_m": y,
        "heading_rad": None,
        "x_speed_mps": round(float(u), 9),
        "y_speed_mps": round(float(v), 9),
        "length_m": 2 * person.radius,
        "width_m": 2 * person.radius,
        "edge_or_lane": "e",
        "crossing_id": person.crossing(t) if callable(person.crossing) else person.crossing,
        "phase": person.phase(t),
    }


def _vehicle_row(vehicle: Vehicle, t: float) -> dict[str, Any]:
    x, y = vehicle.motion(t)
    u, v = _velocity(vehicle.motion, t)
    return {
        "time_s": t,
        "object_id": vehicle.name,
        "object_kind": "vehicle",
        "object_type": "car",
        "x_m": x + 0.5 * vehicle.length * np.cos(vehicle.heading),
        "y_m": y + 0.5 * vehicle.length * np.sin(vehicle.heading),
        "heading_rad": vehicle.heading,
        "x_speed_mps": round(float(u), 9),
        "y_speed_mps": round(float(v), 9),
        "length_m": vehicle.length,
        "width_m": vehicle.width,
        "edge_or_lane": "l",
        "crossing_id": None,
        "phase": None,
    }


def write_run(
    folder: Path,
    egos: Sequence[Ego],
    persons: Sequence[Person] = (),
    vehicles: Sequence[Vehicle] = (),
    *,
    step: float = 0.1,
    duration: float = 10.0,
    areas: Sequence[dict[str, Any]] = (ZEBRA,),
    **meta: Any,
) -> Path:
    """Write the folder of a recorded run and return it."""
    folder.mkdir(parents=True, exist_ok=True)
    times = [round(k * step, 6) for k in range(round(duration / step) + 1)]
    headings: dict[str, float] = {}
    ego_rows = [_ego_row(e, t, headings) for t in times for e in egos if e.start <= t <= e.end]
    objects: list[dict[str, Any]] = []
    for t in times:
        objects.extend(_person_row(p, t) for p in persons if p.start <= t <= p.end)
        objects.extend(_vehicle_row(v, t) for v in vehicles if v.start <= t <= v.end)
    timing = [{"time_s": row["time_s"], "ego_id": row["ego_id"], "compute_ms": 1.0} for row in ego_rows]
    for table, rows in ((EGOS, ego_rows), (NEIGHBOURS, objects), (PLANS, []), (TIMING, timing)):
        pq.write_table(pa.Table.from_pylist(rows, schema=table.schema), folder / table.file)
    (folder / "map.json").write_text(json.dumps({"areas": list(areas)}))
    description = {
        "run_id": "0123456789abcdef",
        "scenario_id": "by_hand",
        "controller": "scripted",
        "config_id": "scripted-0",
        "seed": 1,
        "tool_version": "0",
        "git_sha": None,
        "sumo_version": "none",
        "start_utc": "2026-01-01T00:00:00+00:00",
        "wall_s": 1.0,
        "step_s": step,
        "warmup_s": 0.0,
        "duration_s": duration,
        "valid": True,
        "invalid_reason": None,
        "actuation": "hybrid",
        "sensing": "perfect",
        "parameters": {},
        "inputs": {},
        "n_teleports": 0,
        "recording_schema_version": SCHEMA_VERSION,
        **meta,
    }
    (folder / "run.json").write_text(json.dumps(description))
    return folder


def write_traffic(folder: Path, cars: Sequence[Ego], persons: Sequence[Person]) -> None:
    """Add to a run's folder a recording of everybody: its egos, these cars and pedestrians."""
    egos = pq.read_table(folder / EGOS.file).to_pylist()
    times = sorted({row["time_s"] for row in egos})
    headings: dict[str, float] = {}
    rows = [(row, True) for row in egos]
    rows += [(_ego_row(one, t, headings), False) for t in times for one in cars if one.start <= t <= one.end]
    table = [_traffic_row(row, is_ego) for row, is_ego in rows]
    table += [_person_row(one, t) for t in times for one in persons if one.start <= t <= one.end]
    table.sort(key=lambda row: row["time_s"])
    pq.write_table(pa.Table.from_pylist(table, schema=TRAFFIC.schema), folder / TRAFFIC.file)


def _traffic_row(row: dict[str, Any], is_ego: bool) -> dict[str, Any]:
    speed, heading = row["speed_mps"], row["heading_rad"]
    return {
        **{name: row[name] for name in ("time_s", "heading_rad", "length_m", "width_m")},
        **{name: row[name] for name in ("acceleration_mps2", "speed_limit_mps")},
        "object_id": row["ego_id"],
        "object_kind": "vehicle",
        "object_type": "car",
        "vehicle_class": "passenger",
        "is_ego": is_ego,
        "x_m": row["front_x_m"],
        "y_m": row["front_y_m"],
        "x_speed_mps": speed * np.cos(heading),
        "y_speed_mps": speed * np.sin(heading),
        "edge_or_lane": "l",
    }
