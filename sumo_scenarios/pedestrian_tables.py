"""The ``[[pedestrians]]`` tables of a ``scenario.toml``: where, when and how scripted pedestrians walk."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from sumo_scenarios.distribution import Distribution, read_distribution
from sumo_scenarios.errors import ScenarioError, did_you_mean, most_telling
from sumo_scenarios.trajectories import FASTEST_MPS, read_trajectories

KINDS = ("trajectory", "line", "jaywalk", "crossing")
SLOWEST_MPS = 0.05
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_.-]*")


def _within(low: float, high: float) -> BeforeValidator:
    return BeforeValidator(lambda value: read_distribution(value, low, high))


Speed = Annotated[Distribution, _within(SLOWEST_MPS, FASTEST_MPS)]
Length = Annotated[Distribution, _within(0.0, 1e4)]
Duration = Annotated[Distribution, _within(0.0, 1e5)]
Offset = Annotated[Distribution, _within(-1e4, 1e4)]
Share = Annotated[Distribution, _within(0.0, 1.0)]
Size = Annotated[Distribution, _within(1.0, 50.0)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Place = Annotated[list[Finite], Field(min_length=2, max_length=2)]


class Table(BaseModel):
    """A TOML table without unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class MannerTable(Table):
    """How a pedestrian walks after setting off."""

    kind: Literal["steady", "hesitating", "running", "turning_back", "social_force"] = "steady"
    weight: NotNegative = 1.0
    """Relative frequency among the manners of the table."""
    after_m: Length | None = None
    """Distance along the path at which the pedestrian pauses, runs or turns back [m]."""
    pause_s: Duration | None = None
    """Duration of the pause [s]."""
    speed_mps: Speed | None = None
    """Speed of running or of walking back [m/s]."""
    ego_within_s: Duration | None = None
    """Runs or turns as soon as an ego would reach the line within this time, if before ``after_m`` [s]."""

    @model_validator(mode="after")
    def fitting(self) -> MannerTable:
        """Check that the manner has the keys it needs and no others."""
        needs = {"hesitating": ("after_m", "pause_s"), "running": ("speed_mps",)}.get(self.kind, ())
        knows = {
            "hesitating": ("after_m", "pause_s"),
            "running": ("after_m", "speed_mps", "ego_within_s"),
            "turning_back": ("after_m", "pause_s", "speed_mps", "ego_within_s"),
        }.get(self.kind, ())
        for key in ("after_m", "pause_s", "speed_mps", "ego_within_s"):
            given = getattr(self, key) is not None
            if given and key not in knows:
                raise ValueError(f"manner '{self.kind}' has no key '{key}'")
            if not given and key in needs:
                raise ValueError(f"manner '{self.kind}' needs the key '{key}'")
        if self.kind in ("running", "turning_back") and self.after_m is None and self.ego_within_s is None:
            raise ValueError(f"manner '{self.kind}' needs 'after_m' or 'ego_within_s', or both")
        return self


STARTS = ("time_s", "per_hour", "ego_distance_m", "ego_arrival_s", "overlap")


