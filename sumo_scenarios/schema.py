"""Keys that a ``scenario.toml`` may have; every other key is an error."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator
from pydantic_core import ErrorDetails

from sumo_scenarios.errors import ScenarioError, did_you_mean, most_telling
from sumo_scenarios.netconvert_options import check_options

SHORTEST_STEP_S = 0.05
LONGEST_STEP_S = 1.0

ParameterValue = bool | int | float | str
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Step = Annotated[float, Field(ge=SHORTEST_STEP_S, le=LONGEST_STEP_S, allow_inf_nan=False)]
Share = Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)]
AtLeastOne = Annotated[int, Field(ge=1)]
Actuation = Literal["hybrid", "move"]
OF_VARIANTS = frozenset(
    (
        *("base", "values", "description", "duration_s", "warmup_s", "step_s", "actuation"),
        *("lateral_resolution_m", "egos", "sensing", "pedestrians", "criteria", "types"),
    )
)
"""Keys of a scenario.toml with a base; the base gives the values of keys left out."""


class Table(BaseModel):
    """A TOML table whose keys are all known."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, use_attribute_docstrings=True)


class NetworkTable(Table):
    """Plain network sources, from which netconvert builds the network."""

    nodes: str
    """File of plain nodes, ``.nod.xml``."""
    edges: str
    """File of plain edges, ``.edg.xml``."""
    types: str = ""
    """File of edge types, ``.typ.xml``."""
    connections: list[str] = []
    """Files of connections and crossings, ``.con.xml``."""
    netconvert: list[str] = []
    """Further options of netconvert that say how the network is built; none that names a file."""

    @field_validator("netconvert")
    @classmethod
    def only_allowed(cls, words: list[str]) -> list[str]:
        """Check that netconvert is asked for nothing but how the network is built."""
        check_options(words)
        return words


class RateTable(Table):
    """A rate that demand files use by its name: a share of a parameter that is counted per hour."""

    of: str
    """Parameter that is counted per hour: ``vehicles_per_hour``, ``pedestrians_per_hour`` or one's own."""
    share: Positive
    """Share of it that this flow has."""


class DemandTable(Table):
    """Demand files, in which ``$name`` stands for a value (Python's ``string.Template``)."""

    routes: list[str]
    """Route files; ``$name`` in them, or in a file's name, stands for a rate, a time or a parameter;
    ``$warmup_s`` and ``$end_s`` are known too [s]."""
    additional: list[str] = []
    """Additional files, with vehicle types for instance."""
    vehicles_per_hour: NotNegative | None = None
    """Default of the parameter of that name [1/h]."""
    pedestrians_per_hour: NotNegative | None = None
    """Default of the parameter of that name [1/h]."""


class ParameterTable(Table):
    """One further parameter of this scenario; the type of its default is its type."""

    default: ParameterValue
    """Value without ``--set``; its type is the parameter's."""
    description: str
    """What it is, for readers."""
    choices: list[str] = []
    """Texts that are allowed; empty: any."""
    minimum: float | None = None
    """Smallest number that is allowed."""
    maximum: float | None = None
    """Largest number that is allowed."""


class RouteTable(Table):
    """One ego trip, offered where the parameters have the values of ``when``."""

    edges: str
    """Edges that the trip begins, passes and ends with, with blanks between them."""
    when: dict[str, ParameterValue] = {}
    """Values of parameters with which the trip is offered; empty: always."""


class EgosTable(Table):
    """Which vehicles are egos: trips of their own, vehicles of the demand, or a share of the cars."""

    routes: list[RouteTable] = []
    """Trips of egos that are added to the demand."""
    vehicles: list[str] = []
    """Vehicles of the demand that become egos, by their ids."""
    share: Share | None = None
    """Share of the passenger cars of the demand that become egos."""
    count: Annotated[int, Field(ge=0)] = 0
    """How many egos set out on the routes, in turn; 0: one, if there are routes."""
    first_depart_s: NotNegative = 0.0
    """When the first one does, after the warm-up [s]."""
    headway_s: Positive = 30.0
    """Time between two of them [s]."""
    vehicle_type: str = ""
    """Vehicle type of the egos; empty: a passenger car of 4.5 m."""
    depart_lane: str = "best"
    """SUMO's ``departLane``."""
    depart_speed: str = "desired"
    """SUMO's ``departSpeed``."""

    def check_conditions(self, parameters: Collection[str]) -> None:
        """Check that the trips depend on parameters that exist.

        Raises
        ------
        ValueError
            If they do not.
        """
        for key in (key for route in self.routes for key in route.when if key not in parameters):
            exist = ", ".join(sorted(parameters)) or "none"
            raise ValueError(f"egos.routes.when names {key!r}; parameters that exist: {exist}")


