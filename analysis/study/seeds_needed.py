"""How many seeds a comparison that shows no difference needs, which tells the user what to do next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from analysis.statistics.paired import FEWEST_FOR_RANKS

Row = Mapping[str, Any]

NOT_SHOWN = "no_difference_shown"
FEWEST_TO_TELL = FEWEST_FOR_RANKS
"""With fewer seeds, not even a difference in the same direction on every seed is significant."""
MEANING = (
    '"Needed" is how many seeds would tell the difference to ±10 % of the base\'s mean if it goes on '
    'varying as it did here ("–": it did not vary, the base\'s mean is 0, or the number is out of reach; '
    '"enough": it is told to that already).'
)


def seeds_needed(row: Row) -> str:
    """Return how many seeds a measure that shows no difference needs; empty if it shows one.

    Parameters
    ----------
    row
        Row of comparisons.csv, with types.

    Examples
    --------
    >>> seeds_needed({"verdict": NOT_SHOWN, "n_required_d10pct": 1364, "n_pairs": 30})
    '1,364'
    """
    if row["verdict"] != NOT_SHOWN:
        return ""
    needed, pairs = row["n_required_d10pct"], row["n_pairs"]
    if needed is None:
        return f"≥ {FEWEST_TO_TELL}" if pairs < FEWEST_TO_TELL else "–"
    return f"{max(needed, FEWEST_TO_TELL):,}" if max(needed, FEWEST_TO_TELL) > pairs else "enough"


def range_needed(rows: Sequence[Row]) -> str:
    """Return in brackets how many seeds measures that show no difference need; empty if there are enough.

    Examples
    --------
    >>> rows = [{"n_required_d10pct": n, "n_pairs": 30} for n in (20, 364)]
    >>> range_needed(rows)
    ' (seeds needed: up to 364; there are 30)'
    """
    pairs = max(row["n_pairs"] for row in rows)
    needed = max((row["n_required_d10pct"] or 0 for row in rows), default=0)
    if max(needed, FEWEST_TO_TELL) <= pairs:
        return ""
    least = "up to " if needed > FEWEST_TO_TELL and len(rows) > 1 else "" if needed else "at least "
    there = f"there {'is' if pairs == 1 else 'are'} {pairs}"
    return f" (seeds needed: {least}{max(needed, FEWEST_TO_TELL):,}; {there})"
