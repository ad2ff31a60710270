"""Pedestrians who walk at random and keep away from a car, and where candidates meet them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.drivable_area.clearances import Shape
from controllers.drivable_area.drivable_entropy import EntropyMode, entropy_cost
from controllers.drivable_area.motions import Motions
from controllers.drivable_area.reaction_space import arc_radius, arc_side, space_area
from controllers.prediction.social_force_model import CarOutline, SocialForceModel, Walkers, aims_of

PLACE = 0.25
"""Width of a place in the reaction space [m]."""
PLACES = 48
"""Number of places, from 6 m right to 6 m left of the car."""
LEAST_AREA = 1.0
"""A smaller reaction space, as a slow car has, counts as this [m^2]."""
EVERY = 2
"""The entropy is computed once in this many steps."""


@dataclass(frozen=True, slots=True)
class Meetings:
    """How n candidates meet p pedestrians."""

    clearance: FloatArray
    """Least distance to the mean of any pedestrian's walks; inf if nobody is there, shape (n,) [m]."""
    collision: FloatArray
    """Probability that the car touches anybody, shape (n,)."""
    entropy: FloatArray
    """Entropy of the meetings, shape (n,)."""


def meetings(
    shape: Shape,
    people: Walkers,
    moving: Motions,
    model: SocialForceModel,
    friction: float,
    noise: FloatArray,
    mode: EntropyMode,
    met_at: FloatArray | None = None,
) -> Meetings:
    """Let people walk while the candidates drive, and return how they meet.

    Parameters
    ----------
    shape : shape of the car
    people : the people at the beginning, shape (p,)
    moving : the n candidates
    model : model of walking
    friction : f of the reaction space
    noise : standard normal numbers, shape (K, p, w) for w walks
    mode : form of the entropy
    met_at : when each candidate meets the pedestrian in conflict, inf if never, shape (n,) [s]; ``None``: the
        largest entropy of all instants counts

    Notes
    -----
    [Wu2023]_ takes the entropy at the instant t_tcz of Eq. (30). By then, a car that lets a pedestrian pass
    finds nobody in its reaction space, so that this entropy says nothing about the approach; the largest one
    does. The space at an instant follows from the car's speed at that instant.
    """
    count, _ = moving.along.shape
    number = noise.shape[1]
    if number == 0:
        none = np.zeros(count)
        return Meetings(np.full(count, np.inf), none, none)
    # All but the walking is computed for all instants at once, because the number of calls takes the time.
    x, y = _walked(shape, people, moving, model, noise)
    along, across, heading = (one.T for one in (moving.along, moving.across, moving.heading))
    pose = along[:, :, None, None], across[:, :, None, None], heading[:, :, None, None]
    touched = (shape.clearance(*pose, x, y) < 0.0).any(axis=(0, 2))
    mean = x.mean(axis=3), y.mean(axis=3)
    nearest = shape.clearance(along[:, :, None], across[:, :, None], heading[:, :, None], *mean)
    collision = np.asarray(touched.mean(axis=1))
    if mode is EntropyMode.RISK:
        entropy = entropy_cost(np.zeros((count, 1)), collision, 1.0, mode)
    else:
        seldom = slice(None, None, EVERY)
        then = pose[0][seldom], pose[1][seldom], pose[2][seldom]
        places, area = _places(shape, x[seldom], y[seldom], then, moving.speed.T[seldom], friction)
        each = entropy_cost(places, np.zeros(area.shape), area, mode)
        entropy = each.max(axis=0) if met_at is None else _at_meeting(each, moving.times[seldom], met_at)
    return Meetings(nearest.min(axis=(0, 2)), collision, entropy)


def _at_meeting(entropy: FloatArray, times: FloatArray, met_at: FloatArray) -> FloatArray:
    """Return each candidate's entropy, from shape (K, n), at the last instant before it meets somebody."""
    known = met_at <= times[-1]
    index = np.searchsorted(times, np.where(known, met_at, 0.0), side="right") - 1
    return np.asarray(np.where(known, entropy[index, np.arange(len(met_at))], 0.0))


def _walked(
    shape: Shape, people: Walkers, moving: Motions, model: SocialForceModel, noise: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the places on everybody's walks while each candidate drives, x and y of shape (K, n, p, w)."""
    size = (len(moving.along), *noise.shape[1:])
    walkers = Walkers(
        *(
            np.broadcast_to(one[None, :, None], size)
            for one in (people.x, people.y, people.x_speed, people.y_speed)
        )
    )
    aims = aims_of(people.x_speed[None, :, None], people.y_speed[None, :, None])
    x, y = np.empty((len(moving.times), *size)), np.empty((len(moving.times), *size))
    x[0], y[0] = walkers.x, walkers.y
    for k, duration in enumerate(np.diff(moving.times).tolist(), 1):
        car = _outline(
            shape,
            moving.along[:, k, None, None],
            moving.across[:, k, None, None],
            moving.heading[:, k, None, None],
        )
        walkers = model.walk(walkers, aims, car, duration, noise[k])
        x[k], y[k] = walkers.x, walkers.y
    return x, y


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
    x: FloatArray,
    y: FloatArray,
    pose: tuple[FloatArray, FloatArray, FloatArray],
    speed: FloatArray,
    friction: float,
) -> tuple[FloatArray, FloatArray]:
    """Return the probabilities of the places in the reaction space, and its area.

    Parameters
    ----------
    shape : shape of the car
    x, y : places on the walks, shape (K, n, p, w) [m]
    pose : pose of the reference point, shape (K, n, 1, 1) [m, m, rad]
    speed : speed of the car, shape (K, n) [m/s]
    friction : f of the reaction space

    Returns
    -------
    Shapes (K, n, p · places) and (K, n) [m^2].
    """
    along, across, heading = pose
    cosine, sine = np.cos(heading), np.sin(heading)
    dx, dy = x - along, y - across
    front = 0.0 if shape.disc_radius is not None else shape.body.front
    forward, left = cosine * dx + sine * dy - front, cosine * dy - sine * dx
    radius = arc_radius(speed, friction)
    reach = 0.5 * radius
    wide = arc_side(forward, radius[:, :, None, None], shape.body.width)
    inside = (forward >= 0.0) & (forward <= reach[:, :, None, None]) & (np.abs(left) <= wide)
    *each, number, walks = forward.shape
    index = np.clip(np.floor(left / PLACE).astype(np.int64) + PLACES // 2, 0, PLACES - 1)
    rows = forward.size // walks
    row = np.arange(rows).reshape(*each, number, 1) * PLACES
    found = np.bincount((row + index)[inside], minlength=rows * PLACES) / walks
    area = np.maximum(space_area(reach, radius, shape.body.width), LEAST_AREA)
    return found.reshape(*each, number * PLACES), area
