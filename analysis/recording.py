"""Columns of a recorded run: written by ``cosim``, read by ``analysis``.

Units are in the names; an undefined value is null. One row per step and object. Times are simulated
seconds. ``SCHEMA_VERSION`` changes whenever a column changes its name or meaning.
"""

from __future__ import annotations

import pyarrow as pa

SCHEMA_VERSION = "1"

INTERVENTIONS = {
    "tight_bend": "the ego was in a bend tighter than it can turn, too far off for SUMO to have it there",
    "way_lost": "SUMO had another route for the ego, or had it on another way through a junction",
    "off_lane": "the ego was too far beside or beyond its lane for SUMO to have it there",
    "held": "SUMO drove slower than it was told",
    "position": "SUMO's own driving ended elsewhere",
    "speed": "SUMO drove faster than it was told",
}
"""Causes of interventions and their meanings; of several that hold in a step the first one counts."""

_f = pa.float64()
_s = pa.string()
_b = pa.bool_()

EGOS = pa.schema(
    [
        ("time_s", _f),
        ("ego_id", _s),
        ("length_m", _f),
        ("width_m", _f),
        ("front_x_m", _f),  # centre of the front bumper, world frame
        ("front_y_m", _f),
        ("heading_rad", _f),
        ("speed_mps", _f),
        ("acceleration_mps2", _f),
        ("steering_rad", _f),
        ("edge", _s),
        ("lane", _s),
        ("route_position_m", _f),
        ("speed_limit_mps", _f),
        ("commanded_acceleration_mps2", _f),
        ("commanded_steering_rad", _f),
        ("executed_x_m", _f),
        ("executed_y_m", _f),
        ("executed_speed_mps", _f),
        ("intervention", _b),
        ("intervention_cause", _s),  # of INTERVENTIONS; null without an intervention
        ("handed_back", _b),
        ("planned", _b),  # a plan was made at the beginning of this step; the rest is null otherwise
        ("rule", _s),
        ("manoeuvre", _s),
        ("because", _s),
        ("lane_number", pa.int64()),  # Lane.number of the reference lane
        ("target_lane_number", pa.int64()),
        ("gap_ahead_m", _f),
        ("gap_behind_m", _f),
        ("gap_left_ahead_m", _f),
        ("gap_left_behind_m", _f),
        ("gap_right_ahead_m", _f),
        ("gap_right_behind_m", _f),
        ("solved", _b),
        ("plan_status", _s),
        ("passing", _s),
        ("slack_m", _f),
    ]
)

ADDED = frozenset({"intervention_cause"})
"""Columns that recordings of this version did not have from the beginning."""

NEIGHBOURS = pa.schema(
    [
        ("time_s", _f),
        ("object_id", _s),
        ("object_kind", _s),  # pedestrian | vehicle
        ("object_type", _s),  # SUMO type id
        ("x_m", _f),  # pedestrian: centre of the disc; vehicle: centre of the front bumper
        ("y_m", _f),
        ("heading_rad", _f),
        ("x_speed_mps", _f),
        ("y_speed_mps", _f),
        ("length_m", _f),  # pedestrian: diameter of the disc
        ("width_m", _f),
        ("edge_or_lane", _s),
        ("crossing_id", _s),  # crossing walked on or next, pedestrians only
        ("phase", _s),  # crossing | waiting | walking, pedestrians only
    ]
)

_list = pa.list_(_f)
PLANS = pa.schema(
    [
        ("time_s", _f),
        ("ego_id", _s),
        ("passing", _s),
        ("horizon_s", _list),
        ("x_m", _list),  # rear axle, world frame
        ("y_m", _list),
        ("speed_mps", _list),
        # JSON: name -> list of numbers, in the route frame; reference_line_m is the axis of that frame as
        # x, y of the world every 5 m, from 10 m behind the rear axle on
        ("overlay", _s),
    ]
)

TIMING = pa.schema(
    [
        ("time_s", _f),
        ("ego_id", _s),
        ("compute_ms", _f),  # decide and plan
    ]
)

SENSING = pa.schema(
    [
        ("time_s", _f),  # when the ego planned, at the beginning of a step
        ("ego_id", _s),
        ("object_id", _s),  # pedestrian near it
        ("told", _b),  # the controller knew of the pedestrian; the last three columns are null otherwise
        ("state", _s),  # visible | late | lost | missed | hidden | out_of_range
        ("age_s", _f),  # age of the measurement in use
        ("error_m", _f),  # from the estimated to the true position
        ("uncertainty_m", _f),  # standard deviation of the position along either axis
    ]
)
"""Written where the sensing is not perfect."""
