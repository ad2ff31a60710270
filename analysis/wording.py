"""Common wording of pages, tables and messages."""

from __future__ import annotations

import math
from collections.abc import Sequence


def some(names: Sequence[str], most: int) -> str:
    """Return names as a list, with the number of those left out.

    Examples
    --------
    >>> some(["a", "b", "c"], 2)
    'a, b and 1 more'
    """
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def decimals(value: float, least: int | None = None) -> int:
    """Return how many decimals keep a number from being rounded to 0: from ``least`` to three more.

    Parameters
    ----------
    value
    least : decimals shown in any case; ``None`` for about three significant digits

    Examples
    --------
    >>> decimals(0.04, 1), decimals(12.3, 1), decimals(0.0, 1), decimals(1e-17, 1)
    (2, 1, 1, 4)
    >>> decimals(0.5), decimals(12.3), decimals(1234.5)
    (3, 1, 0)
    """
    if least is None:
        size = abs(value)
        least = 3 if size < 1.0 else 2 if size < 10.0 else 1 if size < 1000.0 else 0
    return min(max(least, -math.floor(math.log10(abs(value)))), least + 3) if value else least


def p_value(value: float | None, undefined: str = "–") -> str:
    """Return the p value of a test as a text.

    Examples
    --------
    >>> p_value(0.04), p_value(0.0002)
    ('0.040', '< 0.001')
    """
    if value is None:
        return undefined
    return "< 0.001" if value < 0.001 else f"{value:.3f}"