class StartTable(Table):
    """When a pedestrian sets off: exactly one of the first five keys, and further conditions."""

    time_s: NotNegative | None = None
    """Time after the warm-up [s]."""
    per_hour: NotNegative | None = None
    """Rate of pedestrians who set off at random times (Poisson) [1/h]."""
    ego_distance_m: Length | None = None
    """Sets off when the ego's front bumper is this far from where its path crosses the line [m]."""
    ego_arrival_s: Duration | None = None
    """Sets off when the ego would reach that place in this time [s]."""
    overlap: Share | None = None
    """Sets off such that the bumper meets the pedestrian at this share of its width, from their side."""
    ego_speed_mps: Positive | None = None
    """Nominal speed of the ego for ``overlap``; by default its current speed [m/s]."""
    accepted_gap_s: Duration | None = None
    """Waits until every vehicle arrives at least this long after the pedestrian is in front of it [s]."""
    watchful: Share = Distribution("choice", (1.0,))
    """Share of the pedestrians waiting for a gap who look again before each lane; the others walk on."""
    signal: Literal["", "red", "green"] = ""
    """Sets off only while the crossing's signal shows this."""

    @model_validator(mode="after")
    def one(self) -> StartTable:
        """Check that there is exactly one start."""
        given = [key for key in STARTS if getattr(self, key) is not None]
        if len(given) != 1:
            raise ValueError(f"start: expected exactly one of {', '.join(STARTS)}, got {len(given)}")
        if self.ego_speed_mps is not None and self.overlap is None:
            raise ValueError("start: 'ego_speed_mps' belongs to 'overlap'")
        if self.by_ego and (self.accepted_gap_s is not None or self.signal):
            raise ValueError(f"start: 'accepted_gap_s' and 'signal' do not go with '{given[0]}'")
        return self

    @property
    def by_ego(self) -> bool:
        """Whether an ego triggers the start; then there is one pedestrian per ego."""
        return self.time_s is None and self.per_hour is None


class GroupTable(Table):
    """Several pedestrians who walk side by side."""

    size: Size
    spacing_m: Positive = 0.8


class PedestrianTable(Table):
    """Keys that all kinds of pedestrians share."""

    name: str
    kind: str


class TrajectoryTable(PedestrianTable):
    """Recorded trajectories, replayed."""

    kind: Literal["trajectory"]
    file: str
    start_s: NotNegative = 0.0
    """Time after the warm-up that corresponds to time 0 of the file [s]."""


class WalkerTable(PedestrianTable):
    """A pedestrian who walks along a straight line."""

    speed_mps: Speed
    start: StartTable
    acceleration_distance_m: NotNegative = 0.0
    """Distance over which the pedestrian accelerates to the speed [m]."""
    stop_after_m: Length | None = None
    """Walks this far and stops [m]."""
    stay_s: Duration = Distribution("choice", (0.0,))
    """Time that the pedestrian stands at the end of the path before disappearing [s]."""
    manners: list[MannerTable] = [MannerTable()]
    group: GroupTable | None = None

    @model_validator(mode="after")
    def weighted(self) -> WalkerTable:
        """Check that a manner can be drawn, and that the keys go together."""
        if not self.manners or sum(manner.weight for manner in self.manners) <= 0.0:
            raise ValueError("manners: expected at least one of weight above 0")
        if self.start.signal and self.kind != "crossing":
            raise ValueError("start: 'signal' belongs to kind 'crossing'")
        if any(manner.kind == "social_force" for manner in self.manners) and self.stop_after_m is not None:
            raise ValueError("manner 'social_force' does not go with 'stop_after_m'")
        return self


class LineTable(WalkerTable):
    """A straight line between two places, in world coordinates or along and across a lane."""

    kind: Literal["line"]
    lane: str = ""
    """SUMO lane from whose beginning and centre line the places are measured; empty for world coordinates."""
    from_m: Place
    to_m: Place
    shift_m: Place = [0.0, 0.0]
    """Shift added to both places [m]."""

    @model_validator(mode="after")
    def apart(self) -> LineTable:
        """Check that the line has a direction."""
        if self.from_m == self.to_m:
            raise ValueError("from_m and to_m are the same place")
        return self


class JaywalkTable(WalkerTable):
    """A walk across the road away from crossings, in a direction drawn from the direction model."""

    kind: Literal["jaywalk"]
    edge: str
    opposite: str = ""
    """Edge of the other direction; empty on a one-way road."""
    section_m: Place
    """Range of starting positions along the edge [m]."""
    side: Literal["right", "left", "both"] = "both"
    setback_m: NotNegative = 0.5
    """Distance from the outermost lane for cars to the start [m]."""
    goal_along_m: Offset = Distribution("choice", (0.0,))
    """Offset of the goal along the road, in the direction of the edge [m]."""
    goal_beyond_m: NotNegative = 1.0
    """Distance of the goal beyond the road [m]."""
    choice_scale: Positive = 0.05
    """A smaller value makes the choice of direction more certain."""

    @model_validator(mode="after")
    def ordered(self) -> JaywalkTable:
        """Check that the section is valid."""
        if not 0.0 <= self.section_m[0] <= self.section_m[1]:
            raise ValueError(f"section_m is {self.section_m}; expected two positions in order, from 0 on")
        return self


