"""Settings as models: a parameter's name, type, default, unit, bounds and meaning are defined in one place.

The annotation of a field gives its type and bounds, the end of its name the unit, the text below it the
meaning. :mod:`controllers.parameters` reads them to list parameters and to explain invalid values.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, get_type_hints

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    ValidationInfo,
    create_model,
    field_validator,
)
from pydantic_core import CoreSchema, PydanticKnownError, core_schema

from controllers.annotations import alternatives

NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
PositiveOrInfinite = Annotated[float, Field(gt=0.0)]
AtLeastOne = Annotated[int, Field(ge=1)]

SEED = "seed"
"""Name of the seed of all random numbers. The seed follows from the run's seed and the ego's name, so nobody
sets it by hand."""


@dataclass(frozen=True, slots=True)
class Unit:
    """The unit of a field whose name does not end in it."""

    text: str


@dataclass(frozen=True, slots=True)
class OneOf:
    """The texts that a field allows, looked up when a value is checked."""

    names: Callable[[], tuple[str, ...]]

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Add the check to pydantic's own check of the type."""
        return core_schema.no_info_after_validator_function(self._checked, handler(source))

    def _checked(self, text: str) -> str:
        if text not in self.names():
            raise PydanticKnownError("literal_error", {"expected": ", ".join(self.names())})
        return text


class SettingsModel(BaseModel):
    """Named values, with no others allowed; each is given as a value or as a text of ``--set``."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, use_attribute_docstrings=True, protected_namespaces=()
    )

    moved: ClassVar[Mapping[str, str]] = {}
    """Former parameters: for each, what to do instead."""

    @field_validator("*", mode="before")
    @classmethod
    def _plain(cls, value: object, info: ValidationInfo) -> object:
        """Convert the text ``none``; reject truth values as numbers, which pydantic would read as 0 and 1."""
        kinds = alternatives(cls.model_fields[str(info.field_name)].annotation)
        if isinstance(value, str):
            value = value.strip()
            return None if type(None) in kinds and value.lower() in ("", "none") else value
        if isinstance(value, bool) and bool not in kinds:
            if float in kinds:
                raise PydanticKnownError("float_type")
            if int in kinds:
                raise PydanticKnownError("int_type")
        return value

    @field_validator("*", mode="after")
    @classmethod
    def _a_number(cls, value: object) -> object:
        """Reject nan, which some bounds let through."""
        if isinstance(value, float) and math.isnan(value):
            raise PydanticKnownError("float_type")
        return value


class ControllerSettings(SettingsModel):
    """The settings of a controller; each controller has its own model, which its ``build`` takes."""

    seed: int = 1
    """Seed of all random numbers."""


class _FromSignature(ControllerSettings):
    """Base of the models made from a signature, which may have any types."""

    # Its fields have no texts below them, and looking for them would take as long as everything else.
    model_config = ConfigDict(arbitrary_types_allowed=True, use_attribute_docstrings=False)


def model_of(build: Callable[..., object]) -> type[ControllerSettings]:
    """Return the settings model that a ``build`` takes: its own model, or one made from its signature.

    Raises
    ------
    TypeError
        If a parameter has no default.

    Examples
    --------
    >>> def build(*, reach_m: float = 2.0) -> None: ...
    >>> model_of(build)(reach_m="3").reach_m
    3.0
    """
    return _taken_by(build) or _made_for(build)


def call(build: Callable[..., Any], settings: ControllerSettings) -> Any:
    """Return what ``build`` returns for the settings, whichever way it takes them."""
    if _taken_by(build) is not None:
        return build(settings)
    return build(**{key: getattr(settings, key) for key in inspect.signature(build).parameters})


def _taken_by(build: Callable[..., object]) -> type[ControllerSettings] | None:
    names = list(inspect.signature(build).parameters)
    hint = get_type_hints(build).get(names[0]) if len(names) == 1 else None
    return hint if isinstance(hint, type) and issubclass(hint, ControllerSettings) else None


def _made_for(build: Callable[..., object]) -> type[ControllerSettings]:
    hints = get_type_hints(build, include_extras=True)
    fields: dict[str, Any] = {}
    for key, one in inspect.signature(build).parameters.items():
        if one.default is inspect.Parameter.empty:
            raise TypeError(f"parameter '{key}' of build has no default")
        if key != SEED:
            fields[key] = (hints.get(key, type(one.default)), one.default)
    return create_model("Settings", __base__=_FromSignature, **fields)
