"""``cosim schema``: what an editor needs to complete and check scenario, study and criteria files."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer


class Kind(StrEnum):
    """Kinds of files."""

    SCENARIO = "scenario"
    STUDY = "study"
    CRITERIA = "criteria"


def schema(
    kind: Annotated[Kind, typer.Argument(metavar="scenario|study|criteria", help="Kind of file.")],
) -> int:
    """Print the JSON schema of a scenario.toml, a study file or a criteria file.

    \b
    Examples:
      cosim schema scenario > scenario.schema.json
    Then the first line of a scenario.toml in that folder may be:
      #:schema ./scenario.schema.json
    """
    from cosim.checks.schemas import text

    typer.echo(text(kind.value), nl=False)
    return 0
