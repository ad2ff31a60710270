"""Standing vehicles that jut into a lane from beside it, as those do that wait in a junction for the ego."""

from __future__ import annotations

import numpy as np

from controllers.arrays import BoolArray, FloatArray
from controllers.driving.standing import VEHICLE_STANDING
from controllers.geometry.footprints import footprints
from controllers.geometry.plane import vehicles_in_plane
from controllers.interface import Lane, Perception

OF_THE_LANE = 1.0
"""Vehicles that drive the ego's way with their middle nearer to the lane's are in it, and followed [m]."""


def standing_beside(perception: Perception, lane: Lane, farthest: float, aside: float) -> BoolArray:
    """Return which vehicles stand beside the way along a lane or jut into it, shape (n,).

    Parameters
    ----------
    perception : what the ego is told
    lane : that it drives in
    farthest : how far to look [m]
    aside : how far beside the lane's centre line to look [m]
    """
    them, box = perception.vehicles, footprints(perception.vehicles)
    stand = np.hypot(them.along_speed, them.across_speed) < VEHICLE_STANDING
    followed = box.same_way & (np.abs(them.across - lane.offset) < OF_THE_LANE)
    near = (box.left > lane.offset - aside) & (box.right < lane.offset + aside)
    return np.asarray(stand & ~followed & near & (box.front > 0.0) & (box.rear < farthest))


def jutting_in(
    perception: Perception, lane: Lane, who: BoolArray, way: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return on which side some vehicles are, and the least gap to the body on its way, (m,) each.

    The side is 1 for the left, -1 for the right. A gap is negative for those who are in the way, and inf for
    those beside whom the body never is [m].

    Parameters
    ----------
    perception, lane : as for :func:`standing_beside`
    who : which vehicles, shape (n,)
    way : x, y and heading of the rear axle along the lane, (3, k), in the plane of
        :func:`controllers.geometry.plane.to_plane`
    """
    body, corners = perception.ego.body, _corners(perception, who)
    side = np.where(perception.vehicles.across[who] > lane.offset, 1.0, -1.0)
    dx, dy = corners[..., :1] - way[0], corners[..., 1:] - way[1]
    cosine, sine = np.cos(way[2]), np.sin(way[2])
    ahead, beside = cosine * dx + sine * dy, cosine * dy - sine * dx
    alongside = (ahead < body.front) & (ahead > -body.rear_overhang)
    gap = np.where(alongside, side[:, None, None] * beside - 0.5 * body.width, np.inf)
    return side, np.asarray(gap.min(axis=(1, 2)))


def _corners(perception: Perception, who: BoolArray) -> FloatArray:
    """Return the corners of some vehicles in the plane, shape (n, 4, 2) [m]."""
    them = perception.vehicles
    fronts, headings = vehicles_in_plane(perception.ego, perception.road, them)
    front, heading = fronts[who, None, :], headings[who]
    along = np.stack([np.cos(heading), np.sin(heading)], axis=1)[:, None, :]
    across = np.stack([-along[..., 1], along[..., 0]], axis=2)
    behind = them.length[who].reshape(-1, 1, 1) * np.array([0.0, 0.0, 1.0, 1.0]).reshape(1, 4, 1)
    aside = 0.5 * them.width[who].reshape(-1, 1, 1) * np.array([1.0, -1.0, 1.0, -1.0]).reshape(1, 4, 1)
    return np.asarray(front - behind * along + aside * across)
