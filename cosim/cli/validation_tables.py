"""What ``cosim validate`` and ``cosim calibrate`` print."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table

    from analysis.validation.estimate import Estimate
    from analysis.validation.table import Compared


def comparison_table(compared: Sequence[Compared]) -> Table:
    """Return the table of quantities with their verdicts in words."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    for number, head in enumerate(("quantity", "unit", "real", "simulated", "n", "verdict")):
        table.add_column(head, justify="right" if 2 <= number <= 4 else "left", overflow="fold")
    for one in compared:
        table.add_row(
            one.quantity.name,
            one.quantity.unit,
            _number(one.found.real),
            _number(one.found.simulated),
            f"{one.found.n_real}, {one.found.n_simulated}",
            one.sentence,
        )
    return table


def _number(value: float) -> str:
    return "–" if value != value else f"{value:.2f}"


def estimates_table(estimates: Iterable[Estimate]) -> Table:
    """Return the table of estimated parameters."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    for number, head in enumerate(("parameter", "unit", "value", "95 %", "n", "method")):
        table.add_column(head, justify="right" if 2 <= number <= 4 else "left", overflow="fold")
    for one in estimates:
        interval = f"{one.low:.2f} to {one.high:.2f}" if one.known else "–"
        table.add_row(one.name, one.unit, _number(one.value), interval, str(one.n), one.method)
    return table


def before_and_after(before: Sequence[Compared], after: Sequence[Compared]) -> Table:
    """Return the table of differences from the street on the held-out part."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    for number, head in enumerate(("quantity", "unit", "real", "before", "after", "verdict after")):
        table.add_column(head, justify="right" if 2 <= number <= 4 else "left", overflow="fold")
    for one, other in zip(before, after, strict=True):
        table.add_row(
            one.quantity.name,
            one.quantity.unit,
            _number(one.found.real),
            _number(one.found.simulated),
            _number(other.found.simulated),
            other.sentence,
        )
    return table
