"""Standing vehicles that jut into a lane from beside it, such as those waiting for the ego in a junction."""

from __future__ import annotations

import numpy as np

from controllers.arrays import BoolArray, FloatArray
from controllers.driving.lanes import way_into_lane
from controllers.driving.standing import standing
from controllers.geometry.box_clearances import corners
from controllers.geometry.footprints import footprints
from controllers.geometry.plane import vehicles_in_plane
from controllers.interface import Lane, Perception

OF_THE_LANE = 1.0
"""Vehicles that face the ego's way with their middle nearer than this to that of the lane are in it, and the
ego follows them [m]."""


def standing_beside(perception: Perception, lane: Lane, farthest: float, aside: float) -> BoolArray:
    """Return which vehicles stand beside the way along a lane or jut into it, shape (n,).

    Parameters
    ----------
    perception : what the ego is told
    lane : lane that the ego drives in
    farthest : how far ahead to look [m]
    aside : how far beside the lane's centre line to look [m]
    """
    them, box = perception.vehicles, footprints(perception.vehicles)
    followed = box.same_way & (np.abs(them.across - lane.offset) < OF_THE_LANE)
    near = (box.left > lane.offset - aside) & (box.right < lane.offset + aside)
    return np.asarray(standing(them) & ~followed & near & (box.front > 0.0) & (box.rear < farthest))


def jutting_in(
    perception: Perception, lane: Lane, who: BoolArray, way: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return on which side vehicles are, and the least gap to the body on its way [m], shape (m,) each.

    The side is 1 for the left, -1 for the right. A gap is negative for a vehicle in the way, and inf for one
    that the body never is beside.

    Parameters
    ----------
    perception, lane : as for :func:`standing_beside`
    who : which vehicles, shape (n,)
    way : x, y and heading of the rear axle along the lane, (3, k), in the plane of
        :func:`controllers.geometry.plane.to_plane`
    """
    them, body = perception.vehicles, perception.ego.body
    fronts, headings = vehicles_in_plane(perception.ego, perception.road, them)
    side = np.where(them.across[who] > lane.offset, 1.0, -1.0)
    outline = corners(fronts[who], headings[who], them.length[who], them.width[who])
    beside, alongside = way_into_lane.beside_body(way, body, outline)
    gap = np.where(alongside, side[:, None, None] * beside - 0.5 * body.width, np.inf)
    return side, np.asarray(gap.min(axis=(1, 2)))
