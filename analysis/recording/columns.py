"""All columns of a recorded run, declared once: written by ``cosim``, read by ``analysis``.

Schema, writer, reader and the tables in ``docs/metrics.md`` follow from here, so a new column is one line.
A column's ``source`` is the path from the row objects of ``cosim/recording/rows.py`` to the value. Units are
in the names; an undefined value is null. Times are simulated seconds. ``SCHEMA_VERSION`` changes whenever a
column changes its name or meaning.
"""

from __future__ import annotations

from dataclasses import dataclass

import pyarrow as pa

from analysis.tables.column import Column, Table

SCHEMA_VERSION = "1"

INTERVENTIONS = {
    "tight_bend": "the ego was in a bend tighter than it can turn, too far off for SUMO to have it there",
    "way_lost": "SUMO had another route for the ego, or had it on another way through a junction",
    "off_lane": "the ego was too far beside or beyond its lane for SUMO to have it there, or that was closed",
    "held": "SUMO drove slower than it was told",
    "position": "SUMO's own driving ended elsewhere",
    "speed": "SUMO drove faster than it was told",
}
"""Causes of interventions and their meanings; if several hold in a step, the first one counts."""

_TYPES = {
    "string": pa.string(),
    "integer": pa.int64(),
    "number": pa.float64(),
    "boolean": pa.bool_(),
    "numbers": pa.list_(pa.float64()),
}


@dataclass(frozen=True, slots=True)
class RecordedColumn(Column):
    """One column of a recorded table."""

    judged: bool = False
    """Whether the analysis reads the column; other columns are for replays and for human readers."""
    added: bool = False
    """Whether early recordings of this version lack the column."""
    decimals: int | None = None
    """Decimals to which the column is rounded, where they differ from those of its table."""

    @property
    def dtype(self) -> pa.DataType:
        """Type in the file."""
        return _TYPES[self.kind]


@dataclass(frozen=True, slots=True)
class RecordedTable(Table):
    """One Parquet file. No two rows have the same time and the same key."""

    columns: tuple[RecordedColumn, ...]
    decimals: int | None = None
    """Decimals to which columns of numbers are rounded, which saves space; ``None`` if they are not."""

    @property
    def file(self) -> str:
        """Name of the file."""
        return f"{self.name}.parquet"

    @property
    def schema(self) -> pa.Schema:
        """Names and types in the file."""
        return pa.schema([(column.name, column.dtype) for column in self.columns])


def _text(name: str, source: str, description: str, *choices: str, judged: bool = False) -> RecordedColumn:
    return RecordedColumn(name, "string", "", description, source, choices, judged=judged)


def _number(name: str, unit: str, source: str, description: str, judged: bool = False) -> RecordedColumn:
    return RecordedColumn(name, "number", unit, description, source, judged=judged)


def _needed(
    name: str, unit: str, source: str, description: str, decimals: int | None = None
) -> RecordedColumn:
    """Declare a column of numbers without which a run cannot be judged."""
    return RecordedColumn(
        name, "number", unit, description, source, required=True, judged=True, decimals=decimals
    )


def _flag(name: str, source: str, description: str, judged: bool = True) -> RecordedColumn:
    return RecordedColumn(name, "boolean", "1", description, source, judged=judged)


def _own(name: str, description: str) -> RecordedColumn:
    """Return a column about the method's own part in a plan; null where it has none."""
    source = f"planned.plan.own.{name}"
    name = f"method_{name}"
    return RecordedColumn(name, "boolean", "1", description, source, judged=True, added=True)


def _lane(name: str, source: str, description: str, judged: bool = False) -> RecordedColumn:
    return RecordedColumn(name, "integer", "1", description, source, judged=judged)


def _numbers(name: str, unit: str, source: str, description: str) -> RecordedColumn:
    return RecordedColumn(name, "numbers", unit, description, source)


