"""What happened in a run, written while it runs; ``analysis/recording.py`` names the columns."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from analysis import recording
from controllers.interface import Decision, FloatArray, Neighbour, Perception, Plan
from cosim.loop import ToWorld
from cosim.parquet_sink import ParquetSink
from cosim.world import EgoTruth, MapArea, Mishaps, Sensed, Snapshot

PLANS_PER_SECOND = 2.0
"""Rate at which plans are kept for replay [1/s of simulated time]."""
PLANS_PER_CHUNK = 1024
"""A plan's row is long: thousands that wait to be written would be most of what a process holds."""
REFERENCE_LINE = np.arange(-10.0, 121.0, 5.0)
"""Where along the route frame its axis is kept beside an overlay, which is in that frame [m]."""

_OVERLAY = json.JSONEncoder(sort_keys=True, allow_nan=False)
_UNPLANNED = (None,) * (len(recording.EGOS) - recording.EGOS.get_field_index("rule"))


class Recorder:
    """Writes egos, neighbours, plans, timing and what was sensed of one run.

    Use as a context manager: however the block is left, what was recorded until then is in the files.
    The wall clock appears in ``timing.parquet`` only.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._egos = ParquetSink(folder / "egos.parquet", recording.EGOS)
        self._neighbours = ParquetSink(folder / "neighbours.parquet", recording.NEIGHBOURS)
        self._plans = ParquetSink(folder / "plans.parquet", recording.PLANS, PLANS_PER_CHUNK)
        self._timing = ParquetSink(folder / "timing.parquet", recording.TIMING)
        self._sensing: ParquetSink | None = None
        self._planned_now: dict[str, tuple[Any, ...]] = {}
        self._last_kept_plan: dict[str, int] = {}
        self.first_time: float | None = None
        self.last_time: float | None = None
        self.teleports = 0
        self.mishaps = Mishaps()
        self.ego_names: set[str] = set()
        self.solves: dict[str, dict[str, int]] = {}
        """Programs by solver: how many, and how many of them were left unsolved."""

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Take note of one ego's plan, made at the beginning of a step."""
        name, time = perception.ego.name, perception.ego.time
        self._planned_now[name] = _planned_columns(perception, decision, plan)
        self._timing.add_row((time, name, 1000.0 * compute_s))
        if plan.solves is not None:
            counted = self.solves.setdefault(plan.solves.solver, {"programs": 0, "unsolved": 0})
            counted["programs"] += plan.solves.programs
            counted["unsolved"] += plan.solves.unsolved
        slot = math.floor(time * PLANS_PER_SECOND + 1e-6)
        if len(plan.times) > 0 and self._last_kept_plan.get(name) != slot:
            self._last_kept_plan[name] = slot
            self._plans.add_row(_plan_row(perception, plan, to_world))

    def stepped(self, snapshot: Snapshot) -> None:
        """Take note of the world after the step."""
        if self.first_time is None:
            self.first_time = snapshot.time
        self.last_time = snapshot.time
        self.teleports = snapshot.teleports
        self.mishaps = snapshot.mishaps
        for ego in snapshot.egos:
            self.ego_names.add(ego.name)
            planned = self._planned_now.get(ego.name)
            self._egos.add_row(
                (
                    snapshot.time,
                    *_ego_columns(ego),
                    planned is not None,
                    *(_UNPLANNED if planned is None else planned),
                )
            )
        self._planned_now.clear()
        self._neighbours.add_columns(_person_columns(snapshot))
        self._neighbours.add_columns(_vehicle_columns(snapshot))
        if snapshot.sensed is not None:
            if self._sensing is None:
                self._sensing = ParquetSink(self._folder / "sensing.parquet", recording.SENSING)
            for sensed in snapshot.sensed:
                self._sensing.add_columns(_sensing_columns(sensed))

    def write_map(self, areas: Sequence[MapArea]) -> None:
        """Write ``map.json``: lanes, crossings and walking areas near where the egos have been."""
        content = {
            "areas": [
                {
                    "name": area.name,
                    "kind": area.kind,
                    "crossing_kind": area.crossing_kind,
                    "width_m": round(area.width, 3),
                    "shape_m": np.round(area.shape, 3).tolist(),
                }
                for area in areas
            ]
        }
        write_json(self._folder / "map.json", content)

    def close(self) -> None:
        """Write the last rows of every file, also when one of them cannot be written."""
        errors: list[OSError] = []
        for sink in (self._egos, self._neighbours, self._plans, self._timing, self._sensing):
            try:
                if sink is not None:
                    sink.close()
            except OSError as error:
                errors.append(error)
        if errors:
            raise errors[0]


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write a JSON file with a stable layout; a file with this name is always complete."""
    part = path.with_name(path.name + ".part")
    part.write_text(json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n", "utf-8")
    part.replace(path)


def _ego_columns(ego: EgoTruth) -> tuple[Any, ...]:
    return (
        ego.name,
        ego.body.length,
        ego.body.width,
        ego.x,
        ego.y,
        ego.heading,
        ego.speed,
        ego.acceleration,
        ego.steering,
        ego.edge,
        ego.lane,
        ego.route_position,
        _finite(ego.speed_limit),
        _finite(ego.commanded_acceleration),
        _finite(ego.commanded_steering),
        _finite(ego.executed_x),
        _finite(ego.executed_y),
        _finite(ego.executed_speed),
        ego.intervention,
        ego.intervention_cause or None,
        ego.handed_back,
    )


def _planned_columns(perception: Perception, decision: Decision, plan: Plan) -> tuple[Any, ...]:
    gaps = perception.gaps
    return (
        None if decision.rule is None else decision.rule.value,
        decision.manoeuvre.value,
        decision.because,
        perception.road.reference,
        decision.target_lane,
        _gap(gaps.ahead),
        _gap(gaps.behind),
        _gap(gaps.left_ahead),
        _gap(gaps.left_behind),
        _gap(gaps.right_ahead),
        _gap(gaps.right_behind),
        plan.solved,
        plan.status,
        plan.passing,
        plan.slack,
    )


def _plan_row(perception: Perception, plan: Plan, to_world: ToWorld) -> tuple[Any, ...]:
    points: FloatArray = to_world(perception.ego.name, plan.along, plan.across)
    overlay = {
        name: [_finite(value) for value in np.ravel(values).tolist()] for name, values in plan.overlay.items()
    }
    if any(overlay.values()):
        line = to_world(perception.ego.name, REFERENCE_LINE, np.zeros(len(REFERENCE_LINE)))
        overlay["reference_line_m"] = np.round(np.ravel(line), 2).tolist()
    return (
        perception.ego.time,
        perception.ego.name,
        plan.passing,
        plan.times.tolist(),
        points[:, 0].tolist(),
        points[:, 1].tolist(),
        plan.speed.tolist(),
        _OVERLAY.encode(overlay),
    )


def _person_columns(snapshot: Snapshot) -> list[Any]:
    persons = snapshot.persons
    count = len(persons.names)
    diameter = 2.0 * persons.radius
    heading = [
        math.atan2(v, u) if u or v else None
        for u, v in zip(persons.x_speed.tolist(), persons.y_speed.tolist(), strict=True)
    ]
    return [
        np.full(count, snapshot.time),
        persons.names,
        ["pedestrian"] * count,
        persons.kind,
        persons.x,
        persons.y,
        heading,
        persons.x_speed,
        persons.y_speed,
        diameter,
        diameter,
        persons.edge,
        [crossing or None for crossing in persons.crossing],
        persons.phase,
    ]


def _vehicle_columns(snapshot: Snapshot) -> list[Any]:
    vehicles = snapshot.vehicles
    count = len(vehicles.names)
    return [
        np.full(count, snapshot.time),
        vehicles.names,
        ["vehicle"] * count,
        vehicles.kind,
        vehicles.x,
        vehicles.y,
        vehicles.heading,
        vehicles.speed * np.cos(vehicles.heading),
        vehicles.speed * np.sin(vehicles.heading),
        vehicles.length,
        vehicles.width,
        vehicles.lane,
        [None] * count,
        [None] * count,
    ]


def _sensing_columns(sensed: Sensed) -> list[Any]:
    count = len(sensed.names)
    return [
        [sensed.time] * count,
        [sensed.ego] * count,
        sensed.names,
        sensed.told.tolist(),
        sensed.state,
        *(
            [_finite(one) for one in values.tolist()]
            for values in (sensed.age, sensed.error, sensed.uncertainty)
        ),
    ]


def _gap(neighbour: Neighbour | None) -> float | None:
    return None if neighbour is None else neighbour.gap


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
