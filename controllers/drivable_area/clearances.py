"""Clearances between moving bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.geometry.path_clearance import beyond_edges
from controllers.interface import Body


@dataclass(frozen=True, slots=True)
class Shape:
    """Outline of the car that must not be touched: its rectangle, or the paper's disc.

    The centre of the disc is the reference point that moves along the path.
    """

    body: Body
    disc_radius: float | None = None
    """r_veh; ``None`` for the rectangle [m]."""
    pedestrian_radius: float = 0.35
    """r_pe [m]"""

    @property
    def middle(self) -> float:
        """Return how far the middle of the car is ahead of the reference point [m]."""
        return 0.0 if self.disc_radius is not None else self.body.front - 0.5 * self.body.length

    def clearance(
        self, along: FloatArray, across: FloatArray, heading: FloatArray, x: FloatArray, y: FloatArray
    ) -> FloatArray:
        """Return the distances from the car to pedestrians' discs; negative on contact [m].

        Parameters
        ----------
        along, across, heading : pose of the reference point; for the rectangle, the rear axle [m, rad]
        x, y : places of the pedestrians; all arrays broadcast [m]

        >>> shape = Shape(Body())
        >>> zero = np.zeros(1)
        >>> shape.clearance(zero, zero, zero, np.array([6.55]), zero).round(3).tolist()
        [2.65]
        """
        if self.disc_radius is not None:
            return np.asarray(np.hypot(x - along, y - across) - self.disc_radius - self.pedestrian_radius)
        ahead, beside = _seen_from(along, across, heading, x, y)
        beyond = np.abs(ahead - self.middle) - 0.5 * self.body.length
        aside = np.abs(beside) - 0.5 * self.body.width
        outside = np.hypot(np.maximum(beyond, 0.0), np.maximum(aside, 0.0))
        return np.asarray(outside + np.minimum(np.maximum(beyond, aside), 0.0) - self.pedestrian_radius)

    def beyond_edges(self, across: FloatArray, heading: FloatArray, right: float, left: float) -> FloatArray:
        """Return how far the car juts out over the edges of the road; negative inside [m].

        >>> Shape(Body()).beyond_edges(np.array([0.0, 1.0]), np.zeros(2), -1.75, 1.75).round(2).tolist()
        [-0.85, 0.15]
        """
        if self.disc_radius is None:
            return beyond_edges(across, heading, self.body, right, left)
        half = self.disc_radius * np.cos(heading)
        return np.asarray(np.maximum(across + half - left, right - across + half))


def _seen_from(
    along: FloatArray, across: FloatArray, heading: FloatArray, x: FloatArray, y: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return places in the coordinate systems of bodies, forward and to the left."""
    cosine, sine = np.cos(heading), np.sin(heading)
    dx, dy = x - along, y - across
    return cosine * dx + sine * dy, cosine * dy - sine * dx


@dataclass(frozen=True, slots=True)
class Boxes:
    """Rectangles of m vehicles at K times, shape (m, K), and their sizes, shape (m,)."""

    x: FloatArray
    """Places of the middles [m]."""
    y: FloatArray
    heading: FloatArray
    """Shape (m,) [rad]."""
    half_length: FloatArray
    half_width: FloatArray

    def __len__(self) -> int:
        return len(self.heading)


def apart(along: FloatArray, across: FloatArray, heading: FloatArray, body: Body, boxes: Boxes) -> FloatArray:
    """Return the widest gap between a car and rectangles along the axes of either, shape (n, m, K) [m].

    The gap is positive exactly where they do not overlap, and then never more than their distance.

    Parameters
    ----------
    along, across, heading : poses of n rear axles, shape (n, K) [m, rad]
    body : body of the car
    boxes : the rectangles
    """
    middle = body.front - 0.5 * body.length
    x = (along + middle * np.cos(heading))[:, None, :]
    y = (across + middle * np.sin(heading))[:, None, :]
    own = heading[:, None, :]
    other = np.broadcast_to(boxes.heading[None, :, None], (len(along), len(boxes), along.shape[1]))
    turned = other - own
    cosine, sine = np.abs(np.cos(turned)), np.abs(np.sin(turned))
    half_long, half_wide = 0.5 * body.length, 0.5 * body.width
    length, width = boxes.half_length[None, :, None], boxes.half_width[None, :, None]
    own_x, own_y = _seen_from(x, y, own, boxes.x[None], boxes.y[None])
    other_x, other_y = _seen_from(x, y, other, boxes.x[None], boxes.y[None])
    return np.asarray(
        np.max(
            (
                np.abs(own_x) - half_long - length * cosine - width * sine,
                np.abs(own_y) - half_wide - length * sine - width * cosine,
                np.abs(other_x) - length - half_long * cosine - half_wide * sine,
                np.abs(other_y) - width - half_long * sine - half_wide * cosine,
            ),
            axis=0,
        )
    )
