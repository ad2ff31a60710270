"""Vehicles that stand near the ego, as discs that cover them."""

from __future__ import annotations

import numpy as np

from controllers.driving.plane import to_plane
from controllers.interface import Perception
from controllers.prediction.discs import Discs

STANDING = 0.5
"""Slower ones count [m/s]; whoever drives is the plan's business."""
NEAR = 15.0
"""Those farther from the ego's middle do not count [m]."""
PARTS = 4
"""Discs for each."""


def standing_vehicles(perception: Perception, count: int) -> Discs:
    """Return the discs in the plane of :mod:`controllers.driving.plane`, the same at ``count`` instants."""
    them, ego = perception.vehicles, perception.ego
    near = np.hypot(them.along - 0.5 * ego.body.front, them.across - ego.across) < NEAR
    near &= np.hypot(them.along_speed, them.across_speed) < STANDING
    length, width, turned = them.length[near], them.width[near], them.heading_error[near]
    front, heading = to_plane(
        perception.road, them.along[near], them.across[near] + 0.5 * length * np.sin(turned)
    )
    behind = (np.arange(PARTS) + 0.5) / PARTS * length[:, None]
    x = front[:, :1] - behind * np.cos(heading + turned)[:, None]
    y = front[:, 1:] - behind * np.sin(heading + turned)[:, None]
    radius = np.repeat(np.hypot(0.5 * length / PARTS, 0.5 * width), PARTS)
    return Discs(*(np.repeat(values.ravel()[:, None], count, axis=1) for values in (x, y, radius)))
