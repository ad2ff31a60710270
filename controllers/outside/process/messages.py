"""The messages of the step protocol: their contents and units, from which their JSON schema is made.

``python -m controllers.outside.process.messages docs/schemas/step-protocol-1.json`` writes the schema.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

PROTOCOL = 1
"""Version of the protocol; a change that a program has to know of raises it."""

Number = Annotated[float, Field(allow_inf_nan=False)]


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)


class Hello(_Message):
    """First message, from the program: who it is, and which protocol it speaks."""

    type: Literal["hello"]
    protocol: int
    """Must be 1."""
    token: str
    """The value of the environment variable COSIM_TOKEN."""
    name: str = ""
    """For messages; any text."""


class Start(_Message):
    """Answer to it: the run begins."""

    type: Literal["start"]
    protocol: int
    seed: int
    """Of everything random in the program; it follows from the run's seed and the ego's name."""


class Ego(_Message):
    """The ego; positions are those of its rear axle."""

    name: str
    time_s: Number
    """Simulated time."""
    x_m: Number
    y_m: Number
    heading_rad: Number
    """Counter-clockwise from east."""
    across_m: Number
    """Offset from the middle of its lane, left positive."""
    heading_error_rad: Number
    speed_mps: Number
    acceleration_mps2: Number
    steering_rad: Number
    """Front-wheel angle, left positive."""
    plan_interval_s: Number
    """Time until the next perception."""
    length_m: Number
    width_m: Number
    wheelbase_m: Number
    rear_overhang_m: Number
    drive_lag_s: Number
    steering_lag_s: Number
    max_acceleration_mps2: Number
    max_deceleration_mps2: Number
    max_steering_rad: Number
    max_steering_rate_radps: Number


class Pedestrian(_Message):
    """A pedestrian in the route frame: along forward of the ego's rear axle, across to the left."""

    name: str
    along_m: Number
    across_m: Number
    along_speed_mps: Number
    across_speed_mps: Number
    radius_m: Number
    crossing: int | None
    """Place in the list of crossings of the one walked on or next."""
    on_crossing: bool
    waiting: bool
    """Whether that crossing is their next edge."""
    uncertainty_m: Number
    """Standard deviation of the position along either axis."""


class Vehicle(_Message):
    """Another vehicle; along is its front bumper's, across its middle's."""

    name: str
    along_m: Number
    across_m: Number
    along_speed_mps: Number
    across_speed_mps: Number
    acceleration_mps2: Number
    heading_error_rad: Number
    length_m: Number
    width_m: Number


class Neighbour(_Message):
    """The next vehicle ahead or behind in one lane."""

    name: str
    gap_m: Number
    """Between bumpers; negative while they overlap along the lane."""
    speed_mps: Number
    acceleration_mps2: Number
    length_m: Number


class Gaps(_Message):
    """The neighbours; null: nobody within range."""

    ahead: Neighbour | None
    behind: Neighbour | None
    left_ahead: Neighbour | None
    left_behind: Neighbour | None
    right_ahead: Neighbour | None
    right_behind: Neighbour | None


class Lane(_Message):
    """A lane that the ego may use."""

    number: int
    """0 where the trip began, +1 for each lane further left."""
    offset_m: Number
    """Across coordinate of its middle."""
    width_m: Number
    follows_route_for_m: Number | None
    """Distance until it stops leading along the route; null: beyond the view."""


class Crossing(_Message):
    """A pedestrian crossing ahead, nearest first."""

    name: str
    kind: Literal["zebra", "unmarked", "signal"]
    entry_m: Number
    exit_m: Number
    stop_line_m: Number
    right_m: Number
    left_m: Number
    pedestrians_have_green: bool | None
    """null: no signal controls it."""


class Signal(_Message):
    """A stop line with a traffic light."""

    name: str
    stop_line_m: Number
    state: Literal["red", "amber", "green"]


class StopSign(_Message):
    """A stop line with a stop sign: who comes to it stops."""

    name: str
    stop_line_m: Number


class Foe(_Message):
    """A vehicle whose path crosses the ego's in a junction."""

    name: str
    entry_m: Number
    exit_m: Number
    stop_line_m: Number
    foe_entry_m: Number
    foe_exit_m: Number
    foe_speed_mps: Number
    must_yield: bool
    waiting_place_m: Number | None


class Road(_Message):
    """The road along the route."""

    lanes: list[Lane]
    reference: int
    """Number of the lane that the ego is in."""
    right_edge_m: Number
    left_edge_m: Number
    curvature_step_m: Number
    curvature_1pm: list[Number]
    """Of the reference lane, every curvature_step_m from the rear axle on."""
    limit_along_m: list[Number]
    limit_mps: list[Number]
    """Speed limits, each from its limit_along_m on."""
    crossings: list[Crossing]
    signals: list[Signal]
    stop_signs: list[StopSign]
    foes: list[Foe]
    route_end_m: Number | None
    """null: beyond the view."""


class Perception(_Message):
    """Sent every plan interval; the program answers with a command of the same step."""

    type: Literal["perception"]
    step: int
    ego: Ego
    pedestrians: list[Pedestrian]
    vehicles: list[Vehicle]
    gaps: Gaps
    road: Road


class Command(_Message):
    """The program's answer."""

    type: Literal["command"]
    step: int
    """That of the perception."""
    acceleration_mps2: Number | list[Number]
    """Desired acceleration, or one for each of times_s."""
    steering_rad: Number | list[Number] | None = None
    """Desired front-wheel angle; absent or null: the ego keeps its lane, or drives to target_lane."""
    times_s: list[Number] | None = None
    """From when on each value holds, ascending from 0; absent: one value for all times."""
    manoeuvre: Literal["keep", "change_left", "change_right", "abort_change", "hand_back"] = "keep"
    target_lane: int | None = None
    """Lane to end in; absent or null: the present one."""
    because: str = ""
    """Name of who or what mattered most."""
    solved: bool = True
    """Whether this is the wanted plan and not a fallback; the report counts steps that are not."""
    status: str = "ok"


class End(_Message):
    """Last message: the ego has left the road or the run is over; the program ends."""

    type: Literal["end"]


ANY: TypeAdapter[Any] = TypeAdapter(Hello | Start | Perception | Command | End)


def schema() -> dict[str, Any]:
    """Return the JSON schema of all messages."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"Step protocol of sumo-cosim, version {PROTOCOL}",
        **ANY.json_schema(),
    }


def schema_text() -> str:
    """Return what the published file contains."""
    return json.dumps(schema(), indent=1) + "\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(schema_text(), "utf-8")
