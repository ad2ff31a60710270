"""A quadratic program put together in Python loops, entry by entry."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

FloatArray = NDArray[np.float64]


class LoopBuilt:
    """A quadratic program that grows entry by entry."""

    def __init__(self, steps: int, slacks: int) -> None:
        self.steps = steps
        self.size = 5 * steps + slacks
        self.P: list[tuple[int, int, float]] = []
        self.q = np.zeros(self.size)
        self.G: list[tuple[int, int, float]] = []
        self.h: list[float] = []
        self.A: list[tuple[int, int, float]] = []
        self.b: list[float] = []
        self.lower = np.full(self.size, -np.inf)
        self.upper = np.full(self.size, np.inf)

    def state(self, k: int, i: int) -> int:
        """Return the variable of state ``i`` at the end of interval ``k``."""
        return 5 * k + i

    def input(self, k: int) -> int:
        """Return the variable of the input in interval ``k``."""
        return 5 * k + 4

    def slack(self, i: int) -> int:
        """Return the variable of a slack."""
        return 5 * self.steps + i

    def square(self, variable: int, weight: float, target: float = 0.0) -> None:
        """Add ``weight (z - target)^2`` to the objective, without its constant."""
        self.P.append((variable, variable, 2.0 * weight))
        self.q[variable] -= 2.0 * weight * target

    def at_most(self, terms: list[tuple[int, float]], bound: float) -> None:
        """Add the row ``sum of terms <= bound``, if it bounds anything."""
        if np.isfinite(bound):
            self.G += [(len(self.h), variable, value) for variable, value in terms]
            self.h.append(bound)

    def dynamics(
        self, k: int, matrix: FloatArray, inputs: FloatArray, offset: FloatArray, start: FloatArray
    ) -> None:
        """Add the rows ``x_k = matrix x_(k-1) + inputs u_k + offset``."""
        for i in range(4):
            row = len(self.b)
            self.A.append((row, self.state(k, i), 1.0))
            bound = offset[i]
            for j in range(4):
                if matrix[i, j] == 0.0:
                    continue
                if k == 0:
                    bound += matrix[i, j] * start[j]
                else:
                    self.A.append((row, self.state(k - 1, j), -matrix[i, j]))
            self.A.append((row, self.input(k), -inputs[i]))
            self.b.append(float(bound))

    def arrays(self) -> dict[str, Any]:
        """Return the arguments of ``solve_qp``."""
        return {
            "P": _matrix(self.P, self.size, self.size),
            "q": self.q,
            "G": _matrix(self.G, len(self.h), self.size),
            "h": np.array(self.h),
            "A": _matrix(self.A, len(self.b), self.size),
            "b": np.array(self.b),
            "lb": self.lower,
            "ub": self.upper,
        }


def _matrix(entries: list[tuple[int, int, float]], rows: int, columns: int) -> csc_matrix:
    row, column, value = zip(*entries, strict=True) if entries else ((), (), ())
    return csc_matrix((value, (row, column)), shape=(rows, columns))
