"""Maps variables of a functional mock-up unit to numbers of a perception, as a TOML file says."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from controllers.outside.view import View

VIEW = View()
Number = Annotated[float, Field(allow_inf_nan=False)]
EXAMPLE = '[inputs] gap = "ahead_gap_m"  [outputs] acceleration_mps2 = "a_des"'


class Source(BaseModel):
    """A number of the perception, converted to the unit of measurement that the variable needs."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    number: str
    """Its name in :class:`controllers.outside.view.View`."""
    scale: Number = 1.0
    """Factor on the value, for example 3.6 for km/h."""


class Outputs(BaseModel):
    """Variables of the unit that drive the ego."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    acceleration_mps2: str
    steering_rad: str | None = None
    """If it is absent, the ego keeps its lane."""


class Mapping(BaseModel):
    """The content of a mapping file."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    inputs: dict[str, str | Source]
    outputs: Outputs
    parameters: dict[str, Number] = {}

    def sources(self) -> dict[str, Source]:
        """Return the source of each input, by the name of the unit's variable."""
        return {
            name: one if isinstance(one, Source) else Source(number=one) for name, one in self.inputs.items()
        }


def read_mapping(path: Path, inputs: Iterable[str], outputs: Iterable[str], others: Iterable[str]) -> Mapping:
    """Return the checked content of a mapping file.

    Parameters
    ----------
    path
    inputs, outputs, others
        The variables that the unit has; ``others`` may be set as parameters.

    Raises
    ------
    ValueError
        If the file cannot be used; the message says in one line what is wrong and what exists.
    """
    try:
        mapping = Mapping.model_validate(tomllib.loads(path.read_text("utf-8")))
    except OSError as error:
        raise ValueError(
            f"{path}: cannot be read ({error.strerror}); expected for instance {EXAMPLE}"
        ) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: not valid TOML: {error}") from error
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(str(part) for part in first["loc"])
        raise ValueError(f"{path}: {place}: {first['msg'][:1].lower()}{first['msg'][1:]}") from error
    numbers = [one.name for one in VIEW.entries]
    for variable, source in mapping.sources().items():
        _known(path, "inputs", variable, list(inputs), "the unit has the inputs")
        _known(path, f"inputs.{variable}", source.number, numbers, "there are")
    for output in (mapping.outputs.acceleration_mps2, mapping.outputs.steering_rad):
        if output is not None:
            _known(path, "outputs", output, list(outputs), "the unit has the outputs")
    for variable in mapping.parameters:
        _known(path, "parameters", variable, list(others), "the unit has the parameters")
    return mapping


def _known(path: Path, where: str, name: str, names: list[str], there: str) -> None:
    if name not in names:
        near = difflib.get_close_matches(name, names, 1)
        hint = f"did you mean {near[0]!r}? " if near else ""
        raise ValueError(f"{path}: {where}: no {name!r}; {hint}{there} {', '.join(names) or 'none'}")
