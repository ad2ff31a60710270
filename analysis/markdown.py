"""Tables of Markdown pages, and generated parts of pages."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from tabulate import DataRow, TableFormat, tabulate

from analysis.files import write_text


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], right: Iterable[str] = ()) -> str:
    """Return a Markdown table; its last line ends without a line break.

    Columns are not padded, so that a changed value changes one line and not the whole table.

    Parameters
    ----------
    heads
        Heads of the columns.
    rows
        A text for each column; vertical bars are escaped, and line breaks become spaces.
    right
        Heads of the columns that are aligned to the right.

    Examples
    --------
    >>> print(table(["solver", "ms"], [["a|b", "1"]], right=["ms"]))
    | solver | ms |
    | --- | --: |
    | a\\|b | 1 |
    """
    shown = set(right)
    rule = "| " + " | ".join("--:" if head in shown else "---" for head in heads) + " |"
    row = DataRow("|", "|", "|")
    layout = TableFormat(
        lineabove=None,
        linebelowheader=lambda widths, alignments: rule,
        linebetweenrows=None,
        linebelow=None,
        headerrow=row,
        datarow=row,
        padding=1,
        with_header_hide=None,
    )
    return tabulate(
        [_escaped(cells) for cells in rows],
        _escaped(heads),
        tablefmt=layout,
        disable_numparse=True,
        numalign=None,
        stralign=None,
    )


def table_of(rows: Sequence[Mapping[str, object]]) -> str:
    """Return the table of rows that have the same keys, which become its heads.

    Examples
    --------
    >>> print(table_of([{"solver": "osqp", "ms": 1}]))
    | solver | ms |
    | --- | --- |
    | osqp | 1 |
    """
    return table(list(rows[0]), [list(map(str, row.values())) for row in rows])


def write_below(page: Path, line: str, text: str, introduction: str) -> None:
    """Replace the text below a line of a page.

    Parameters
    ----------
    page
        The page, which need not exist.
    line
        The line; the text above it is kept.
    text
        Text below the line.
    introduction
        Text above the line of a new page.
    """
    above = page.read_text(encoding="utf-8").partition(line)[0] if page.exists() else introduction
    write_text(page, f"{above.rstrip()}\n\n{line}\n\n{text}")


def _escaped(cells: Sequence[str]) -> list[str]:
    return [cell.replace("|", "\\|").replace("\n", " ") for cell in cells]
