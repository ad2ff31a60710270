"""Who is ahead and behind, in the ego's lane and beside it, by the shapes of the bodies."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.interface import Neighbour, Vehicles

FloatArray = NDArray[np.float64]

TOLERANCE = 0.1
"""A body that reaches less than this into a lane is not in it [m]."""
ONCOMING = math.radians(135.0)
"""Vehicles turned further than this come towards the ego; they are never neighbours."""
CROSSWISE = math.radians(45.0)
"""Vehicles turned further than this stand or drive across; they are ahead, but beside nobody."""

CentreLine = Callable[[FloatArray], FloatArray]
"""Across coordinate of a lane's centre at along coordinates [m]; nan where the lane is not."""


@dataclass(frozen=True, slots=True)
class Extents:
    """What vehicles cover in the route frame [m]."""

    rear: FloatArray
    front: FloatArray
    right: FloatArray
    left: FloatArray
    usable: NDArray[np.bool_]
    """Not oncoming."""
    aligned: NDArray[np.bool_]
    """Driving along the road."""


def extents(vehicles: Vehicles, back_along: FloatArray, back_across: FloatArray) -> Extents:
    """Return what vehicles cover.

    Parameters
    ----------
    vehicles
    back_along, back_across : centre of each rear bumper in the route frame [m]
    """
    front_across = 2.0 * vehicles.across - back_across
    sine = 0.5 * vehicles.width * np.abs(np.sin(vehicles.heading_error))
    cosine = 0.5 * vehicles.width * np.abs(np.cos(vehicles.heading_error))
    turned = np.abs(vehicles.heading_error)
    return Extents(
        np.minimum(vehicles.along, back_along) - sine,
        np.maximum(vehicles.along, back_along) + sine,
        np.minimum(front_across, back_across) - cosine,
        np.maximum(front_across, back_across) + cosine,
        turned <= ONCOMING,
        turned <= CROSSWISE,
    )


def neighbours(
    vehicles: Vehicles,
    covered: Extents,
    centre_line: CentreLine,
    width: float,
    ego: tuple[float, float],
    own_lane: bool,
) -> tuple[Neighbour | None, Neighbour | None]:
    """Return the nearest vehicles ahead and behind in one lane.

    A vehicle counts where its body reaches into the lane, so one on a lane line counts in both lanes. It
    is ahead if its middle is ahead of the ego's middle; the gap is between bumpers, and negative while
    the two overlap.

    Parameters
    ----------
    vehicles, covered
    centre_line, width : the lane [m]
    ego : along coordinates of the ego's rear and front bumper [m]
    own_lane : whether vehicles across the path count, as they do for the lane the ego is in
    """
    if not len(vehicles):
        return None, None
    middle = 0.5 * (covered.rear + covered.front)
    centre = centre_line(middle)
    with np.errstate(invalid="ignore"):
        reach = np.minimum(covered.left, centre + 0.5 * width) - np.maximum(
            covered.right, centre - 0.5 * width
        )
        inside = reach > TOLERANCE
    inside &= covered.usable if own_lane else covered.aligned
    is_ahead = middle > 0.5 * (ego[0] + ego[1])
    ahead = np.where(inside & is_ahead, covered.rear - ego[1], np.inf)
    # Behind, a vehicle that crosses has gone or will turn; it is none of the ego's concern.
    behind = np.where(inside & ~is_ahead & covered.aligned, ego[0] - covered.front, np.inf)
    return _nearest(vehicles, ahead), _nearest(vehicles, behind)


def _nearest(vehicles: Vehicles, gaps: FloatArray) -> Neighbour | None:
    row = int(np.argmin(gaps))
    if not math.isfinite(gaps[row]):
        return None
    return Neighbour(
        vehicles.names[row],
        float(gaps[row]),
        float(vehicles.along_speed[row]),
        float(vehicles.acceleration[row]),
        float(vehicles.length[row]),
    )
