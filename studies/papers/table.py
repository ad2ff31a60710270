"""The table of claims, as CSV and for the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, fields
from pathlib import Path

from rich import box
from rich.table import Table

from analysis.files import read_csv_rows, write_csv
from cosim.errors import InputError
from studies.papers.claim import Claim, Status

COLUMNS = tuple(field.name for field in fields(Claim))


def write_claims(path: Path, claims: Sequence[Claim]) -> None:
    """Write the claims as CSV; the file appears complete or not at all."""
    write_csv(path, COLUMNS, [astuple(claim) for claim in claims])


def read_claims(path: Path) -> list[Claim]:
    """Return the claims of a file that :func:`write_claims` has written.

    Raises
    ------
    InputError
        If the file cannot be read, or is not a table of claims.
    """
    try:
        header, *rows = read_csv_rows(path)
        if tuple(header) == COLUMNS:
            return [_claim(row) for row in rows]
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: a table of claims expected: {error}") from error
    raise InputError(f"{path}: a table of claims has the columns {', '.join(COLUMNS)}")


def counts(claims: Sequence[Claim], titles: dict[str, str]) -> Table:
    """Return the number of claims with each status, by paper."""
    table = Table(box=box.MARKDOWN, title_justify="left")
    table.add_column("paper", no_wrap=True)
    table.add_column("")
    for status in Status:
        table.add_column(status.value, justify="right")
    for paper in dict.fromkeys(claim.paper for claim in claims):
        mine = [claim.status for claim in claims if claim.paper == paper]
        table.add_row(paper, titles.get(paper, ""), *(str(mine.count(status)) for status in Status))
    return table


def not_reproduced(claims: Sequence[Claim]) -> Table:
    """Return the papers' claims that were not reproduced, each with the reason below it."""
    table = Table(box=None, show_header=False, title="Not reproduced", title_justify="left", title_style="")
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    for claim in claims:
        if claim.status is Status.NOT_REPRODUCED:
            theirs, ours = (_with_unit(value, claim.unit) for value in (claim.paper_value, claim.our_value))
            values = [f"paper: {theirs}"] * bool(theirs) + [f"ours: {ours}"] * bool(ours)
            table.add_row(claim.paper, " ".join([f"{claim.experiment}: {claim.claim}", *values]))
            if claim.why:
                table.add_row("", claim.why, style="dim")
    return table


def _with_unit(value: str, unit: str) -> str:
    return f"{value} {unit}".strip() if value else ""


def _claim(row: Sequence[str]) -> Claim:
    paper, experiment, claim, theirs, ours, unit, tolerance, status, why = row
    return Claim(paper, experiment, claim, theirs, ours, unit, tolerance, Status(status), why)
