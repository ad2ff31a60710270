"""Vehicles near the ego, as points of their outlines."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from controllers.geometry.footprints import footprints
from controllers.geometry.plane import vehicles_in_plane
from controllers.interface import FloatArray, Perception
from controllers.safety.pedestrian_discs import Discs

STANDING = 0.5
"""Slower ones stand [m/s]."""
NEAR, NEAR_DRIVING = 15.0, 35.0
"""Those farther from the ego's middle do not count, standing and driving [m]."""
DRIVEN_FOR = np.linspace(0.0, 3.0, 7)
"""Instants at which those that drive are looked at [s]."""
_SIDE = np.linspace(0.0, 1.0, 9)
OUTLINE = np.vstack(
    (
        *(np.column_stack((_SIDE, np.full(len(_SIDE), half))) for half in (-0.5, 0.5)),
        *(np.column_stack((np.full(3, end), np.linspace(-0.25, 0.25, 3))) for end in (0.0, 1.0)),
    )
)
"""Points of each: share of its length from the front backwards, share of its width to the left."""


def standing_vehicles(perception: Perception, count: int) -> Discs:
    """Return the outlines of those that stand, as discs without a radius, the same at ``count`` instants.

    They are in the plane of :mod:`controllers.geometry.plane`.
    """
    who = _apart(perception, NEAR) & _stand(perception)
    if not who.any():
        return Discs(*np.empty((3, 0, count)))
    x, y, _ = _outlines(perception, who)
    return Discs(*(np.repeat(values.reshape(-1, 1), count, axis=1) for values in (x, y, np.zeros(x.size))))


def driving_vehicles(perception: Perception) -> tuple[FloatArray, FloatArray]:
    """Return x and y of the outlines of those that drive, wherever they will be in the next seconds [m].

    Whoever follows the ego is left out.
    """
    them = perception.vehicles
    follow = footprints(them).same_way & (them.along < 0.0)
    who = _apart(perception, NEAR_DRIVING) & ~_stand(perception) & ~follow
    x, y, heading = _outlines(perception, who)
    speed = np.hypot(them.along_speed[who], them.across_speed[who])
    ahead, left = speed * np.cos(heading), speed * np.sin(heading)
    return (
        (x[..., None] + ahead[:, None, None] * DRIVEN_FOR).ravel(),
        (y[..., None] + left[:, None, None] * DRIVEN_FOR).ravel(),
    )


def _apart(perception: Perception, most: float) -> NDArray[np.bool_]:
    them, ego = perception.vehicles, perception.ego
    return np.asarray(np.hypot(them.along - 0.5 * ego.body.front, them.across - ego.across) < most)


def _stand(perception: Perception) -> NDArray[np.bool_]:
    them = perception.vehicles
    return np.asarray(np.hypot(them.along_speed, them.across_speed) < STANDING)


def _outlines(perception: Perception, who: NDArray[np.bool_]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x and y of the points of m vehicles, shape (m, points) [m], and their headings, (m,) [rad]."""
    them = perception.vehicles
    fronts, headings = vehicles_in_plane(perception.ego, perception.road, them)
    front, heading = fronts[who], headings[who]
    behind, left = OUTLINE[:, 0] * them.length[who][:, None], OUTLINE[:, 1] * them.width[who][:, None]
    cosine, sine = np.cos(heading)[:, None], np.sin(heading)[:, None]
    x, y = front[:, :1] - behind * cosine - left * sine, front[:, 1:] - behind * sine + left * cosine
    return x, y, heading
