"""Which axes matter most: Sobol's first-order indices from trials that cover the space evenly, by SALib."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis.search.axes import Axis, Point, shares

FEWEST = 40
"""With fewer trials than this, the indices say nothing."""
HARMONICS = 4
RESAMPLES = 200


@dataclass(frozen=True, slots=True)
class Influence:
    """How much an axis alone decides the margin."""

    axis: str
    first_order: float
    """Sobol's first-order index: the share of the margin's variance that the axis explains alone."""
    half_width: float
    """Half width of its 95 % interval, from resampling."""


def influences(axes: Sequence[Axis], points: Sequence[Point], margins: Sequence[float]) -> list[Influence]:
    """Return the influence of each axis, the largest first; empty for fewer than `FEWEST` trials.

    Parameters
    ----------
    axes
    points
        Points that cover the space evenly: the trials of the first generations, not those to which the search
        has led.
    margins
        Margins of the points.

    Raises
    ------
    ModuleNotFoundError
        If SALib is missing.

    Notes
    -----
    Random balance designs with bias correction [Tissot2012]_. They need no special design: any even sample
    will do. The indices do not include interactions of axes.
    """
    from SALib.analyze import rbd_fast

    places, values = shares(axes, points), np.asarray(margins, dtype=np.float64)
    if len(values) < FEWEST or np.ptp(values) == 0.0:
        return []
    bounds = [[0.0, 1.0]] * len(axes)
    problem = {"num_vars": len(axes), "names": [axis.name for axis in axes], "bounds": bounds}
    found = rbd_fast.analyze(problem, places, values, M=HARMONICS, num_resamples=RESAMPLES, seed=1)
    rows = [
        Influence(axis.name, float(found["S1"][i]), float(found["S1_conf"][i])) for i, axis in enumerate(axes)
    ]
    return sorted(rows, key=lambda one: -one.first_order)
