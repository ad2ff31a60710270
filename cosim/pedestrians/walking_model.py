"""How scripted pedestrians walk near vehicles: at a varying speed, pushed away by the nearest vehicle."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MiddleAxis:
    """A vehicle as walkers perceive it: the middle axis of its body, from which they keep away."""

    x: float
    """Middle of the body [m]."""
    y: float
    heading: float
    half_length: float = 0.0
    """Half the length of the axis; 0 gives the disc of the paper [m]."""

    def to(self, x: float, y: float) -> tuple[float, float]:
        """Return the vector from the nearest point of the axis to a place [m].

        >>> MiddleAxis(0.0, 0.0, 0.0, half_length=1.5).to(2.5, 3.0)
        (1.0, 3.0)
        """
        east, north = math.cos(self.heading), math.sin(self.heading)
        along = (x - self.x) * east + (y - self.y) * north
        along = min(max(along, -self.half_length), self.half_length)
        return x - self.x - east * along, y - self.y - north * along


@dataclass(frozen=True, slots=True)
class Motion:
    """Place and velocity of one walker [m, m/s]."""

    x: float
    y: float
    x_speed: float
    y_speed: float


@dataclass(frozen=True, slots=True)
class Aim:
    """Where and how fast one walker wants to go: a unit vector, and the mean speed [m/s]."""

    east: float
    north: float
    speed: float


@dataclass(frozen=True, slots=True)
class WalkingModel:
    """v(t + h) = v̄ + (v − v̄) e^(−h/τ) + ε, and a push of A e^(γ (r_v + r_p − d)) away from the vehicle.

    This model moves the simulated pedestrians. Controllers that predict with a social force have a model
    and parameters of their own (``controllers/prediction/social_force_model.py``), which must not be used
    here: the controllers would know the truth. The default values of both are those of the same paper, so
    that published results can be reproduced. To see how a predictor does with other people, change the
    values here.

    Notes
    -----
    Eqs. (37)-(43) of [Wu2023]_. In the paper's Δv = −φ (v − v̄) + ε, φ is 1 − e^(−h/τ) here, and the variance
    of ε is such that speeds keep the published spread, so that the length of a step does not matter. The
    paper gives A, γ, both radii and the spread, but neither φ nor the time step. The mass of a person is
    taken as 1, so that A is an acceleration. ``hardest`` and ``fastest`` bound what a person can do: within
    1 m of the vehicle, the formula asks for some hundred m/s².
    """

    spread: float = 0.05
    """Standard deviation of the speed [m/s]."""
    relaxation: float = 0.5
    """τ, the time in which speeds return to the mean [s]."""
    strength: float = 4.5
    """A, the push at a distance of r_v + r_p [m/s^2]."""
    steepness: float = 5.5
    """γ, how fast the push grows with nearness [1/m]."""
    vehicle_radius: float = 1.6
    """r_v [m]"""
    pedestrian_radius: float = 0.35
    """r_p [m]"""
    hardest: float = 6.0
    """Greatest acceleration from the push [m/s^2]."""
    fastest: float = 2.5
    """Highest speed to which the push accelerates a person [m/s]."""

    def push(self, x: float, y: float, vehicle: MiddleAxis) -> tuple[float, float]:
        """Return the acceleration away from a vehicle [m/s^2].

        >>> [round(one, 6) for one in WalkingModel().push(1.95, 0.0, MiddleAxis(0.0, 0.0, 0.0))]
        [4.5, 0.0]
        """
        away_x, away_y = vehicle.to(x, y)
        distance = math.hypot(away_x, away_y)
        excess = self.vehicle_radius + self.pedestrian_radius - distance
        # The exponent is limited to avoid overflow; the result is beyond the bound there anyway.
        size = min(self.strength * math.exp(min(self.steepness * excess, 50.0)), self.hardest)
        safe = max(distance, 1e-9)
        return size * away_x / safe, size * away_y / safe

    def walk(
        self, walker: Motion, aim: Aim, vehicle: MiddleAxis | None, duration: float, noise: float
    ) -> Motion:
        """Return the walker after a short time.

        Parameters
        ----------
        walker, aim : motion of the walker, and where they want to go
        vehicle : the vehicle to keep away from; ``None`` if there is none
        duration : h [s]
        noise : a standard normal number
        """
        kept = math.exp(-duration / self.relaxation)
        along = walker.x_speed * aim.east + walker.y_speed * aim.north
        gained = (1.0 - kept) * (aim.speed - along) + self.spread * math.sqrt(1.0 - kept * kept) * noise
        x_speed = kept * (walker.x_speed - along * aim.east) + (along + gained) * aim.east
        y_speed = kept * (walker.y_speed - along * aim.north) + (along + gained) * aim.north
        if vehicle is not None:
            push_x, push_y = self.push(walker.x, walker.y, vehicle)
            x_speed, y_speed = x_speed + duration * push_x, y_speed + duration * push_y
            # The push takes nobody beyond what a person can do, or their present speed if that is higher.
            most = max(math.hypot(walker.x_speed, walker.y_speed), self.fastest)
            share = min(1.0, most / max(math.hypot(x_speed, y_speed), 1e-9))
            x_speed, y_speed = x_speed * share, y_speed * share
        return Motion(
            walker.x + 0.5 * duration * (walker.x_speed + x_speed),
            walker.y + 0.5 * duration * (walker.y_speed + y_speed),
            x_speed,
            y_speed,
        )
