"""Vehicles ahead and behind, in the ego's lane and beside it, determined from the outlines of bodies."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.interface import Neighbour, NeighbourGaps, Vehicles
from cosim.arrays import FloatArray

TOLERANCE = 0.1
"""A body that reaches into a lane by less than this is not in it [m]."""
ONCOMING = math.radians(135.0)
"""Vehicles turned further than this come towards the ego; they are never neighbours [rad]."""
CROSSWISE = math.radians(45.0)
"""Vehicles turned further than this are across the road; they are only ever ahead in the ego's lane [rad]."""


@dataclass(frozen=True, slots=True)
class Extents:
    """Extents of vehicles in the route frame [m]."""

    rear: FloatArray
    front: FloatArray
    right: FloatArray
    left: FloatArray
    usable: NDArray[np.bool_]
    """Whether the vehicle is not oncoming."""
    aligned: NDArray[np.bool_]
    """Whether the vehicle points along the road."""


@dataclass(frozen=True, slots=True)
class LaneLine:
    """Position of a lane in the route frame."""

    width: float
    along: FloatArray | None = None
    """Along coordinates of the samples [m]; ``None`` for the reference lane itself."""
    centre: FloatArray | None = None
    """Across coordinates of the lane's centre at these samples; nan where there is no lane [m]."""
    origin: float = 0.0
    """Subtracted from ``along`` to get coordinates of the route frame [m]."""

    def centre_at(self, along: FloatArray) -> FloatArray:
        """Return the across coordinate of the lane's centre [m]; nan where there is no lane."""
        if self.along is None or self.centre is None:
            return np.zeros_like(along)
        return np.interp(along, self.along - self.origin, self.centre, left=np.nan, right=np.nan)


def extents(vehicles: Vehicles, back_along: FloatArray, back_across: FloatArray) -> Extents:
    """Return what vehicles cover of the road.

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
    vehicles: Vehicles,
    covered: Extents,
    starts: Sequence[int],
    lanes: Sequence[Mapping[int, LaneLine]],
    egos: Sequence[tuple[float, float]],
) -> list[NeighbourGaps]:
    """Return the nearest vehicles ahead of and behind each ego, in its lane and beside it.

    A vehicle counts in every lane that its body reaches into, so one on a lane line counts in both lanes. It
    is ahead if its middle is ahead of the ego's middle. The gap is measured between bumpers and is negative
    while the two overlap. Vehicles that stand or drive across the path only count as ahead in the ego's lane.

    Parameters
    ----------
    vehicles, covered : vehicles near the first ego, then those near the second one, and so on
    starts : where the vehicles of each ego begin, and where the last ones end
    lanes : lanes of each ego: 0 for its own lane, 1 for the one left of it, −1 for the one right of it
    egos : along coordinates of each ego's rear and front bumper [m]
    """
    found = [NeighbourGaps()] * len(egos)
    if not len(vehicles):
        return found
    counts = np.diff(starts)
    back, front = np.repeat(np.array(egos), counts, axis=0).T
    middle = 0.5 * (covered.rear + covered.front)
    is_ahead = middle > 0.5 * (back + front)
    to_ahead, to_behind = covered.rear - front, back - covered.front
    gaps = np.empty((2 * len(_SIDES), len(vehicles)))
    for number, side in enumerate(_SIDES):
        centre, half = _centres(side, middle, starts, lanes)
        reach = np.minimum(covered.left, centre + half)
        reach -= np.maximum(covered.right, centre - half)
        inside = (reach > TOLERANCE) & (covered.usable if side == 0 else covered.aligned)
        gaps[2 * number] = np.where(inside & is_ahead, to_ahead, np.inf)
        gaps[2 * number + 1] = np.where(inside & ~is_ahead & covered.aligned, to_behind, np.inf)
    some = np.flatnonzero(counts)
    smallest = np.minimum.reduceat(gaps, np.asarray(starts)[some], axis=1)
    for ego, least in zip(some.tolist(), smallest.T.tolist(), strict=True):
        first, last = starts[ego], starts[ego + 1]
        found[ego] = NeighbourGaps(
            *(
                _neighbour(vehicles, first + int(gaps[row, first:last].argmin()), gap)
                if math.isfinite(gap)
                else None
                for row, gap in enumerate(least)
            )
        )
    return found


_SIDES = (0, 1, -1)
"""In the order of the fields of `NeighbourGaps`."""


def _centres(
    side: int, middle: FloatArray, starts: Sequence[int], lanes: Sequence[Mapping[int, LaneLine]]
) -> tuple[FloatArray, FloatArray]:
    """Return, at each vehicle, the centre (nan if none) and half the width of its ego's lane on that side."""
    centre, width = np.full_like(middle, np.nan), np.zeros_like(middle)
    for ego, lines in enumerate(lanes):
        part = slice(starts[ego], starts[ego + 1])
        if part.start < part.stop and (line := lines.get(side)) is not None:
            centre[part] = line.centre_at(middle[part])
            width[part] = line.width
    return centre, 0.5 * width


def _neighbour(vehicles: Vehicles, row: int, gap: float) -> Neighbour:
    speed = float(vehicles.along_speed[row])
    if abs(float(vehicles.heading_error[row])) > CROSSWISE:
        # A crossing vehicle does not come nearer along the path, even if the path bends towards it.
        speed = max(0.0, speed)
    return Neighbour(
        vehicles.names[row],
        gap,
        speed,
        float(vehicles.acceleration[row]),
        float(vehicles.length[row]),
    )
