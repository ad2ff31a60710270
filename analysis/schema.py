"""Every column of every CSV file, once: order, type, unit and meaning.

The files, ``datapackage.json`` and ``docs/metrics.md`` follow from here.
"""

from __future__ import annotations

from dataclasses import dataclass

from analysis.recording.columns import INTERVENTIONS

SCHEMA_VERSION = "2"
"""Of the CSV files; changes whenever a column changes its name or meaning."""


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a CSV file."""

    name: str
    kind: str
    """``string``, ``integer``, ``number`` or ``boolean`` (written 0 or 1)."""
    unit: str
    """Empty for texts and names."""
    description: str
    choices: tuple[str, ...] = ()
    minimum: float | None = None
    required: bool = False


@dataclass(frozen=True, slots=True)
class Table:
    """One CSV file."""

    name: str
    description: str
    columns: tuple[Column, ...]
    key: tuple[str, ...]

    @property
    def file(self) -> str:
        """Name of the file."""
        return f"{self.name}.csv"

    def names(self) -> tuple[str, ...]:
        """Return the columns in order."""
        return tuple(column.name for column in self.columns)


def _text(name: str, description: str, *choices: str, required: bool = False) -> Column:
    return Column(name, "string", "", description, choices, required=required)


def _count(name: str, description: str, required: bool = False) -> Column:
    return Column(name, "integer", "1", description, minimum=0.0, required=required)


def _flag(name: str, description: str, required: bool = False) -> Column:
    return Column(name, "boolean", "1", description, required=required)


def _at_least_0(name: str, unit: str, description: str, required: bool = False) -> Column:
    return Column(name, "number", unit, description, minimum=0.0, required=required)


def _number(name: str, unit: str, description: str, required: bool = False) -> Column:
    return Column(name, "number", unit, description, required=required)


_IDENTITY = (
    _text("schema_version", "version of this table's schema", required=True),
    _text("run_id", "hash of the run's inputs", required=True),
)
_ORIGIN = (
    _text("config_id", "controller and parameters, without the seed", required=True),
    _text("scenario_id", "scenario", required=True),
    Column("seed", "integer", "1", "seed of the run", required=True),
)

ENCOUNTERS = Table(
    "encounters",
    "One row for each encounter of an ego and a pedestrian",
    (
        *_IDENTITY,
        Column("encounter_id", "integer", "1", "number within the run, from 1", minimum=1.0, required=True),
        *_ORIGIN,
        _text("ego_id", "ego vehicle", required=True),
        _text("ped_id", "pedestrian", required=True),
        _text("ped_type", "SUMO type of the pedestrian"),
        _text("crossing_id", "crossing he is on or waits for; empty away from crossings"),
        _text("crossing_type", "kind of that crossing", "zebra", "unmarked", "signal"),
        _text(
            "priority",
            "who has priority there: ped at a zebra, ego at an unmarked crossing and on the open road, "
            "none where signals decide or the crossing is not on the map",
            "ped",
            "ego",
            "none",
            required=True,
        ),
        _text("passage_id", "ego, crossing and number of the passage; groups encounters"),
        _number("t_start_s", "s", "both are within the encounter range from here on", required=True),
        _number("t_end_s", "s", "one has left that range, or the recording ends", required=True),
        _flag("entered", "he was on the crossing or in the ego's path, not only waiting", required=True),
        _flag("censored", "the recording ended before the encounter was over", required=True),
        _text("conflict_type", "geometry", "crossing", "longitudinal", "turning", required=True),
        _text("first_user", "who left the conflict area first", "ego", "ped", "none", required=True),
        _at_least_0("ego_length_m", "m", "length of the ego's rectangle", required=True),
        _at_least_0("ego_width_m", "m", "width of the ego's rectangle", required=True),
        _at_least_0("ped_radius_m", "m", "radius of the pedestrian's disc", required=True),
        _at_least_0("min_ttc_s", "s", "smallest exact two-dimensional time to collision"),
        _number("t_min_ttc_s", "s", "when it was"),
        _text(
            "ttc_status",
            "why min_ttc_s has its value or has none",
            "ok",
            "no_collision_course",
            "not_entered",
            "collision",
            required=True,
        ),
        _at_least_0("min_ttc_1d_s", "s", "smallest time to collision along the ego's direction"),
        _at_least_0("pet_area_s", "s", "post-encroachment time over the conflict area"),
        _text(
            "pet_status",
            "why pet_area_s has its value or has none",
            "ok",
            "no_crossing",
            "interleaved",
            "censored",
            "collision",
            required=True,
        ),
        _at_least_0("et_ego_s", "s", "time of the ego in the conflict area"),
        _at_least_0("et_ped_s", "s", "time of the pedestrian in the conflict area"),
        _at_least_0("gap_time_s", "s", "predicted arrival of the second user when the first one leaves"),
        _at_least_0("tadv_min_s", "s", "smallest predicted time advantage"),
        _at_least_0("t2_min_s", "s", "smallest predicted time until the second user arrives"),
        _at_least_0("min_dist_m", "m", "smallest distance between the surfaces", required=True),
        _number("t_min_dist_s", "s", "when it was", required=True),
        _at_least_0(
            "clearance_min_m", "m", "smallest distance with the ego moving and the pedestrian on the road"
        ),
        _at_least_0("close_pass_speed_mps", "m/s", "highest speed of the ego while nearer than close_pass_m"),
        _at_least_0("dce_m", "m", "smallest predicted distance of closest encounter"),
        _at_least_0("ttce_s", "s", "predicted time to it"),
        _at_least_0("drac_max_mps2", "m/s^2", "largest deceleration needed to avoid the collision"),
        _text(
            "drac_status",
            "why drac_max_mps2 has its value or has none",
            "ok",
            "unbounded",
            "not_entered",
            "collision",
            required=True,
        ),
        _at_least_0("mdrac_max_mps2", "m/s^2", "the same after a reaction time"),
        _at_least_0("mdrac_prt_s", "s", "that reaction time", required=True),
        _text(
            "mdrac_status",
            "why mdrac_max_mps2 has its value or has none",
            "ok",
            "unavoidable_at_PRT",
            "not_entered",
            "collision",
            required=True,
        ),
        _at_least_0("tet_1p5_s", "s", "time with TTC of at most 1.5 s", required=True),
        _at_least_0("tit_1p5_s2", "s^2", "integral of 1.5 s − TTC", required=True),
        _at_least_0("tet_3p0_s", "s", "time with TTC of at most 3.0 s", required=True),
        _at_least_0("tit_3p0_s2", "s^2", "integral of 3.0 s − TTC", required=True),
        _at_least_0("ego_speed_at_min_ttc_mps", "m/s", "speed of the ego at the smallest TTC"),
        _at_least_0("ped_speed_at_min_ttc_mps", "m/s", "speed of the pedestrian at the smallest TTC"),
        _at_least_0("conflicting_speed_mps", "m/s", "speed of the ego when its evasive action begins"),
        _at_least_0("time_to_accident_s", "s", "TTC when the ego's evasive action begins"),
        _at_least_0("max_speed_mps", "m/s", "highest speed of either while TTC is low"),
        _at_least_0("delta_s_mps", "m/s", "relative speed at the smallest TTC"),
        _at_least_0("delta_v_ped_mps", "m/s", "change of the pedestrian's speed in an inelastic collision"),
        _at_least_0("ego_max_decel_mps2", "m/s^2", "largest deceleration of the ego", required=True),
        _at_least_0("ego_max_abs_jerk_mps3", "m/s^3", "largest jerk of the ego"),
        _at_least_0("ego_max_lat_accel_mps2", "m/s^2", "largest lateral acceleration of the ego"),
        _flag("ego_stopped", "the ego stood during the encounter", required=True),
        _at_least_0("ped_wait_s", "s", "time the pedestrian stood at the kerb"),
        _at_least_0("ped_delay_s", "s", "delay of the pedestrian"),
        _flag("yielded", "the ego let him go first; empty where it could not have"),
        _number("evasive_t_s", "s", "beginning of the ego's evasive action"),
        _text("evasive_status", "whether there was one", "braked", "none", required=True),
        _flag("collision", "contact with the ego moving", required=True),
        _count("n_collisions", "such contacts, those of one pair within 2 s being one", required=True),
        _number("t_collision_s", "s", "first contact"),
        _flag("contact_standing", "the pedestrian touched the standing ego", required=True),
        _at_least_0("impact_speed_kmh", "km/h", "speed of the ego at first contact"),
        _text("impact_side", "side of the ego that was touched", "front", "rear", "left", "right"),
        _at_least_0("p_fatal_rosen2009", "1", "risk of death at the impact speed"),
        _at_least_0("p_mais3_mm2025", "1", "risk of MAIS3+ or death at the impact speed"),
        _text(
            "severity",
            "level of the encounter",
            "collision",
            "severe",
            "serious",
            "slight",
            "none",
            required=True,
        ),
        _number("x_conflict_m", "m", "centre of the conflict area, world frame"),
        _number("y_conflict_m", "m", "centre of the conflict area, world frame"),
        _text(
            "controller_status", "whether every plan was solved", "ok", "infeasible", "timeout", required=True
        ),
        _text(
            "contact_place",
            "where the pedestrian was touched; empty without a contact",
            "crossing",
            "carriageway",
            "walking_area_or_kerb",
        ),
        _text(
            "contact_moved_by",
            "whose motion closed the last gap; empty without a contact, or without a gap before it",
            "ego",
            "pedestrian",
            "both",
        ),
        _text(
            "contact_class",
            "kind of contact; empty without one",
            "ego",
            "rolled_off",
            "walked_in",
            "appeared",
            "touching_at_start",
        ),
        _at_least_0(
            "contact_risk_seen_s",
            "s",
            "time from when a careful driver could see the risk to the contact; empty where he could not",
        ),
        _flag(
            "preventable_r157",
            "a careful driver would have prevented the contact, without one: could have stopped; "
            "empty where undefined",
        ),
        _at_least_0(
            "visible_before_conflict_s",
            "s",
            "time for which the ego had been told of him; empty where it knew",
        ),
        _flag("late_entry", "he entered inside the ego's comfort stopping distance; empty where undefined"),
        _at_least_0("k_mean_s", "s", "mean risk-perception coefficient of the approach"),
        _count("n_interventions", "steps at which SUMO did something else", required=True),
        _count("n_straight", "plans under the rule STRAIGHT", required=True),
        _count("n_lane_change", "plans under the rule LANE CHANGE", required=True),
        _count("n_autonomous", "plans under the rule AUTONOMOUS", required=True),
        _at_least_0("slack_share", "1", "share of plans that violated a soft constraint"),
        _count("side_changes", "changes of the passing class", required=True),
        _text("actuation", "how the ego was moved", required=True),
        _text("sensing", "what the ego could sense", required=True),
    ),
    ("run_id", "encounter_id"),
)

RUNS = Table(
    "runs",
    "One row for each run",
    (
        *_IDENTITY,
        *_ORIGIN,
        _text("controller", "name of the controller", required=True),
        _text("tool_version", "version of this tool"),
        _text("git_sha", "commit of the checkout that ran"),
        _text("sumo_version", "version of SUMO"),
        _text("wall_start_utc", "wall-clock time at the start, ISO 8601"),
        _at_least_0("wall_s", "s", "wall-clock time of the run"),
        _at_least_0("wall_rtf", "1", "simulated time over wall-clock time"),
        _at_least_0("step_s", "s", "step of the simulation", required=True),
        _at_least_0("warmup_s", "s", "simulated before the recording"),
        _at_least_0("duration_s", "s", "recorded time"),
        _flag("valid", "the run went to its end without a fault", required=True),
        _text("invalid_reason", "the fault"),
        _text("actuation", "how the ego was moved", required=True),
        _text("sensing", "what the ego could sense", required=True),
        _count("ego_count", "egos", required=True),
        _at_least_0("ego_dist_km", "km", "way of all egos", required=True),
        _at_least_0("ego_time_h", "h", "time of all egos", required=True),
        _count("ped_count", "pedestrians in some encounter", required=True),
        _count("n_encounters", "encounters", required=True),
        _count("n_entered", "encounters in which the pedestrian entered", required=True),
        _count("n_passages", "passages of an ego over a crossing with an encounter", required=True),
        _count("n_ttc_defined", "encounters with a TTC", required=True),
        _count("n_ttc_lt_1p0", "encounters with TTC below 1.0 s", required=True),
        _count("n_ttc_lt_1p5", "encounters with TTC below 1.5 s", required=True),
        _count("n_ttc_lt_3p0", "encounters with TTC below 3.0 s", required=True),
        _count("n_pet_defined", "encounters with a PET", required=True),
        _count("n_pet_lt_1p0", "encounters with PET below 1.0 s", required=True),
        _count("n_pet_lt_1p5", "encounters with PET below 1.5 s", required=True),
        _count("n_pet_lt_3p0", "encounters with PET below 3.0 s", required=True),
        _count("n_pet_lt_5p0", "encounters with PET below 5.0 s", required=True),
        _count("n_drac_gt_3p4", "encounters with DRAC above 3.4 m/s^2 or unbounded", required=True),
        _count("n_mdrac_gt_3p4", "encounters with MDRAC above 3.4 m/s^2 or unavoidable", required=True),
        _count("n_collisions", "contacts with a moving ego", required=True),
        _count("n_collisions_preventable", "those that a careful driver prevents", required=True),
        _count("n_collisions_crossing", "those on a crossing", required=True),
        _count("n_collisions_carriageway", "those on the carriageway", required=True),
        _count("n_collisions_walking_area_or_kerb", "those on a walking area or at the kerb", required=True),
        _count("n_collisions_moved_by_ego", "those in which the ego closed the last gap", required=True),
        _count("n_collisions_moved_by_pedestrian", "those in which the pedestrian closed it", required=True),
        _count("n_collisions_moved_by_both", "those in which both closed it", required=True),
        _count("n_collisions_class_ego", "collisions of no other class", required=True),
        _count(
            "n_collisions_class_rolled_off",
            "those in which the ego began to move while a pedestrian touched it",
            required=True,
        ),
        _count(
            "n_collisions_class_appeared",
            "those with a pedestrian who appeared in view inside the stopping distance",
            required=True,
        ),
        _count("n_collisions_class_touching_at_start", "those there from the first sample on", required=True),
        _count("n_contacts_standing", "encounters with a contact with the standing ego", required=True),
        _count("n_severity_severe", "severe encounters", required=True),
        _count("n_severity_serious", "serious encounters", required=True),
        _count("n_severity_slight", "slight encounters", required=True),
        _count("n_severity_none", "encounters without severity", required=True),
        _at_least_0("min_ttc_s", "s", "smallest TTC"),
        _at_least_0("p05_min_ttc_s", "s", "5th percentile of the encounters' defined smallest TTC"),
        _at_least_0("min_pet_s", "s", "smallest PET"),
        _at_least_0("tet_1p5_s", "s", "time with TTC of at most 1.5 s", required=True),
        _at_least_0("tit_1p5_s2", "s^2", "integral of 1.5 s − TTC", required=True),
        _at_least_0("min_dist_m", "m", "smallest distance"),
        _count("n_clearance_defined", "encounters with a clearance", required=True),
        _at_least_0("clearance_min_m", "m", "smallest clearance"),
        _at_least_0("clearance_p01_m", "m", "1st percentile of the encounters' clearance"),
        _at_least_0("clearance_p05_m", "m", "5th percentile of the encounters' clearance"),
        _count("n_close_passes", "encounters passed too close and too fast", required=True),
        _at_least_0("max_decel_mps2", "m/s^2", "largest deceleration of any step", required=True),
        _count("n_hard_brake", "hard braking manoeuvres", required=True),
        _at_least_0("p95_abs_jerk_mps3", "m/s^3", "95th percentile of the jerk over all steps"),
        _count("n_late_entries", "encounters with a late entry", required=True),
        _count("yields", "egos that let a pedestrian go first", required=True),
        _count("yieldable", "encounters in which the ego could have yielded", required=True),
        _at_least_0("yield_rate", "1", "yields over yieldable"),
        _count("n_ped_delay_defined", "pedestrians and crossings with a delay", required=True),
        _at_least_0("ped_delay_mean_s", "s", "mean delay of pedestrians"),
        _at_least_0("ped_delay_p95_s", "s", "95th percentile of it"),
        _text("ped_los_hcm2010", "level of service by mean delay", "A", "B", "C", "D", "E", "F"),
        _at_least_0("ego_mean_speed_mps", "m/s", "mean speed of the egos"),
        _number("ego_time_loss_s", "s", "delay of all egos against free flow"),
        _number("ego_delay_mean_s", "s", "the same for an ego"),
        _count("n_conflicts", "encounters of severity serious or worse", required=True),
        _at_least_0("conflicts_per_veh_km", "1/km", "those per way of the egos"),
        _at_least_0("conflicts_per_1000_ped", "1", "those per 1000 pedestrians"),
        _count("n_plans", "plans made", required=True),
        _count("n_solver_fail", "plans that were not solved", required=True),
        _count("n_shielded", "plans that the last check replaced by braking", required=True),
        _at_least_0("slack_share", "1", "share of plans that violated a soft constraint"),
        _count("n_interventions", "steps at which SUMO did something else", required=True),
        *(
            _count(f"n_interventions_{cause}", f"those in which {said}")
            for cause, said in INTERVENTIONS.items()
        ),
        _count("n_straight", "plans under the rule STRAIGHT", required=True),
        _count("n_lane_change", "plans under the rule LANE CHANGE", required=True),
        _count("n_autonomous", "plans under the rule AUTONOMOUS", required=True),
        _count("n_lane_changes", "completed lane changes", required=True),
        _count("side_changes", "changes of the passing class", required=True),
        _count("n_stopped_on_crossing", "stops with the body over a crossing", required=True),
        _count("deadlock", "egos that stood for too long with a free road", required=True),
        _count("n_vehicle_overlaps", "overlaps with other vehicles", required=True),
        _count("n_vehicle_overlaps_ego_closed", "those that the ego closed", required=True),
        _at_least_0("k_mean_s", "s", "mean risk-perception coefficient"),
        _at_least_0("compute_p50_ms", "ms", "median wall-clock time of a control step"),
        _at_least_0("compute_p95_ms", "ms", "95th percentile of it"),
        _at_least_0("compute_p99_ms", "ms", "99th percentile of it"),
        _count("n_teleports", "egos that SUMO teleported"),
        _at_least_0("sum_p_fatal_rosen2009", "1", "sum of the risks of death", required=True),
    ),
    ("run_id",),
)

VEHICLE_OVERLAPS = Table(
    "vehicle_overlaps",
    "One row for each overlap of an ego with another vehicle",
    (
        *_IDENTITY,
        Column("overlap_id", "integer", "1", "number within the run, from 1", minimum=1.0, required=True),
        _text("ego_id", "ego vehicle", required=True),
        _text("vehicle_id", "the other vehicle", required=True),
        _text("vehicle_type", "its SUMO type"),
        _number("t_start_s", "s", "first sample with an overlap", required=True),
        _number("t_end_s", "s", "last sample with an overlap", required=True),
        _at_least_0("depth_m", "m", "largest penetration", required=True),
        _text(
            "closed_by",
            "whose motion closed the last gap; appeared: recorded inside the ego from the beginning",
            "ego",
            "other",
            "appeared",
            required=True,
        ),
        _number("ego_closing_mps", "m/s", "speed with which the ego closed it"),
        _number("other_closing_mps", "m/s", "speed with which the other closed it"),
        _at_least_0("ego_speed_mps", "m/s", "speed of the ego", required=True),
        _at_least_0("other_speed_mps", "m/s", "speed of the other", required=True),
        _number("x_m", "m", "centre of the ego, world frame", required=True),
        _number("y_m", "m", "centre of the ego, world frame", required=True),
    ),
    ("run_id", "overlap_id"),
)

TABLES = (ENCOUNTERS, RUNS, VEHICLE_OVERLAPS)
