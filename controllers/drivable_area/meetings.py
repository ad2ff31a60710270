"""Pedestrians who walk at random and keep away from a car, and where candidates meet them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.drivable_area.clearances import Shape
from controllers.drivable_area.drivable_entropy import EntropyMode, entropy_cost
from controllers.drivable_area.motions import Motions
from controllers.drivable_area.reaction_space import arc_radius, arc_side, space_area
from controllers.interface import FloatArray
from controllers.prediction.social_force_model import CarOutline, SocialForceModel, Walkers, aims_of

PLACE = 0.25
"""Width of a place in the reaction space [m]."""
PLACES = 48
"""From 6 m right to 6 m left of the car."""
LEAST_AREA = 1.0
"""A smaller reaction space, that of a slow car, counts as this [m^2]."""
EVERY = 2
"""The reaction space is looked at once in so many steps."""


@dataclass(frozen=True, slots=True)
class Meetings:
    """How n candidates meet p pedestrians."""

    clearance: FloatArray
    """Least distance to the mean of anybody's walks; inf with nobody there, shape (n,) [m]."""
    collision: FloatArray
    """Probability that anybody is touched, shape (n,)."""
    entropy: FloatArray
    """Of the meetings, shape (n,)."""


def meetings(
    shape: Shape,
    people: Walkers,
    moving: Motions,
    model: SocialForceModel,
    friction: float,
    noise: FloatArray,
    mode: EntropyMode,
) -> Meetings:
    """Let people walk while the candidates drive.

    Parameters
    ----------
    shape : of the car
    people : at the beginning, shape (p,)
    moving : the n candidates
    model : of walking
    friction : f of the reaction space
    noise : standard normal numbers, shape (K, p, w) for w walks
    mode : of the entropy

    Notes
    -----
    Of the entropies at the instants of a candidate the largest counts. [Wu2023]_ means the instant of the
    meeting without saying which it is. The reaction space is the one of the car at its speed by then.
    """
    count, instants = moving.along.shape
    _, number, walks = noise.shape
    if number == 0:
        none = np.zeros(count)
        return Meetings(np.full(count, np.inf), none, none)
    size = (count, number, walks)
    walkers = Walkers(
        *(
            np.broadcast_to(one[None, :, None], size)
            for one in (people.x, people.y, people.x_speed, people.y_speed)
        )
    )
    aims = aims_of(people.x_speed[None, :, None], people.y_speed[None, :, None])
    nearest = np.full((count, number), np.inf)
    touched = np.zeros(size, dtype=bool)
    entropy = np.zeros(count)
    for k in range(instants):
        pose = (
            moving.along[:, k, None, None],
            moving.across[:, k, None, None],
            moving.heading[:, k, None, None],
        )
        if k > 0:
            duration = float(moving.times[k] - moving.times[k - 1])
            walkers = model.walk(walkers, aims, _outline(shape, *pose), duration, noise[k])
        touched |= shape.clearance(*pose, walkers.x, walkers.y) < 0.0
        mean = walkers.x.mean(axis=2), walkers.y.mean(axis=2)
        along, across, heading = (one[:, :, 0] for one in pose)
        nearest = np.minimum(nearest, shape.clearance(along, across, heading, *mean))
        if mode is not EntropyMode.RISK and k % EVERY == 0:
            places, area = _places(shape, walkers, pose, moving.speed[:, k], friction)
            entropy = np.maximum(entropy, entropy_cost(places, np.zeros(count), area, mode))
    collision = np.asarray(touched.any(axis=1).mean(axis=1))
    if mode is EntropyMode.RISK:
        entropy = entropy_cost(np.zeros((count, 1)), collision, 1.0, mode)
    return Meetings(nearest.min(axis=1), collision, entropy)


def _outline(shape: Shape, along: FloatArray, across: FloatArray, heading: FloatArray) -> CarOutline:
    body, disc = shape.body, shape.disc_radius is not None
    return CarOutline(
        along + shape.middle * np.cos(heading),
        across + shape.middle * np.sin(heading),
        heading,
        0.0 if disc else 0.5 * max(body.length - body.width, 0.0),
    )


def _places(
    shape: Shape,
    walkers: Walkers,
    pose: tuple[FloatArray, FloatArray, FloatArray],
    speed: FloatArray,
    friction: float,
) -> tuple[FloatArray, FloatArray]:
    """Return the probabilities of the places in the reaction space, shape (n, p · places), and its area."""
    along, across, heading = pose
    cosine, sine = np.cos(heading), np.sin(heading)
    x, y = walkers.x - along, walkers.y - across
    front = 0.0 if shape.disc_radius is not None else shape.body.front
    forward, left = cosine * x + sine * y - front, cosine * y - sine * x
    radius = arc_radius(speed, friction)
    reach = 0.5 * radius
    wide = arc_side(forward, radius[:, None, None], shape.body.width)
    inside = (forward >= 0.0) & (forward <= reach[:, None, None]) & (np.abs(left) <= wide)
    count, number, walks = forward.shape
    index = np.clip(np.floor(left / PLACE).astype(np.int64) + PLACES // 2, 0, PLACES - 1)
    row = np.arange(count * number).reshape(count, number, 1) * PLACES
    found = np.bincount((row + index)[inside], minlength=count * number * PLACES) / walks
    area = np.maximum(space_area(reach, radius, shape.body.width), LEAST_AREA)
    return found.reshape(count, number * PLACES), area