class ScenarioTable(Table):
    """The whole of ``scenario.toml``."""

    description: str
    """One line for ``cosim list scenarios``."""
    duration_s: Positive
    """Simulated time from the beginning, the warm-up included [s]."""
    warmup_s: NotNegative = 0.0
    """Time at the beginning that is not recorded; egos set out after it [s]."""
    step_s: Step | None = None
    """Length of a simulation step [s]; none given: as the configuration says, otherwise 0.1."""
    actuation: Actuation = "hybrid"
    """How the motion of the egos is passed to SUMO: ``hybrid`` or ``move``."""
    lateral_resolution_m: Positive | None = None
    """SUMO's lateral resolution [m]; none given: 0.4 with ``hybrid``, none with ``move``."""
    network: NetworkTable | None = None
    """A network of plain sources, which netconvert builds; it needs ``[demand]``."""
    demand: DemandTable | None = None
    """Demand on that network."""
    packaged_sumocfg: str = ""
    """A configuration that is shipped with SUMO, in the place of a network."""
    sumocfg: str = ""
    """A configuration of one's own, relative to the scenario's folder, in the place of a network."""
    base: str = ""
    """Scenario of which this one is a variant: its roads and demand, with other values."""
    values: dict[str, ParameterValue] = {}
    """Values of the base's parameters."""
    types: str = ""
    """File of vTypes, relative to the scenario's folder, in place of the configuration's of the same ids."""
    recorded_vehicles: str = ""
    """Vehicles that SUMO moves as they were recorded, relative to the scenario's folder; time 0 is the end of
    the warm-up."""
    rates: dict[str, RateTable] = {}
    """Rates that the demand files use as ``$name``, in 1/s."""
    times: dict[str, float] = {}
    """Times that the demand files use as ``$name``, counted from the end of the warm-up [s]."""
    parameters: dict[str, ParameterTable] = {}
    """Further parameters of the scenario, for ``--set`` and ``[vary]``."""
    egos: EgosTable = EgosTable()
    """Which vehicles the controller drives."""
    sensing: dict[str, ParameterValue] = {}
    """How egos come to know of pedestrians: ``model`` and its parameters."""
    pedestrians: list[dict[str, Any]] = []
    """Scripted pedestrians."""
    criteria: list[dict[str, Any]] = []
    """What ``cosim check`` holds runs against."""
    search: dict[str, Any] = {}
    """What a search for failures may vary; not in a variant, which is not searched."""

    @model_validator(mode="after")
    def one_source(self) -> ScenarioTable:
        """Check that there is exactly one network, and a demand with a network of our own."""
        if self.base:
            foreign = sorted(self.model_fields_set - OF_VARIANTS)
            if foreign:
                raise ValueError(
                    f"{foreign[0]!r} does not go with 'base'; keys that do: {', '.join(sorted(OF_VARIANTS))}"
                )
            return self
        if self.values:
            raise ValueError("'values' belongs to 'base'")
        if sum((self.network is not None, bool(self.packaged_sumocfg), bool(self.sumocfg))) != 1:
            raise ValueError("expected exactly one of [network], sumocfg, packaged_sumocfg, base")
        if self.types and self.network is not None:
            raise ValueError("'types' belongs to a configuration; with [network] they are in [demand]")
        if (self.network is None) != (self.demand is None):
            raise ValueError("[demand] belongs to [network]: expected both or none")
        counted = {"vehicles_per_hour", "pedestrians_per_hour", *self.parameters}
        for name, rate in self.rates.items():
            if rate.of not in counted:
                raise ValueError(f"rates.{name}.of is {rate.of!r}; there are: {', '.join(sorted(counted))}")
        self.egos.check_conditions(self.parameters)
        return self


def read_table(path: Path) -> ScenarioTable:
    """Return the checked content of a ``scenario.toml``.

    Raises
    ------
    ScenarioError
        If the file is wrong; the message is one line with file, key and what exists.
    """
    try:
        raw = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ScenarioError(f"{path}: not valid TOML: {error}") from error
    try:
        return ScenarioTable.model_validate(raw)
    except ValidationError as error:
        raise ScenarioError(f"{path}: {_first_line(error)}") from error


def _first_line(error: ValidationError) -> str:
    details = most_telling(error)
    key = ".".join(str(part) for part in details["loc"])
    if details["type"] == "extra_forbidden":
        exist = _keys_beside(details["loc"])
        hint = did_you_mean(str(details["loc"][-1]), exist)
        return f"unknown key '{key}'; {hint}keys that exist here: {', '.join(exist)}"
    if details["type"] == "missing":
        return f"key '{key}' is missing"
    if details["type"] == "value_error":
        return str(details["msg"]).removeprefix("Value error, ")
    return f"key '{key}': {_lower(details)}, got {details['input']!r}"


def _lower(details: ErrorDetails) -> str:
    message = str(details["msg"])
    return message[:1].lower() + message[1:]


def _keys_beside(location: tuple[int | str, ...]) -> list[str]:
    """Return the known keys of the table in which an unknown key was found."""
    table: type[BaseModel] = ScenarioTable
    for part in location[:-1]:
        if isinstance(part, str) and part in table.model_fields:
            table = _table_in(table.model_fields[part].annotation) or table
    return list(table.model_fields)


def _table_in(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for inner in get_args(annotation):
        found = _table_in(inner)
        if found is not None:
            return found
    return None


def defaults(table: ScenarioTable) -> Mapping[str, ParameterValue]:
    """Return the default of each further parameter."""
    return {name: parameter.default for name, parameter in table.parameters.items()}
