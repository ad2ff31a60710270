"""``cosim schema``: what an editor needs to complete and check scenario, study and criteria files."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer


class Kind(StrEnum):
    """Kinds of files."""

    SCENARIO = "scenario"
    STUDY = "study"
    CRITERIA = "criteria"


def schema(
    kind: Annotated[Kind, typer.Argument(metavar="scenario|study|criteria", help="Kind of file.")],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Write it to this file.", show_default="the terminal"),
    ] = None,
) -> int:
    """Print the JSON schema of a scenario.toml, a study file or a criteria file.

    \b
    Examples:
      cosim schema scenario
      cosim schema study --out study.schema.json
      cosim schema scenario --out scenario.schema.json
    Then the first line of a scenario.toml in that folder may be:
      #:schema ./scenario.schema.json
    """
    from cosim.checks.schemas import text

    if out is None:
        typer.echo(text(kind.value), nl=False)
        return 0
    from analysis.files import write_text
    from cosim.errors import InputError

    try:
        write_text(out, text(kind.value))
    except OSError as error:
        raise InputError(f"--out {out}: {error.strerror}") from error
    return 0
