"""What ``cosim screen`` prints: the ranking, and what an alternative changes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from analysis.wording import p_value, some
from cosim.cli import terminal

if TYPE_CHECKING:
    from rich.table import Table

    from analysis.screening.writing import Changed, Screened
    from analysis.tables.cells import Row

SHOWN = 10
"""Crossings that are printed."""


def show_ranking(found: Screened, least: float) -> None:
    """Print the worst crossings.

    Parameters
    ----------
    found : the ranking
    least : pedestrians below which a crossing is not ranked
    """
    from analysis.screening.caution import caution
    from analysis.screening.crossings_table import VALUES, value_column
    from analysis.screening.ranking import BY_RISK

    rows = [row for row in found.rows if row["rank"] is not None]
    by_risk = value_column(found.rows) == VALUES[BY_RISK]
    table = _table(
        *("rank by risk" if by_risk else "rank", "95 %", "crossing"),
        *(
            "conflicts per 1000 pedestrians",
            "expected",
            "fatal if struck",
            "rank by conflicts" if by_risk else "rank by risk",
            "why",
        ),
    )
    for row in rows[:SHOWN]:
        table.add_row(*_line(row, "rank_by_conflicts" if by_risk else "rank_by_risk"))
    console = terminal.console()
    if rows:
        console.print(table)
    worse, left_out = sum(bool(row["worse"]) for row in rows), len(found.rows) - len(rows)
    typer.echo(
        f"{len(found.rows)} crossings, {len(rows)} ranked over {len(found.seeds)} seeds, "
        f"{worse} significantly worse than the others; {left_out} with fewer than {least:g} pedestrians"
    )
    if told := caution(found.rows):
        typer.echo(f"cosim: note: {told}", err=True)
    if not any(row["pedestrians_per_h"] for row in found.rows):
        typer.echo("cosim: note: nobody walked over a crossing; does the demand have persons?", err=True)
    if len(found.seeds) == 1:
        typer.echo("cosim: note: a rank has no interval with a single seed: use --seeds 1-10", err=True)
    if not any(file.suffix == ".geojson" for file in found.files):
        typer.echo("cosim: note: the network has no projection: places are in metres, no GeoJSON", err=True)
    typer.echo(f"files: {', '.join(map(str, found.files))}")


def _line(row: Row, other: str) -> list[str]:
    known = row["rank_lo"] is not None
    interval = f"{row['rank_lo']:.0f}–{row['rank_hi']:.0f}" if known else ""
    rates = [f"{row[name]:.1f}" for name in ("conflicts_per_1000_ped", "expected_conflicts_per_1000_ped")]
    name = f"{row['crossing_id']} (worse)" if row["worse"] else str(row["crossing_id"])
    fatal = "" if row["p_fatal_expected"] is None else f"{row['p_fatal_expected']:.1%}"
    return [f"{row['rank']:g}", interval, name, *rates, fatal, f"{row[other]:g}", str(row["reasons"])]


def show_changes(found: Changed) -> None:
    """Print what an alternative changes: in total, and at the crossings where a change is shown."""
    from analysis.screening.changes import EXPOSURE, TOTAL

    total = [row for row in found.rows if row["crossing_id"] == TOTAL]
    changed = [row for row in found.rows if row["changed"] and row["crossing_id"] != TOTAL]
    table = _table("all crossings", "unit", "base", "alternative", "difference (95 %)", "p")
    for row in total:
        table.add_row(str(row["metric"]), str(row["unit"]), *_difference(row), p_value(row["p_value"], ""))
    console = terminal.console()
    console.print(table)
    if changed:
        table = _table("crossing", "metric", "base", "alternative", "difference (95 %)", "p (adjusted)")
        for row in sorted(changed, key=lambda row: row["p_fdr"])[:SHOWN]:
            p = p_value(row["p_fdr"], "")
            table.add_row(str(row["crossing_id"]), str(row["metric"]), *_difference(row), p)
        console.print(table)
    crossings = {row["crossing_id"]: row["status"] for row in found.rows if row["crossing_id"] != TOTAL}
    places = {row["crossing_id"] for row in changed}
    typer.echo(
        f"{len(places)} of {len(crossings)} crossings changed in something, "
        f"over {total[0]['n_pairs']} seeds that both have"
    )
    for status, which in (("only_in_base", "the base"), ("only_in_alt", "the alternative")):
        alone = sorted(name for name, known in crossings.items() if known == status)
        if alone:
            typer.echo(f"cosim: note: only in {which}: {some(alone, SHOWN)}", err=True)
    moved = {row["crossing_id"] for row in changed if row["metric"] in EXPOSURE}
    if moved or any(row["changed"] for row in total if row["metric"] in EXPOSURE):
        typer.echo(
            "cosim: note: the alternative moves trips (pedestrians_per_h, vehicles_per_h): "
            "conflicts an hour change with the exposure",
            err=True,
        )
    if total[0]["n_pairs"] == 1:
        typer.echo("cosim: note: a difference has no interval with a single seed: use --seeds 1-10", err=True)
    typer.echo(f"files: {', '.join(map(str, found.files))}")


def _table(*headings: str) -> Table:
    from rich.table import Table

    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in headings:
        table.add_column(heading, overflow="fold")
    return table


def _difference(row: Row) -> tuple[str, str, str]:
    base, alt, difference, low, high = (
        "" if row[name] is None else f"{row[name]:.4g}"
        for name in ("base_mean", "alt_mean", "diff_mean", "ci95_lo", "ci95_hi")
    )
    interval = f" ({low} to {high})" if low else ""
    return base, alt, f"{difference}{interval}"