EGOS = RecordedTable(
    "egos",
    "One row for each ego and step: the state after the step, and the plan made at its beginning, if any",
    (
        _needed("time_s", "s", "time", "end of the step"),
        _text("ego_id", "truth.name", "ego vehicle", judged=True),
        _needed("length_m", "m", "truth.body.length", "length of its rectangle"),
        _needed("width_m", "m", "truth.body.width", "width of its rectangle"),
        _needed("front_x_m", "m", "truth.x", "centre of the front bumper, world frame"),
        _needed("front_y_m", "m", "truth.y", "centre of the front bumper, world frame"),
        _needed("heading_rad", "rad", "truth.heading", "heading"),
        _needed("speed_mps", "m/s", "truth.speed", "speed"),
        _needed("acceleration_mps2", "m/s^2", "truth.acceleration", "acceleration that was realised"),
        _number("steering_rad", "rad", "truth.steering", "steering angle that was realised"),
        _text("edge", "truth.edge", "edge that it drives on"),
        _text("lane", "truth.lane", "SUMO's lane; empty where SUMO lost it", judged=True),
        _number("route_position_m", "m", "truth.route_position", "way since it was taken over", judged=True),
        _number("speed_limit_mps", "m/s", "truth.speed_limit", "limit there, and its own", judged=True),
        _number(
            "commanded_acceleration_mps2", "m/s^2", "truth.commanded_acceleration", "acceleration commanded"
        ),
        _number("commanded_steering_rad", "rad", "truth.commanded_steering", "steering angle commanded"),
        _number("executed_x_m", "m", "truth.executed_x", "front bumper where SUMO has it after the step"),
        _number("executed_y_m", "m", "truth.executed_y", "front bumper where SUMO has it after the step"),
        _number("executed_speed_mps", "m/s", "truth.executed_speed", "speed that SUMO has for it"),
        _flag("intervention", "truth.intervention", "SUMO's position or speed differs from the plant's"),
        RecordedColumn(
            "intervention_cause",
            "string",
            "",
            "why; null without an intervention",
            "truth.intervention_cause",
            tuple(INTERVENTIONS),
            judged=True,
            added=True,
        ),
        _flag("handed_back", "truth.handed_back", "SUMO's driver has it"),
        _flag("planned", "has_plan", "a plan was made at the beginning of this step; null below otherwise"),
        _text(
            "rule",
            "planned.decision.rule",
            "decision rule",
            *("straight", "lane_change", "autonomous"),
            judged=True,
        ),
        _text("manoeuvre", "planned.decision.manoeuvre.value", "what was decided"),
        _text("because", "planned.decision.because", "why"),
        _lane("lane_number", "planned.perception.road.reference", "reference lane", judged=True),
        _lane("target_lane_number", "planned.decision.target_lane", "lane to be changed to"),
        _number(
            "gap_ahead_m", "m", "planned.perception.gaps.ahead.gap", "gap to who drives ahead", judged=True
        ),
        _number("gap_behind_m", "m", "planned.perception.gaps.behind.gap", "gap to who drives behind"),
        _number(
            "gap_left_ahead_m", "m", "planned.perception.gaps.left_ahead.gap", "gap ahead in the lane left"
        ),
        _number(
            "gap_left_behind_m", "m", "planned.perception.gaps.left_behind.gap", "gap behind in the lane left"
        ),
        _number(
            "gap_right_ahead_m", "m", "planned.perception.gaps.right_ahead.gap", "gap ahead in the lane right"
        ),
        _number(
            "gap_right_behind_m",
            "m",
            "planned.perception.gaps.right_behind.gap",
            "gap behind in the lane right",
        ),
        _flag("solved", "planned.plan.solved", "the plan was found, and is not the declared fallback"),
        _text("plan_status", "planned.plan.status", "what became of the plan", judged=True),
        _text("passing", "planned.plan.passing", "on which side whom the plan passes", judged=True),
        _number("slack_m", "m", "planned.plan.slack", "violation of soft constraints", judged=True),
        RecordedColumn(
            "signal_ahead",
            "string",
            "",
            "next traffic light on its way; null without one",
            "planned.signal.state",
            ("green", "amber", "red"),
            added=True,
        ),
        RecordedColumn("signal_x_m", "number", "m", "its stop line", "planned.signal.x", added=True),
        RecordedColumn("signal_y_m", "number", "m", "the same", "planned.signal.y", added=True),
        RecordedColumn(
            "method_stated",
            "boolean",
            "1",
            "the controller says which part of the plan is its method's own: the next four columns",
            "planned.plan.states_own",
            judged=True,
            added=True,
        ),
        _own("applies", "what the method's source demands for it to act holds"),
        _own("acts", "the command carries out the method's own plan for these pedestrians"),
        _own("deviates", "the command differs from that of free driving"),
        _own("overridden", "emergency braking, a last check or a fallback has the last word"),
    ),
    ("ego_id",),
)

NEIGHBOURS = RecordedTable(
    "neighbours",
    "One row for each pedestrian or vehicle near any ego and step",
    (
        _needed("time_s", "s", "time", "end of the step"),
        _text("object_id", "objects.names", "SUMO's name of it", judged=True),
        _text("object_kind", "objects.object_kind", "what it is", "pedestrian", "vehicle", judged=True),
        _text("object_type", "objects.kind", "SUMO type", judged=True),
        _needed("x_m", "m", "objects.x", "centre of a pedestrian's disc, of a vehicle's front bumper"),
        _needed("y_m", "m", "objects.y", "the same"),
        _number("heading_rad", "rad", "objects.heading", "heading; null for who stands", judged=True),
        _needed("x_speed_mps", "m/s", "objects.x_speed", "velocity to the east"),
        _needed("y_speed_mps", "m/s", "objects.y_speed", "velocity to the north"),
        _needed("length_m", "m", "objects.length", "of a pedestrian the disc's diameter"),
        _needed("width_m", "m", "objects.width", "of a pedestrian the disc's diameter"),
        _text("edge_or_lane", "objects.place", "edge walked on, lane driven on", judged=True),
        _text("crossing_id", "objects.crossing", "crossing walked on or next, of pedestrians", judged=True),
        _text("phase", "objects.phase", "of pedestrians", *("crossing", "waiting", "walking"), judged=True),
        RecordedColumn(
            "signal",
            "string",
            "",
            "light of that crossing for its pedestrians; null where there is none",
            "objects.signal",
            ("green", "red"),
            added=True,
        ),
    ),
    ("object_kind", "object_id"),  # SUMO lets a vehicle and a person share an id
)

