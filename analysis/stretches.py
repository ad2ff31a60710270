"""Stretches of consecutive samples with a common property."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def stretches(inside: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return first and last index of each unbroken run of True.

    Examples
    --------
    >>> stretches(np.array([True, True, False, True]))
    [(0, 1), (3, 3)]
    """
    padded = np.zeros(len(inside) + 2, dtype=np.bool_)
    padded[1:-1] = inside
    edges = np.flatnonzero(padded[1:] != padded[:-1])
    return [(int(first), int(end) - 1) for first, end in zip(edges[::2], edges[1::2], strict=True)]
