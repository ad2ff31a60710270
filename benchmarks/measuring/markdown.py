"""Tables as Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return rows with equal keys as a Markdown table.

    >>> print(table([{"solver": "osqp", "ms": 1}]))
    | solver | ms |
    | --- | --- |
    | osqp | 1 |
    """
    heads = list(rows[0])
    lines = [heads, ["---"] * len(heads), *([str(row[head]) for head in heads] for row in rows)]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)
