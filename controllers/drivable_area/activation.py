"""When the method acts: somebody will be in the reaction space of the car that drives on."""

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
    """Return the first pedestrian who will be on the road in the reaction space; ``None`` for nobody.

    At each instant it is the space of the car where it is and as fast as it is by then: between the tightest
    arcs at that speed, and as far as the car would get if it braked fully.

    Parameters
    ----------
    expected : how the car drives on
    people : expected on the road
    shape : of the car
    road : for its edges; who is further away from it does not matter
    friction : f of the reaction space
    standoff : distance kept to a pedestrian's path where no stop line says more [m]
    stretch : the space reaches so many times as far, so that an avoidance that has begun does not end at once

    Notes
    -----
    Section 2 of [Wu2023]_ has the entropy of the space 0 while nobody is in it: the risk that the method
    weighs against speed and curvature begins there. The paper looks at one meeting and does not say when the
    method starts; this is our reading.
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
    # The car is level with a pedestrian, t_tcz, when the front has come to where they are.
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
    """Say who is in the space when, shape (n, K); a pedestrian's disc counts."""
    radius = arc_radius(speed, friction)
    reach = 0.5 * radius * stretch
    side = arc_side(forward, np.broadcast_to(radius, forward.shape), shape.body.width)
    disc = shape.pedestrian_radius
    return np.asarray((forward >= 0.0) & (forward <= reach + disc) & (beside <= side + disc))
