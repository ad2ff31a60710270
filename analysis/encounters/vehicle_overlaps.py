"""Overlaps of an ego's rectangle with other vehicles, and the vehicle that moved into the other."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from analysis.arrays import FloatArray, IntArray
from analysis.geometry import gap_along, rectangle_separation
from analysis.recording.fine_grid import Grid
from analysis.recording.levels import Levels
from analysis.recording.tracks import Track

_SEPARATION_S = 2.0
_TOUCH_M = 1e-6


@dataclass(frozen=True, slots=True)
class VehicleOverlap:
    """One overlap of an ego with one vehicle; overlaps less than 2 s apart count as one."""

    ego_id: str
    vehicle_id: str
    vehicle_type: str
    start: float
    """[s]"""
    end: float
    depth: float
    """Largest penetration along the axis of least overlap [m]."""
    ego_closing: float
    """Speed at which the ego's own motion closed the last gap; nan if there was none [m/s]."""
    other_closing: float
    closed_by: str
    """``ego``, ``other``, or ``appeared`` for a vehicle first recorded inside the ego."""
    ego_speed: float
    other_speed: float
    x: float
    y: float


def find_overlaps(
    egos: Sequence[Track], vehicles: Sequence[Track], grid: Grid, levels: Levels
) -> list[VehicleOverlap]:
    """Return all overlaps on the same level, sorted by time and names."""
    found = []
    for ego in egos:
        for vehicle in vehicles:
            found.extend(_of_pair(ego, vehicle, grid, levels))
    return in_order(found)


def in_order(found: Iterable[VehicleOverlap]) -> list[VehicleOverlap]:
    """Return overlaps by time and names."""
    return sorted(found, key=lambda one: (one.start, one.ego_id, one.vehicle_id))


def _of_pair(ego: Track, vehicle: Track, grid: Grid, levels: Levels) -> list[VehicleOverlap]:
    first, last = max(ego.first, vehicle.first), min(ego.last, vehicle.last)
    if first > last or vehicle.name == ego.name:
        return []
    a = slice(first - ego.first, last - ego.first + 1)
    b = slice(first - vehicle.first, last - vehicle.first + 1)
    reach = 0.5 * float(np.hypot(ego.length, ego.width) + np.hypot(vehicle.length, vehicle.width))
    dx, dy = ego.x[a] - vehicle.x[b], ego.y[a] - vehicle.y[b]
    together = ~levels.apart[ego.level[a], vehicle.level[b]]
    near = np.flatnonzero((dx * dx + dy * dy <= reach * reach) & together)
    if len(near) == 0:
        return []
    own = near + first - ego.first
    other = near + first - vehicle.first
    gap, _ = rectangle_separation(*_body(ego, own), *_body(vehicle, other))
    hit = np.flatnonzero(gap < -_TOUCH_M)
    if len(hit) == 0:
        return []
    times = grid.time[near[hit] + first]
    groups = np.split(hit, np.flatnonzero(np.diff(times) >= _SEPARATION_S) + 1)
    return [_describe(ego, own[group], vehicle, other[group], gap[group], grid) for group in groups]


def _body(track: Track, at: IntArray) -> tuple[FloatArray, FloatArray, FloatArray, float, float]:
    """Return a rectangle as :mod:`analysis.geometry` takes it: x, y, heading, length and width."""
    return track.x[at], track.y[at], track.heading[at], track.length, track.width


def _describe(
    ego: Track, own: IntArray, vehicle: Track, other: IntArray, gap: FloatArray, grid: Grid
) -> VehicleOverlap:
    i, j = int(own[0]), int(other[0])
    ego_closing, other_closing = np.nan, np.nan
    closed_by = "appeared"
    if i > 0 and j > 0:
        before, after = (_body(ego, np.array([at])) for at in (i - 1, i))
        before_other, after_other = (_body(vehicle, np.array([at])) for at in (j - 1, j))
        start, axis = rectangle_separation(*before, *before_other)
        step = float(grid.time[ego.first + i] - grid.time[ego.first + i - 1])
        ego_closing = float(start[0] - gap_along(axis, *after, *before_other)[0]) / step
        other_closing = float(start[0] - gap_along(axis, *before, *after_other)[0]) / step
        closed_by = "ego" if ego_closing > 0.0 and ego_closing >= other_closing else "other"
    return VehicleOverlap(
        ego_id=ego.name,
        vehicle_id=vehicle.name,
        vehicle_type=vehicle.kind,
        start=float(grid.time[ego.first + i]),
        end=float(grid.time[ego.first + int(own[-1])]),
        depth=float(-gap.min()),
        ego_closing=ego_closing,
        other_closing=other_closing,
        closed_by=closed_by,
        ego_speed=float(ego.speed[i]),
        other_speed=float(vehicle.speed[j]),
        x=float(ego.x[i]),
        y=float(ego.y[i]),
    )
