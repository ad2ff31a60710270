"""Who is ahead and behind, in the ego's lane and beside it, by the shapes of the bodies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.interface import Neighbour, NeighbourGaps, Vehicles

FloatArray = NDArray[np.float64]

TOLERANCE = 0.1
"""A body that reaches less than this into a lane is not in it [m]."""
ONCOMING = math.radians(135.0)
"""Vehicles turned further than this come towards the ego; they are never neighbours."""
CROSSWISE = math.radians(45.0)
"""Vehicles turned further than this stand or drive across; they are ahead, but beside nobody."""


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


@dataclass(frozen=True, slots=True)
class LaneLine:
    """Where a lane is in the route frame."""

    width: float
    along: FloatArray | None = None
    """Along coordinates [m]; ``None`` for the reference lane itself."""
    centre: FloatArray | None = None
    """Across coordinates of the lane's centre there; nan where the lane is not [m]."""

    def centre_at(self, along: FloatArray) -> FloatArray:
        """Return the across coordinate of the lane's centre [m]; nan where the lane is not."""
        if self.along is None or self.centre is None:
            return np.zeros_like(along)
        return np.interp(along, self.along, self.centre, left=np.nan, right=np.nan)


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


def neighbour_gaps(
    vehicles: Vehicles, covered: Extents, lanes: Mapping[int, LaneLine], ego: tuple[float, float]
) -> NeighbourGaps:
    """Return the nearest vehicles ahead and behind in the ego's lane and beside it.

    A vehicle counts where its body reaches into the lane, so one on a lane line counts in both lanes. It
    is ahead if its middle is ahead of the ego's middle; the gap is between bumpers, and negative while
    the two overlap. Vehicles that stand or drive across the path count as ahead, in the ego's lane only.

    Parameters
    ----------
    vehicles, covered
    lanes : 0 for the ego's lane, 1 for the one left of it, −1 for the one right of it
    ego : along coordinates of the ego's rear and front bumper [m]
    """
    if not len(vehicles):
        return NeighbourGaps()
    middle = 0.5 * (covered.rear + covered.front)
    is_ahead = middle > 0.5 * (ego[0] + ego[1])
    to_ahead, to_behind = covered.rear - ego[1], ego[0] - covered.front
    found: dict[int, tuple[Neighbour | None, Neighbour | None]] = {}
    for side, lane in lanes.items():
        centre = lane.centre_at(middle)
        reach = np.minimum(covered.left, centre + 0.5 * lane.width)
        reach -= np.maximum(covered.right, centre - 0.5 * lane.width)
        inside = (reach > TOLERANCE) & (covered.usable if side == 0 else covered.aligned)
        found[side] = (
            _nearest(vehicles, np.where(inside & is_ahead, to_ahead, np.inf)),
            _nearest(vehicles, np.where(inside & ~is_ahead & covered.aligned, to_behind, np.inf)),
        )
    nobody = (None, None)
    return NeighbourGaps(*found.get(0, nobody), *found.get(1, nobody), *found.get(-1, nobody))


def _nearest(vehicles: Vehicles, gaps: FloatArray) -> Neighbour | None:
    row = int(gaps.argmin())
    gap = float(gaps[row])
    if not math.isfinite(gap):
        return None
    speed = float(vehicles.along_speed[row])
    if abs(float(vehicles.heading_error[row])) > CROSSWISE:
        # Whoever crosses does not come nearer along the path, even if the path bends towards it.
        speed = max(0.0, speed)
    return Neighbour(
        vehicles.names[row],
        gap,
        speed,
        float(vehicles.acceleration[row]),
        float(vehicles.length[row]),
    )
