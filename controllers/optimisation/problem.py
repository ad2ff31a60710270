"""A quadratic program with named variables and rows.

``minimise 1/2 z'Pz + q'z  subject to  G z <= h,  lower <= z <= upper``
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A convex quadratic program of n variables and m rows, which come in named blocks.

    The code that states the problem writes its arrays in place for each solve: the next problem has the same
    layout and other values. A row without a bound has ``h = inf``.

    Parameters
    ----------
    objective
        What is minimised, as a formula in the symbols of the field.
    variables, rows
        Name, with the unit, of each block of variables and of rows, and the slice where it is.
    P, q
        Cost: symmetric and positive semidefinite, shape (n, n), and shape (n,).
    G, h
        Rows, shapes (m, n) and (m,).
    lower, upper
        Bounds of the variables, shape (n,).

    Examples
    --------
    >>> problem = blank("(v - 8)^2", {"speed [m/s]": 1}, {"speed below the limit [m/s]": 1})
    >>> problem.P[0, 0], problem.q[0], problem.G[0, 0], problem.h[0] = 2.0, -16.0, 1.0, 7.0
    >>> problem.violations(np.array([7.5]))
    {'speed below the limit [m/s]': 0.5}
    """

    objective: str
    variables: Mapping[str, slice]
    rows: Mapping[str, slice]
    P: FloatArray
    q: FloatArray
    G: FloatArray
    h: FloatArray
    lower: FloatArray
    upper: FloatArray

    def cost(self, z: FloatArray) -> float:
        """Return the objective at ``z``, without its constant part."""
        return float(0.5 * z @ (self.P @ z) + self.q @ z)

    def violations(self, z: FloatArray) -> dict[str, float]:
        """Return the largest violation for each block of rows or of variables that has one."""
        rows = self.G @ z - self.h
        bounds = np.maximum(self.lower - z, z - self.upper)
        found = {name: float(rows[at].max(initial=0.0)) for name, at in self.rows.items()}
        found |= {name: float(bounds[at].max(initial=0.0)) for name, at in self.variables.items()}
        return {name: value for name, value in found.items() if value > 0.0}

    def __str__(self) -> str:
        """Return the problem as text: what is minimised, over which variables, subject to which rows."""
        lines = [f"minimise {self.objective}", "over"]
        for name, at in self.variables.items():
            span = f"{self.lower[at].min():g} to {self.upper[at].max():g}"
            lines.append(f"  {at.stop - at.start:4d} x {name}, {span}")
        lines.append("subject to")
        for name, at in self.rows.items():
            bounded = int(np.isfinite(self.h[at]).sum())
            lines.append(f"  {bounded:4d} x {name}")
        return "\n".join(lines)


def blank(objective: str, variables: Mapping[str, int], rows: Mapping[str, int]) -> Problem:
    """Return a problem with blocks of these sizes that has no costs and no bounds yet."""
    n, m = sum(variables.values()), sum(rows.values())
    return Problem(
        objective,
        _places(variables),
        _places(rows),
        P=np.zeros((n, n)),
        q=np.zeros(n),
        G=np.zeros((m, n)),
        h=np.full(m, np.inf),
        lower=np.full(n, -np.inf),
        upper=np.full(n, np.inf),
    )


def _places(sizes: Mapping[str, int]) -> dict[str, slice]:
    ends = np.cumsum(list(sizes.values()), dtype=int).tolist()
    return {name: slice(end - size, end) for (name, size), end in zip(sizes.items(), ends, strict=True)}
