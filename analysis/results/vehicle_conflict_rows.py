"""vehicle_conflicts.csv: vehicles that came close to an ego or that an ego came close to."""

from __future__ import annotations

from analysis.encounters.vehicle_conflicts import KINDS
from analysis.results.numbered_rows import number_within_run
from analysis.results.origin import IDENTITY
from analysis.tables.column import Table, at_least_0, number, text

VEHICLE_CONFLICTS = Table(
    "vehicle_conflicts",
    "One row for each ego, other vehicle and kind of conflict with a TTC of at most 3 s, a PET of at most "
    "3 s, or a follower's DRAC above 3.4 m/s^2",
    (
        *IDENTITY,
        number_within_run("conflict_id"),
        text("ego_id", "ego vehicle", source="what.ego_id", required=True),
        text("vehicle_id", "the other vehicle", source="what.vehicle_id", required=True),
        text("vehicle_type", "its SUMO type", source="what.vehicle_type"),
        text(
            "kind",
            "followed: the other drives behind the ego; following: the ego drives behind the other; beside: "
            "about one direction, side by side; oncoming; crossing: any other angle",
            *KINDS,
            source="what.kind",
            required=True,
        ),
        number("t_start_s", "s", "first sample within the limits", source="what.start", required=True),
        number("t_end_s", "s", "last sample within the limits", source="what.end", required=True),
        at_least_0(
            "min_ttc_s",
            "s",
            "smallest time to collision of the two rectangles, straight on; empty without a collision course",
            source="what.min_ttc",
        ),
        number(
            "t_min_ttc_s",
            "s",
            "when it was; without one, when the ego was on the ground that both drove over",
            source="what.at",
            required=True,
        ),
        at_least_0(
            "drac_max_mps2",
            "m/s^2",
            "largest deceleration to avoid the collision of whoever follows; empty for other kinds",
            source="what.max_drac",
        ),
        at_least_0(
            "pet_s",
            "s",
            "time between the first leaving ground and the second arriving there; crossing only",
            source="what.pet",
        ),
        at_least_0("ego_speed_mps", "m/s", "speed of the ego then", source="what.ego_speed", required=True),
        at_least_0(
            "vehicle_speed_mps",
            "m/s",
            "speed of the other then",
            source="what.vehicle_speed",
            required=True,
        ),
        at_least_0(
            "ego_max_decel_mps2",
            "m/s^2",
            "hardest braking of the ego from t_start_s to t_end_s",
            source="what.ego_deceleration",
            required=True,
        ),
        number("x_m", "m", "centre of the ego then, world frame", source="what.x", required=True),
        number("y_m", "m", "centre of the ego then, world frame", source="what.y", required=True),
    ),
    ("run_id", "conflict_id"),
)
