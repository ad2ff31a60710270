"""Pedestrians of the road without SUMO who choose their direction by the model of directions."""

from __future__ import annotations

import math

import numpy as np

from controllers.prediction.direction_choice import WALKING_SPEED, DirectionModel, Errand, velocity
from cosim.toy_world import Motion, ToyRoad, walk


def crossing_walk(
    road: ToyRoad,
    x: float,
    *,
    from_left: bool,
    angle: float,
    speed: float = WALKING_SPEED,
    start: float = 0.0,
) -> Motion:
    """Return the motion of somebody who walks from one kerb straight to the other, and stays there.

    Parameters
    ----------
    road : the road to cross; ``road.lanes`` · ``road.lane_width`` wide
    x : where he starts [m]
    from_left : from the left kerb, as the cars see it
    angle : between the cars' direction and his, in (0, π) [rad]
    speed : [m/s]
    start : when he leaves [s]

    Raises
    ------
    ValueError
        An angle that leads over no road, or a speed that is not positive.
    """
    if not 0.0 < angle < math.pi:
        raise ValueError(f"angle = {angle} must be between 0 and pi")
    if not 0.0 < speed < math.inf:
        raise ValueError(f"speed = {speed} must be greater than 0 and finite")
    right = -0.5 * road.lane_width
    width = road.lanes * road.lane_width
    x_speed, y_speed = velocity(angle, speed, from_left=from_left)
    stop = start + width / abs(y_speed)
    return walk(x, right + width if from_left else right, x_speed, y_speed, start, stop)


def drawn_walk(
    road: ToyRoad,
    x: float,
    *,
    from_left: bool,
    generator: np.random.Generator,
    goal_along: float = 0.0,
    goal_beyond: float = 0.0,
    model: DirectionModel | None = None,
    speed: float = WALKING_SPEED,
    start: float = 0.0,
) -> Motion:
    """Return the motion of somebody who crosses in a direction drawn from the model.

    Parameters
    ----------
    road, x, from_left, speed, start : as for :func:`crossing_walk`
    generator : what draws; the same state draws the same direction
    goal_along : how far his goal is along the road from where he starts [m]
    goal_beyond : how far it is behind the opposite kerb [m]
    model : of the choice
    """
    errand = Errand(road.lanes * road.lane_width, goal_along, goal_beyond)
    angle = (model or DirectionModel()).draw(errand, generator)
    return crossing_walk(road, x, from_left=from_left, angle=angle, speed=speed, start=start)
