"""Start and direction of a pedestrian who crosses a road away from crossings."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cosim.pedestrians.crossing_direction import CrossingDirection
from cosim.pedestrians.line import Line


@dataclass(frozen=True, slots=True)
class Roadside:
    """A cross-section of a road, seen in the direction of one of its edges.

    Parameters
    ----------
    x, y : a point on the right border [m]
    heading : heading of the road [rad]
    width : distance from the right to the left border, across all vehicle lanes of both directions [m]
    """

    x: float
    y: float
    heading: float
    width: float

    def point(self, along: float, left: float) -> tuple[float, float]:
        """Return the point at a distance along the road and to the left of the right border [m]."""
        east, north = math.cos(self.heading), math.sin(self.heading)
        return self.x + along * east - left * north, self.y + along * north + left * east


@dataclass(frozen=True, slots=True)
class Wish:
    """Where a pedestrian at the roadside wants to cross to.

    Parameters
    ----------
    from_left : whether the start is on the left of the road
    setback : distance of the start from the border of the road [m]
    goal_along : offset of the goal along the road, in the direction of the edge [m]
    goal_beyond : distance of the goal behind the other border [m]
    """

    from_left: bool
    setback: float = 0.5
    goal_along: float = 0.0
    goal_beyond: float = 1.0


def jaywalk_line(
    road: Roadside, wish: Wish, model: CrossingDirection, generator: np.random.Generator
) -> Line:
    """Return the line of the walk, from the start to the same distance beyond the other border.

    Notes
    -----
    The direction is drawn once, at the start, from the model of [LiLuZhang]_. In the paper, the cars drive
    one way only. Here, their direction is that of the edge, even for pedestrians who come from its left.
    """
    angle = model.draw(road.width, wish.goal_along, wish.goal_beyond, generator)
    along, across = math.cos(angle), math.sin(angle) * (-1.0 if wish.from_left else 1.0)
    left = road.width + wish.setback if wish.from_left else -wish.setback
    walked = (road.width + 2.0 * wish.setback) / abs(across)
    x, y = road.point(0.0, left)
    return Line(x, y, *road.point(walked * along, left + walked * across))
