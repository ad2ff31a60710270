"""vehicle_conflicts.csv: who came close to an ego, and whom an ego came close to."""

from __future__ import annotations

from dataclasses import dataclass

from analysis.encounters.vehicle_conflicts import KINDS, VehicleConflict
from analysis.results.origin import IDENTITY, Origin
from analysis.tables.column import Column, Table, at_least_0, number, text


@dataclass(frozen=True, slots=True)
class ListedConflict:
    """One conflict of a run; what a row is made of."""

    origin: Origin
    number: int
    """Within the run, from 1."""
    conflict: VehicleConflict


VEHICLE_CONFLICTS = Table(
    "vehicle_conflicts",
    "One row for each ego, other vehicle and kind of conflict with a TTC of at most 3 s, a PET of at most "
    "3 s, or a follower's DRAC above 3.4 m/s^2",
    (
        *IDENTITY,
        Column(
            "conflict_id",
            "integer",
            "1",
            "number within the run, from 1",
            "number",
            minimum=1.0,
            required=True,
        ),
        text("ego_id", "ego vehicle", source="conflict.ego_id", required=True),
        text("vehicle_id", "the other vehicle", source="conflict.vehicle_id", required=True),
        text("vehicle_type", "its SUMO type", source="conflict.vehicle_type"),
        text(
            "kind",
            "followed: the other drives behind the ego; following: the ego drives behind the other; beside: "
            "about one direction, side by side; oncoming; crossing: any other angle",
            *KINDS,
            source="conflict.kind",
            required=True,
        ),
        number("t_start_s", "s", "first sample within the limits", source="conflict.start", required=True),
        number("t_end_s", "s", "last sample within the limits", source="conflict.end", required=True),
        at_least_0(
            "min_ttc_s",
            "s",
            "smallest time to collision of the two rectangles, straight on; empty without a collision course",
            source="conflict.min_ttc",
        ),
        number(
            "t_min_ttc_s",
            "s",
            "when it was; without one, when the ego was on the ground that both drove over",
            source="conflict.at",
            required=True,
        ),
        at_least_0(
            "drac_max_mps2",
            "m/s^2",
            "largest deceleration to avoid the collision of whoever follows; empty for other kinds",
            source="conflict.max_drac",
        ),
        at_least_0(
            "pet_s",
            "s",
            "time between the first leaving ground and the second arriving there; crossing only",
            source="conflict.pet",
        ),
        at_least_0(
            "ego_speed_mps", "m/s", "speed of the ego then", source="conflict.ego_speed", required=True
        ),
        at_least_0(
            "vehicle_speed_mps",
            "m/s",
            "speed of the other then",
            source="conflict.vehicle_speed",
            required=True,
        ),
        at_least_0(
            "ego_max_decel_mps2",
            "m/s^2",
            "hardest braking of the ego from t_start_s to t_end_s",
            source="conflict.ego_deceleration",
            required=True,
        ),
        number("x_m", "m", "centre of the ego then, world frame", source="conflict.x", required=True),
        number("y_m", "m", "centre of the ego then, world frame", source="conflict.y", required=True),
    ),
    ("run_id", "conflict_id"),
)
