"""Vehicles that stand near the ego, as points of their outlines."""

from __future__ import annotations

import numpy as np

from controllers.driving.plane import to_plane
from controllers.interface import Perception
from controllers.prediction.discs import Discs

STANDING = 0.5
"""Slower ones count [m/s]; whoever drives is the plan's business."""
NEAR = 15.0
"""Those farther from the ego's middle do not count [m]."""
_SIDE = np.linspace(0.0, 1.0, 9)
OUTLINE = np.vstack(
    (
        *(np.column_stack((_SIDE, np.full(len(_SIDE), half))) for half in (-0.5, 0.5)),
        *(np.column_stack((np.full(3, end), np.linspace(-0.25, 0.25, 3))) for end in (0.0, 1.0)),
    )
)
"""Points of each: share of its length from the front backwards, share of its width to the left."""


def standing_vehicles(perception: Perception, count: int) -> Discs:
    """Return the points in the plane of :mod:`controllers.driving.plane`, as discs without a radius.

    They are the same at ``count`` instants.
    """
    them, ego = perception.vehicles, perception.ego
    near = np.hypot(them.along - 0.5 * ego.body.front, them.across - ego.across) < NEAR
    near &= np.hypot(them.along_speed, them.across_speed) < STANDING
    if not near.any():
        return Discs(*np.empty((3, 0, count)))
    length, width, turned = them.length[near], them.width[near], them.heading_error[near]
    front, heading = to_plane(
        perception.road, them.along[near], them.across[near] + 0.5 * length * np.sin(turned)
    )
    behind, left = OUTLINE[:, 0] * length[:, None], OUTLINE[:, 1] * width[:, None]
    cosine, sine = np.cos(heading + turned)[:, None], np.sin(heading + turned)[:, None]
    x = (front[:, :1] - behind * cosine - left * sine).ravel()
    y = (front[:, 1:] - behind * sine + left * cosine).ravel()
    return Discs(*(np.repeat(values[:, None], count, axis=1) for values in (x, y, np.zeros(len(x)))))
