"""The way out for an ego that is kept from starting: walking pace, steered so that nobody comes nearer.

People gather round a standing car, and those who wait for it to leave their crossing stand where its way
leads. Of some steering angles the one nearest to the plan is taken that touches neither them nor a vehicle
that stands.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from controllers.driving.path_clearance import disc_clearances
from controllers.driving.plane import to_plane
from controllers.interface import Command, FloatArray, Perception
from controllers.prediction.discs import Discs
from controllers.safety.standing_vehicles import standing_vehicles

SPEED, ACCELERATION = 0.4, 0.5
"""Of the way out [m/s, m/s^2]."""
ANGLES = 13
"""Steering angles that are tried, evenly from right to left."""
ASIDE = 1.2
"""How far beside its lane's centre line it may lead [m]."""
TO_VEHICLES = 0.1
"""Distance kept to standing vehicles [m]."""


def way_out(
    perception: Perception, people: Discs, margin: FloatArray, times: FloatArray, wanted: float
) -> Command | None:
    """Return a command that leads out; ``None`` where there is none.

    Parameters
    ----------
    perception : what the ego is told
    people : where pedestrians will be
    margin : distance to each that counts as touching, shape (n,) [m]
    times : of the rollout and of ``people``, from now, shape (K,) [s]
    wanted : steering angle of the plan [rad]
    """
    ego = perception.ego
    angles = np.linspace(-ego.drive.max_steering, ego.drive.max_steering, ANGLES)
    x, y, heading = _rolled(perception, angles, times)
    near = disc_clearances(x, y, heading, ego.body, people.x, people.y, people.radius) < margin
    free = ~near.any(axis=(0, 2)) & _on_its_way(perception, x[-1], y[-1])
    cars = standing_vehicles(perception, len(times))
    if len(cars.x):
        apart = disc_clearances(x, y, heading, ego.body, cars.x, cars.y, cars.radius)
        # Who is that near already may stay so, but not come nearer.
        kept = np.minimum(apart[0, 0], TO_VEHICLES) - 1e-3
        free &= ~(apart < kept).any(axis=(0, 2))
    if not free.any():
        return None
    angle = angles[free][np.argmin(np.abs(angles[free] - wanted))]
    speeding = (SPEED - ego.speed) / max(ego.plan_interval, 0.5)
    return Command(np.zeros(1), np.array([min(speeding, ACCELERATION)]), np.array([float(angle)]))


def _on_its_way(perception: Perception, x: FloatArray, y: FloatArray) -> NDArray[np.bool_]:
    """Return which places are not too far beside the lane's centre line, or nearer to it than the ego is."""
    middle, heading = to_plane(perception.road, x, np.zeros(len(x)))
    beside = np.cos(heading) * (y - middle[:, 1]) - np.sin(heading) * (x - middle[:, 0])
    return np.asarray(np.abs(beside) <= max(ASIDE, abs(perception.ego.across)))


def _rolled(
    perception: Perception, angles: FloatArray, times: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x, y and heading of the rear axle under each steering angle, shape (K, m) each."""
    ego, step = perception.ego, np.diff(times, prepend=0.0)[:, None]
    turned = np.clip(angles - ego.steering, -1.0, 1.0)
    rate = ego.drive.max_steering_rate * times[:, None]
    steering = ego.steering + np.clip(turned, -rate, rate)
    speed = np.minimum(ego.speed + ACCELERATION * times, max(SPEED, ego.speed))[:, None]
    heading = ego.heading_error + np.cumsum(step * speed * np.tan(steering) / ego.body.wheelbase, axis=0)
    x = np.cumsum(step * speed * np.cos(heading), axis=0)
    y = ego.across + np.cumsum(step * speed * np.sin(heading), axis=0)
    return x, y, heading