TRAFFIC = RecordedTable(
    "traffic",
    "One row for each pedestrian within 20 m of a crossing, each vehicle within 60 m of one, and step; "
    "written where everybody is recorded, rounded to a thousandth, speeds and accelerations to a hundredth",
    (
        _needed("time_s", "s", "time", "end of the step"),
        _text("object_id", "objects.names", "SUMO's name of it", judged=True),
        _text("object_kind", "objects.object_kind", "what it is", "pedestrian", "vehicle", judged=True),
        _text("object_type", "objects.kind", "SUMO type", judged=True),
        _text("vehicle_class", "traffic.vehicle_class", "SUMO's class, of vehicles", judged=True),
        _flag("is_ego", "traffic.is_ego", "an ego now; null for pedestrians"),
        _needed("x_m", "m", "objects.x", "centre of a pedestrian's disc, of a vehicle's front bumper"),
        _needed("y_m", "m", "objects.y", "the same"),
        _number("heading_rad", "rad", "traffic.vehicles.heading", "heading, of vehicles", judged=True),
        _needed("x_speed_mps", "m/s", "objects.x_speed", "velocity to the east", decimals=2),
        _needed("y_speed_mps", "m/s", "objects.y_speed", "velocity to the north", decimals=2),
        RecordedColumn(
            "acceleration_mps2",
            "number",
            "m/s^2",
            "of vehicles",
            "traffic.acceleration",
            judged=True,
            decimals=2,
        ),
        _number(
            "speed_limit_mps",
            "m/s",
            "traffic.speed_limit",
            "the lane's and its own, of vehicles",
            judged=True,
        ),
        _needed("length_m", "m", "objects.length", "of a pedestrian the disc's diameter"),
        _needed("width_m", "m", "objects.width", "of a pedestrian the disc's diameter"),
        _text("edge_or_lane", "objects.place", "edge walked on, lane driven on", judged=True),
        _text("crossing_id", "objects.crossing", "crossing walked on or next, of pedestrians", judged=True),
        _text("phase", "objects.phase", "of pedestrians", *("crossing", "waiting", "walking"), judged=True),
        RecordedColumn(
            "signal",
            "string",
            "",
            "light of that crossing for its pedestrians; null where there is none",
            "objects.signal",
            ("green", "red"),
            judged=True,
            added=True,
        ),
    ),
    ("object_kind", "object_id"),
    decimals=3,
)

PLANS = RecordedTable(
    "plans",
    "One row for each plan that is kept, two in a simulated second",
    (
        _number("time_s", "s", "perception.ego.time", "when it was made"),
        _text("ego_id", "perception.ego.name", "ego vehicle"),
        _text("passing", "plan.passing", "on which side whom it passes"),
        _numbers("horizon_s", "s", "plan.times", "times since it was made"),
        _numbers("x_m", "m", "x", "rear axle then, world frame"),
        _numbers("y_m", "m", "y", "rear axle then, world frame"),
        _numbers("speed_mps", "m/s", "plan.speed", "speed then"),
        _text(
            "overlay",
            "overlay",
            "JSON: name to list of numbers in the route frame; reference_line_m is that frame's axis as x, y "
            "of the world every 5 m, from 10 m behind the rear axle on",
        ),
    ),
    ("ego_id",),
)

TIMING = RecordedTable(
    "timing",
    "One row for each plan",
    (
        _needed("time_s", "s", "perception.ego.time", "when it was made"),
        _text("ego_id", "perception.ego.name", "ego vehicle", judged=True),
        _needed("compute_ms", "ms", "compute_ms", "wall-clock time to decide and plan"),
    ),
    ("ego_id",),
)

SENSING = RecordedTable(
    "sensing",
    "One row for each ego that planned and pedestrian near it; written where the sensing is not perfect",
    (
        _needed("time_s", "s", "time", "when the ego planned, at the beginning of a step"),
        _text("ego_id", "ego", "ego vehicle", judged=True),
        _text("object_id", "names", "pedestrian near it", judged=True),
        _flag("told", "told", "the controller was told of the pedestrian; null below otherwise"),
        _text(
            "state",
            "state",
            "state of the measurement",
            *("visible", "late", "lost", "missed", "hidden", "out_of_range"),
        ),
        _number("age_s", "s", "age", "age of the measurement in use"),
        _number("error_m", "m", "error", "from the estimated to the true position"),
        _number("uncertainty_m", "m", "uncertainty", "standard deviation of the position along either axis"),
    ),
    ("ego_id", "object_id"),
)

RECORDED_TABLES = (EGOS, NEIGHBOURS, TRAFFIC, PLANS, TIMING, SENSING)
