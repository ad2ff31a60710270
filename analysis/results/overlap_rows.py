"""vehicle_overlaps.csv: every overlap of an ego with another vehicle."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.encounters.vehicle_overlaps import VehicleOverlap
from analysis.results.origin import IDENTITY, Origin
from analysis.tables.column import Column, Table, at_least_0, number, text


@dataclass(frozen=True, slots=True)
class ListedOverlap:
    """One overlap of a run; what a row is made of."""

    origin: Origin
    number: int
    """Within the run, from 1."""
    overlap: VehicleOverlap


VEHICLE_OVERLAPS = Table(
    "vehicle_overlaps",
    "One row for each overlap of an ego with another vehicle",
    (
        *IDENTITY,
        Column(
            "overlap_id",
            "integer",
            "1",
            "number within the run, from 1",
            "number",
            minimum=1.0,
            required=True,
        ),
        text("ego_id", "ego vehicle", source="overlap.ego_id", required=True),
        text("vehicle_id", "the other vehicle", source="overlap.vehicle_id", required=True),
        text("vehicle_type", "its SUMO type", source="overlap.vehicle_type"),
        number("t_start_s", "s", "first sample with an overlap", source="overlap.start", required=True),
        number("t_end_s", "s", "last sample with an overlap", source="overlap.end", required=True),
        at_least_0("depth_m", "m", "largest penetration", source="overlap.depth", required=True),
        text(
            "closed_by",
            "whose motion closed the last gap; appeared: recorded inside the ego from the beginning",
            *("ego", "other", "appeared"),
            source="overlap.closed_by",
            required=True,
        ),
        number("ego_closing_mps", "m/s", "speed with which the ego closed it", source="overlap.ego_closing"),
        number(
            "other_closing_mps", "m/s", "speed with which the other closed it", source="overlap.other_closing"
        ),
        at_least_0("ego_speed_mps", "m/s", "speed of the ego", source="overlap.ego_speed", required=True),
        at_least_0(
            "other_speed_mps", "m/s", "speed of the other", source="overlap.other_speed", required=True
        ),
        number("x_m", "m", "centre of the ego, world frame", source="overlap.x", required=True),
        number("y_m", "m", "centre of the ego, world frame", source="overlap.y", required=True),
    ),
    ("run_id", "overlap_id"),
)
