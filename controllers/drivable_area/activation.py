"""Decides when the method acts: a pedestrian will be in the reaction space if the car drives on."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray
from controllers.conflicts.path_conflicts import Conflicts
from controllers.drivable_area.clearances import Shape
from controllers.drivable_area.conflict import ROAD_MARGIN, Conflict, Outlook, stopping_place
from controllers.drivable_area.reaction_space import arc_radius, arc_side
from controllers.interface import RoadAhead


def in_reaction_space(
    expected: Outlook,
    people: Conflicts,
    shape: Shape,
    road: RoadAhead,
    friction: float,
    standoff: float,
    stretch: float = 1.0,
) -> Conflict | None:
    """Return the first pedestrian who will be on the road in the reaction space; ``None`` if there is none.

    The space is computed anew for each instant, from the car's place and speed at that instant. It lies
    between the tightest arcs at that speed and reaches as far as the car would get if it braked fully.

    Parameters
    ----------
    expected : how the car would drive on
    people : the pedestrians expected on the road
    shape : shape of the car
    road : the road whose edges count; people further away from it do not matter
    friction : f of the reaction space
    standoff : distance kept to a pedestrian's path if no stop line asks for more [m]
    stretch : factor on the length of the space, so that an avoidance that has begun does not end at once

    Notes
    -----
    In Section 2 of [Wu2023]_ the entropy of the space is 0 while nobody is in it. So the risk that the method
    weighs against speed and curvature begins when somebody enters it. The paper looks at one meeting and does
    not say when the method starts; this is our reading.
    """
    if len(people) == 0:
        return None
    x = people.along[:, None] + people.along_speed[:, None] * expected.times
    y = people.across[:, None] + people.across_speed[:, None] * expected.times
    forward = x - expected.along - shape.body.front
    inside = _inside(forward, np.abs(y - expected.across), expected.speed, shape, friction, stretch)
    inside &= (y > road.right_edge - ROAD_MARGIN) & (y < road.left_edge + ROAD_MARGIN)
    inside &= expected.speed > 0.1
    whom = np.flatnonzero(inside.any(axis=1))
    if len(whom) == 0:
        return None
    # The car is level with a pedestrian, t_tcz, once its front has reached their place.
    level = np.where((forward <= 0.0).any(axis=1), (forward <= 0.0).argmax(axis=1), len(expected.times) - 1)
    person = int(whom[np.argmin(level[whom])])
    k = int(level[person])
    place = float(stopping_place(people, whom, x[whom, level[whom]], shape, standoff).min())
    return Conflict(
        people.names[person], float(expected.times[k]), float(x[person, k]), float(y[person, k]), place
    )


def _inside(
    forward: FloatArray, beside: FloatArray, speed: FloatArray, shape: Shape, friction: float, stretch: float
) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Say which pedestrians are in the space at which instants, their discs included; shape (n, K)."""
    radius = arc_radius(speed, friction)
    reach = 0.5 * radius * stretch
    side = arc_side(forward, np.broadcast_to(radius, forward.shape), shape.body.width)
    disc = shape.pedestrian_radius
    return np.asarray((forward >= 0.0) & (forward <= reach + disc) & (beside <= side + disc))
