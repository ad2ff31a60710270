"""Keys that a suite's parameter table may have; every other key is an error."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from sumo_scenarios.errors import ScenarioError, did_you_mean

FOLDER = Path(__file__).parent
DEFINITION = "suite.toml"

Rule = Literal[
    "no_contact", "impact_speed", "green", "not_red", "no_worse", "no_false_stop", "no_false_braking"
]
Motion = Literal["crossing", "stopping", "along", "standing", "turning"]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class Table(BaseModel):
    """A TOML table without unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class GroupTable(Table):
    """Cases that differ only in the ego's speed."""

    name: str
    description: str
    speeds_kmh: Annotated[list[Positive], Field(min_length=1)]
    rule: Rule
    motion: Motion = "crossing"
    """The pedestrian walks across the ego's path (``crossing``), stops short of it (``stopping``), walks
    ``along`` it or stands on it (``standing``); or the ego turns and the pedestrian crosses the road that it
    turns into (``turning``)."""
    comes_from: Literal["right", "left"] = "right"
    overlap: Annotated[float, Field(ge=0, le=1)] | None = None
    """Point of impact if the ego keeps its speed, as a share of its width from the pedestrian's side."""
    beside_m: NotNegative | None = None
    """Alternative to ``overlap``: distance from the ego's side to where the pedestrian walks or stops [m]."""
    pedestrian_speed_kmh: NotNegative = 0.0
    start_distance_m: Positive | None = None
    """Distance of the pedestrian's start from the middle of the ego's path [m]."""
    acceleration_distance_m: NotNegative = 0.0
    turns: Literal["left", "right", ""] = ""
    """Side to which the ego turns by a quarter of a circle, for motion ``turning``."""
    turn_radius_m: Positive | None = None
    """Radius of the turn; there is a road for each of the protocol's radii [m]."""
    obstructed: bool = False
    """Whether two parked cars hide the pedestrian."""
    highest_impact_kmh: list[NotNegative] = []
    """For rule ``impact_speed``: highest allowed impact speed at each test speed [km/h]."""
    standard: str = ""
    """For rule ``no_worse``: group whose colours the cases have to match at least."""
    share: Literal["standard", "extended", "robustness", ""] = ""
    """Part of a rating that the group belongs to."""

    @model_validator(mode="after")
    def fitting(self) -> GroupTable:
        """Check that the motion has the keys it needs, and that there is one limit for each speed."""
        if (self.overlap is None) == (self.beside_m is None):
            raise ValueError(f"group '{self.name}': expected exactly one of overlap, beside_m")
        if (self.motion == "stopping") != (self.beside_m is not None) and self.motion != "along":
            raise ValueError(
                f"group '{self.name}': motion '{self.motion}' goes with the other of overlap, beside_m"
            )
        if self.motion in ("crossing", "stopping", "turning") and self.start_distance_m is None:
            raise ValueError(f"group '{self.name}': key 'start_distance_m' is missing")
        if (self.motion == "standing") != (self.pedestrian_speed_kmh == 0.0):
            raise ValueError(
                f"group '{self.name}': expected pedestrian_speed_kmh, unless the pedestrian stands"
            )
        if (self.motion == "turning") != bool(self.turns and self.turn_radius_m):
            raise ValueError(f"group '{self.name}': turns and turn_radius_m belong to motion 'turning'")
        if (self.rule == "impact_speed") != bool(self.highest_impact_kmh):
            raise ValueError(f"group '{self.name}': 'highest_impact_kmh' belongs to rule 'impact_speed'")
        if self.highest_impact_kmh and len(self.highest_impact_kmh) != len(self.speeds_kmh):
            raise ValueError(f"group '{self.name}': expected as many highest_impact_kmh as speeds_kmh")
        if (self.rule == "no_worse") != bool(self.standard):
            raise ValueError(f"group '{self.name}': 'standard' belongs to rule 'no_worse'")
        return self


class SuiteTable(Table):
    """The whole of a ``suite.toml``."""

    title: str
    label: str
    """Label of the suite's results."""
    source: str
    """Key of the source in docs/references.md."""
    points: dict[str, dict[str, NotNegative]] = {}
    """For a rating: highest points of each share, by the prefix of the groups' names."""
    groups: Annotated[list[GroupTable], Field(min_length=1)]

    @model_validator(mode="after")
    def named_once(self) -> SuiteTable:
        """Check that names of groups are unique and that standards exist."""
        names = [group.name for group in self.groups]
        for group in self.groups:
            if names.count(group.name) > 1:
                raise ValueError(f"two groups are named '{group.name}'")
            if group.standard and group.standard not in names:
                raise ValueError(
                    f"group '{group.name}': standard '{group.standard}' is no group of this suite"
                )
        return self


def names() -> tuple[str, ...]:
    """Return the names of the suites: every folder here that holds a suite.toml."""
    return tuple(sorted(path.parent.name for path in FOLDER.glob(f"*/{DEFINITION}")))


@cache
def read_suite(name: str) -> SuiteTable:
    """Return the checked table of a suite.

    Raises
    ------
    ScenarioError
        If there is no such suite, or its table is wrong.
    """
    if name not in names():
        hint = did_you_mean(name, names())
        raise ScenarioError(f"suite:{name}: no such suite; {hint}there are: {', '.join(names())}")
    path = FOLDER / name / DEFINITION
    try:
        return SuiteTable.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise ScenarioError(f"{path}: {error}") from error
    except ValidationError as error:
        details = error.errors(include_url=False)[0]
        key = ".".join(str(part) for part in details["loc"])
        raise ScenarioError(f"{path}: {key}: {str(details['msg']).removeprefix('Value error, ')}") from error
