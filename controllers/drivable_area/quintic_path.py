"""Paths across the road: a polynomial of fifth degree to an offset, which the path then keeps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray


def curvature(slope: FloatArray, bend: FloatArray) -> FloatArray:
    """Return κ = y″ / (1 + y′²)^(3/2) of a path y(x) [1/m].

    Notes
    -----
    This is Eq. (11) of [Wu2023]_, written for the path instead of the motion along it.
    """
    return np.asarray(bend / (1.0 + slope**2) ** 1.5)


@dataclass(frozen=True, slots=True)
class PathStart:
    """How a path begins."""

    across: float = 0.0
    """y(0) [m]"""
    slope: float = 0.0
    """y′(0), the tangent of the heading."""
    bend: float = 0.0
    """y″(0) [1/m]"""


@dataclass(frozen=True, slots=True)
class QuinticPaths:
    """Paths y(x) = Σ a_k x^k on [0, x_f] and y_f beyond, one for each offset y_f.

    Notes
    -----
    Eqs. (12)-(16) of [Wu2023]_: y(0), y′(0) and y″(0) are given; y(x_f) = y_f and y′(x_f) = y″(x_f) = 0.
    """

    coefficients: FloatArray
    """a_0 … a_5, shape (n, 6)."""
    length: float
    """x_f [m]"""
    end: FloatArray
    """y_f, shape (n,) [m]"""

    def at(self, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return y, y′ and y″ at places that broadcast to shape (n, K) [m, -, 1/m]."""
        inside = np.clip(x, 0.0, self.length)
        a = self.coefficients[:, :, None]
        y = a[:, 0] + inside * (
            a[:, 1] + inside * (a[:, 2] + inside * (a[:, 3] + inside * (a[:, 4] + inside * a[:, 5])))
        )
        slope = a[:, 1] + inside * (
            2.0 * a[:, 2] + inside * (3.0 * a[:, 3] + inside * (4.0 * a[:, 4] + inside * 5.0 * a[:, 5]))
        )
        bend = 2.0 * a[:, 2] + inside * (6.0 * a[:, 3] + inside * (12.0 * a[:, 4] + inside * 20.0 * a[:, 5]))
        beyond = x > self.length
        return (
            np.where(beyond, self.end[:, None], y),
            np.where(beyond, 0.0, slope),
            np.where(beyond, 0.0, bend),
        )


def quintic_paths(start: PathStart, length: float, end: FloatArray) -> QuinticPaths:
    """Return the paths from one start to several offsets.

    Parameters
    ----------
    start : how all of them begin
    length : x_f [m]
    end : y_f, shape (n,) [m]

    Raises
    ------
    ValueError
        If the length is not positive.

    Notes
    -----
    With s = x / x_f and c = (y_f − y_i, y′(0) x_f, y″(0) x_f²), the three free coefficients in s are
    10 c_0 − 6 c_1 − 1.5 c_2, −15 c_0 + 8 c_1 + 1.5 c_2 and 6 c_0 − 3 c_1 − 0.5 c_2. From a straight start
    this is y_i + (y_f − y_i) (10 s³ − 15 s⁴ + 6 s⁵).

    >>> y, slope, bend = quintic_paths(PathStart(), 10.0, np.array([2.0])).at(np.array([[0.0, 5.0, 10.0]]))
    >>> y.round(6).tolist()
    [[0.0, 1.0, 2.0]]
    """
    if not length > 0.0:
        raise ValueError(f"length = {length} must be greater than 0")
    shift = np.asarray(end, dtype=np.float64) - start.across
    tilt, bow = start.slope * length, start.bend * length**2
    coefficients = np.stack(
        (
            np.full(len(shift), start.across),
            np.full(len(shift), start.slope),
            np.full(len(shift), 0.5 * start.bend),
            (10.0 * shift - 6.0 * tilt - 1.5 * bow) / length**3,
            (-15.0 * shift + 8.0 * tilt + 1.5 * bow) / length**4,
            (6.0 * shift - 3.0 * tilt - 0.5 * bow) / length**5,
        ),
        axis=1,
    )
    return QuinticPaths(coefficients, length, np.asarray(end, dtype=np.float64))
