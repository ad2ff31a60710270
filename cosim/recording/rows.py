"""Objects from which the rows of a recording are made, with the sources in ``analysis/recording/columns.py``.

The rows of ``sensing.parquet`` are made directly from :class:`cosim.sensing.interface.Sensed`.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from controllers.interface import Decision, Perception, Plan
from cosim.arrays import FloatArray
from cosim.step.loop import ToWorld
from cosim.step.world import CrossingFacts, EgoTruth, MapArea, PersonsTruth, Traffic, VehiclesTruth

REFERENCE_LINE = np.arange(-10.0, 121.0, 5.0)
"""Positions along the route frame at which its axis is kept with an overlay, which uses that frame [m]."""
_OVERLAY = json.JSONEncoder(sort_keys=True, allow_nan=False)


@dataclass(frozen=True, slots=True)
class SeenSignal:
    """A traffic light as seen by an ego."""

    state: str
    x: float
    """Middle of the stop line on the ego's way [m]."""
    y: float


@dataclass(frozen=True)
class PlannedEgo:
    """One ego's plan, made at the beginning of a step: a row of timing.parquet and possibly plans.parquet."""

    perception: Perception
    decision: Decision
    plan: Plan
    compute_ms: float
    """Wall-clock time of deciding and planning [ms]."""
    to_world: ToWorld

    @cached_property
    def _points(self) -> FloatArray:
        return self.to_world(self.perception.ego.name, self.plan.along, self.plan.across)

    @property
    def x(self) -> FloatArray:
        """Planned positions of the rear axle in the world, x [m]."""
        return self._points[:, 0]

    @property
    def y(self) -> FloatArray:
        """Planned positions of the rear axle in the world, y [m]."""
        return self._points[:, 1]

    @cached_property
    def signal(self) -> SeenSignal | None:
        """The next traffic light on the ego's way; ``None`` if there is none."""
        ahead = [one for one in self.perception.road.signals if one.stop_line >= 0.0]
        if not ahead:
            return None
        first = min(ahead, key=lambda one: one.stop_line)
        place = self.to_world(self.perception.ego.name, np.array([first.stop_line]), np.zeros(1))
        return SeenSignal(first.state.value, float(place[0, 0]), float(place[0, 1]))

    @property
    def overlay(self) -> str:
        """The overlay of a replay as JSON, with the axis of the route frame unless the overlay is empty."""
        drawn = {
            name: [value if math.isfinite(value) else None for value in np.ravel(values).tolist()]
            for name, values in self.plan.overlay.items()
        }
        if any(drawn.values()):
            line = self.to_world(self.perception.ego.name, REFERENCE_LINE, np.zeros(len(REFERENCE_LINE)))
            drawn["reference_line_m"] = np.round(np.ravel(line), 2).tolist()
        return _OVERLAY.encode(drawn)


@dataclass(frozen=True, slots=True)
class SteppedEgo:
    """One ego after a step: a row of egos.parquet."""

    time: float
    """Simulated time [s]."""
    truth: EgoTruth
    planned: PlannedEgo | None
    """The plan made at the beginning of the step."""

    @property
    def has_plan(self) -> bool:
        """Whether the ego made a plan."""
        return self.planned is not None


@dataclass(frozen=True, slots=True)
class SteppedObjects:
    """All pedestrians or all vehicles after a step: rows of neighbours.parquet and traffic.parquet."""

    time: float
    """Simulated time [s]."""
    objects: PersonsTruth | VehiclesTruth
    traffic: Traffic | None = None
    """Further data, if the objects are the vehicles of all traffic."""


def map_entry(area: MapArea) -> dict[str, Any]:
    """Return the entry of an area in map.json."""
    return {
        "name": area.name,
        "kind": area.kind,
        "crossing_kind": area.crossing_kind,
        "width_m": round(area.width, 3),
        "shape_m": np.round(area.shape, 3).tolist(),
        **({"crossed": list(area.crossed)} if area.crossed else {}),
        **({"on_foot": True} if area.on_foot else {}),
        **({} if area.facts is None else _facts(area.facts)),
    }


def _facts(facts: CrossingFacts) -> dict[str, Any]:
    """Return the facts of a crossing; unknown ones are null."""
    degrees = {"longitude_deg": facts.longitude, "latitude_deg": facts.latitude}
    return {
        "lanes": facts.lanes,
        "speed_limit_mps": round(facts.speed_limit, 3) if math.isfinite(facts.speed_limit) else None,
        "refuge": facts.refuge,
        **{name: round(value, 7) if math.isfinite(value) else None for name, value in degrees.items()},
    }
