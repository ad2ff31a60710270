"""vehicle_overlaps.csv: every overlap of an ego with another vehicle."""

from __future__ import annotations

from analysis.results.numbered_rows import number_within_run
from analysis.results.origin import IDENTITY
from analysis.tables.column import Table, at_least_0, number, text

VEHICLE_OVERLAPS = Table(
    "vehicle_overlaps",
    "One row for each overlap of an ego with another vehicle",
    (
        *IDENTITY,
        number_within_run("overlap_id"),
        text("ego_id", "ego vehicle", source="what.ego_id", required=True),
        text("vehicle_id", "the other vehicle", source="what.vehicle_id", required=True),
        text("vehicle_type", "its SUMO type", source="what.vehicle_type"),
        number("t_start_s", "s", "first sample with an overlap", source="what.start", required=True),
        number("t_end_s", "s", "last sample with an overlap", source="what.end", required=True),
        at_least_0("depth_m", "m", "largest penetration", source="what.depth", required=True),
        text(
            "closed_by",
            "whose motion closed the last gap; appeared: recorded inside the ego from the beginning",
            *("ego", "other", "appeared"),
            source="what.closed_by",
            required=True,
        ),
        number("ego_closing_mps", "m/s", "speed with which the ego closed it", source="what.ego_closing"),
        number(
            "other_closing_mps", "m/s", "speed with which the other closed it", source="what.other_closing"
        ),
        at_least_0("ego_speed_mps", "m/s", "speed of the ego", source="what.ego_speed", required=True),
        at_least_0("other_speed_mps", "m/s", "speed of the other", source="what.other_speed", required=True),
        number("x_m", "m", "centre of the ego, world frame", source="what.x", required=True),
        number("y_m", "m", "centre of the ego, world frame", source="what.y", required=True),
    ),
    ("run_id", "overlap_id"),
)
