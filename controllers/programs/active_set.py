"""What outlives one search near the last active rows (:mod:`controllers.numerics.active_rows`)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.numerics import active_rows
from controllers.numerics.active_rows import KEPT as KEPT
from controllers.numerics.compiling import code_of

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


class Optimum(NamedTuple):
    """A point that meets the optimality conditions."""

    z: FloatArray
    active: IntArray
    """Rows that bound it."""
    multipliers: FloatArray
    """Of these, non-negative."""
    cost: float
    """The objective there."""


@dataclass(slots=True)
class ActiveSet:
    """Searches from guessed active rows; remembers the cost matrix's inverse or factor.

    Parameters
    ----------
    compiled : whether the search is compiled
    constant : whether the cost matrix stays the same; only the effort depends on it
    """

    compiled: bool = False
    constant: bool = False
    _memory: FloatArray = field(default_factory=lambda: np.empty((0, 0, 0)))

    def resume(
        self, P: FloatArray, q: FloatArray, A: FloatArray, b: FloatArray, guess: IntArray, most: int
    ) -> Optimum | None:
        """Return the minimum of ``1/2 z'Pz + q'z`` subject to ``A z <= b``; ``None`` when it is not near.

        Parameters
        ----------
        P : positive definite, shape (n, n)
        q : shape (n,)
        A, b : shapes (m, n) and (m,); rows without bound have ``b = inf``
        guess : rows that may be active
        most : rows that may enter before the search is given up

        Examples
        --------
        The point nearest to (2, 1) left of z0 = 1:

        >>> row, bound = np.array([[1.0, 0.0]]), np.array([1.0])
        >>> nobody = np.empty(0, dtype=np.int64)
        >>> found = ActiveSet().resume(np.eye(2), np.array([-2.0, -1.0]), row, bound, nobody, most=3)
        >>> found.z.tolist(), found.active.tolist(), found.multipliers.tolist()
        ([1.0, 1.0], [0], [1.0])
        """
        if self._memory.shape[1:] != P.shape:
            matrices = 3 if self.constant or not self.compiled else 2
            self._memory = np.full((matrices, *P.shape), np.nan)
        code = code_of(active_rows, self.compiled)
        found, z, active, multipliers, cost = code.search(P, q, A, b, guess, most, self._memory)
        return Optimum(z, active, multipliers, cost) if found else None