class CrossingTable(WalkerTable):
    """A walk over a crossing of the network, regardless of its signal unless ``start.signal`` is set."""

    kind: Literal["crossing"]
    crossing: str
    side: Literal["first", "last", "both"] = "both"
    """End of the crossing where the pedestrian starts, in SUMO's order."""
    setback_m: NotNegative = 0.5
    """Distance of the start from the crossing [m]."""


TABLES: Mapping[str, type[PedestrianTable]] = {
    "trajectory": TrajectoryTable,
    "line": LineTable,
    "jaywalk": JaywalkTable,
    "crossing": CrossingTable,
}


def read_pedestrians(
    rows: Sequence[Mapping[str, Any]], values: Mapping[str, Any], path: Path
) -> tuple[PedestrianTable, ...]:
    """Return the checked tables, with ``"$name"`` replaced by the value of that parameter.

    Parameters
    ----------
    rows : rows of ``[[pedestrians]]``
    values : values of the scenario's parameters
    path : the definition, for messages; files are relative to its folder

    Raises
    ------
    ScenarioError
        If a row is wrong; the message is one line with file, row and key.
    """
    tables: list[PedestrianTable] = []
    for number, row in enumerate(rows, start=1):
        place = f"{path}: [[pedestrians]] row {number}"
        table = _read_row(_filled(row, values, place), place)
        if any(table.name == other.name for other in tables):
            raise ScenarioError(
                f"{place}: there is a row named '{table.name}' already; expected another name"
            )
        if isinstance(table, TrajectoryTable):
            table = table.model_copy(update={"file": str(path.parent / table.file)})
            read_trajectories(Path(table.file))
        tables.append(table)
    return tuple(tables)


def _filled(value: Any, values: Mapping[str, Any], place: str) -> Any:
    if isinstance(value, str) and value.startswith("$"):
        if value[1:] not in values:
            exist = ", ".join(sorted(values)) or "none"
            raise ScenarioError(f"{place}: names {value}; parameters that exist: {exist}")
        return values[value[1:]]
    if isinstance(value, Mapping):
        return {key: _filled(inner, values, place) for key, inner in value.items()}
    if isinstance(value, list):
        return [_filled(inner, values, place) for inner in value]
    return value


def _read_row(row: Mapping[str, Any], place: str) -> PedestrianTable:
    kind = row.get("kind")
    if not isinstance(kind, str) or kind not in TABLES:
        raise ScenarioError(f"{place}: kind is {kind!r}; expected one of {', '.join(TABLES)}")
    try:
        table = TABLES[kind].model_validate(row)
    except ValidationError as error:
        raise ScenarioError(f"{place}: {_first_line(error, TABLES[kind])}") from error
    if not _NAME.fullmatch(table.name):
        raise ScenarioError(
            f"{place}: name is '{table.name}'; expected letters, digits, '_', '.', '-', a letter first"
        )
    return table


def _first_line(error: ValidationError, table: type[BaseModel]) -> str:
    details = most_telling(error)
    key = ".".join(str(part) for part in details["loc"])
    message = str(details["msg"]).removeprefix("Value error, ")
    if details["type"] == "extra_forbidden":
        hint = did_you_mean(key, table.model_fields)
        return f"unknown key '{key}'; {hint}keys of this kind: {', '.join(table.model_fields)}"
    if details["type"] == "missing":
        return f"key '{key}' is missing"
    if details["type"] == "value_error":
        return f"key '{key}': {message}" if key else message
    return f"key '{key}': {message[:1].lower()}{message[1:]}, got {details['input']!r}"
