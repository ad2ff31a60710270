"""How a controller assumes pedestrians to walk: a Markov chain of speeds, and a push away from a near car."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class CarOutline:
    """A car as the social force sees it: a disc drawn along its middle axis.

    All fields broadcast against the pedestrians' arrays.
    """

    x: FloatArray | float
    """Middle of the body [m]."""
    y: FloatArray | float
    heading: FloatArray | float
    half_axis: float = 0.0
    """Half the length of the axis; 0 is the disc of the paper [m]."""


@dataclass(frozen=True, slots=True)
class Walkers:
    """Pedestrians in motion; all arrays of one shape."""

    x: FloatArray
    y: FloatArray
    x_speed: FloatArray
    y_speed: FloatArray


@dataclass(frozen=True, slots=True)
class Aims:
    """Where pedestrians want to walk; arrays that broadcast to the walkers' shape."""

    x: FloatArray
    """Unit vector of the direction; its length is 0 for a pedestrian who wants to stand."""
    y: FloatArray
    speed: FloatArray
    """Mean speed [m/s]."""


@dataclass(frozen=True, slots=True)
class SocialForceModel:
    """v(t + h) = v̄ + (v − v̄) e^(−h/τ) + ε, and a push of A e^(γ (r_v + r_p − d)) along the line from the car.

    This is what a controller or a predictor assumes. No simulated pedestrian walks by this code: scripted
    pedestrians have a model and parameters of their own, so that no forecast knows the truth. The default
    values of both come from the same paper.

    Notes
    -----
    Eqs. (37)-(43) of [Wu2023]_, whose Δv = −φ (v − v̄) + ε has φ = 1 − e^(−h/τ) here and a variance of ε for
    which speeds keep the published spread, so that the length of a step does not matter. The paper gives
    A, γ, both radii, v̄ and its spread, but neither φ nor the time step; the pedestrian's mass is taken as 1,
    so that A is an acceleration. ``hardest`` and ``fastest`` bound what a person can do: within 1 m of the
    car the formula asks for some hundred m/s².
    """

    spread: float = 0.05
    """Standard deviation of the speed [m/s]."""
    relaxation: float = 0.5
    """Relaxation time τ of the speed [s]."""
    strength: float = 4.5
    """Strength A of the push [m/s^2]."""
    steepness: float = 5.5
    """Steepness γ of the push over the distance [1/m]."""
    car_radius: float = 1.6
    """Radius r_v of the car [m]."""
    pedestrian_radius: float = 0.35
    """Radius r_p of the pedestrian [m]."""
    hardest: float = 6.0
    """Greatest acceleration by the push [m/s^2]."""
    fastest: float = 2.5
    """Greatest speed to which the push can accelerate a pedestrian [m/s]."""

    def push(self, x: FloatArray, y: FloatArray, car: CarOutline) -> tuple[FloatArray, FloatArray]:
        """Return the acceleration away from the car [m/s^2].

        >>> model = SocialForceModel()
        >>> model.push(np.array([1.95]), np.zeros(1), CarOutline(0.0, 0.0, 0.0))[0].round(6).tolist()
        [4.5]
        """
        cosine, sine = np.cos(car.heading), np.sin(car.heading)
        beside, ahead = x - car.x, y - car.y
        along = np.clip(cosine * beside + sine * ahead, -car.half_axis, car.half_axis)
        away_x, away_y = beside - cosine * along, ahead - sine * along
        distance = np.hypot(away_x, away_y)
        excess = self.car_radius + self.pedestrian_radius - distance
        # The exponent is limited where the result exceeds the bound in any case.
        size = np.minimum(self.strength * np.exp(np.minimum(self.steepness * excess, 50.0)), self.hardest)
        safe = np.maximum(distance, 1e-9)
        return size * away_x / safe, size * away_y / safe

    def walk(
        self, walkers: Walkers, aims: Aims, car: CarOutline | None, duration: float, noise: FloatArray
    ) -> Walkers:
        """Return the walkers after a short time.

        Parameters
        ----------
        walkers, aims : who walks, and where to
        car : car that they keep away from; ``None`` for none
        duration : h [s]
        noise : standard normal numbers, of the walkers' shape
        """
        kept = math.exp(-duration / self.relaxation)
        along = walkers.x_speed * aims.x + walkers.y_speed * aims.y
        # Walkers who want to stand have no direction in which to vary their speed.
        deviation = np.where(aims.speed > 0.0, self.spread * math.sqrt(1.0 - kept * kept), 0.0)
        onwards = along + ((1.0 - kept) * (aims.speed - along) + deviation * noise)
        x_speed = kept * (walkers.x_speed - along * aims.x) + onwards * aims.x
        y_speed = kept * (walkers.y_speed - along * aims.y) + onwards * aims.y
        if car is not None:
            push_x, push_y = self.push(walkers.x, walkers.y, car)
            x_speed, y_speed = self._bounded(
                walkers, x_speed + duration * push_x, y_speed + duration * push_y
            )
        return Walkers(
            walkers.x + 0.5 * duration * (walkers.x_speed + x_speed),
            walkers.y + 0.5 * duration * (walkers.y_speed + y_speed),
            x_speed,
            y_speed,
        )

    def _bounded(
        self, walkers: Walkers, x_speed: FloatArray, y_speed: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the speeds limited to ``fastest``, or to the present speed if that is higher."""
        squares = x_speed * x_speed + y_speed * y_speed
        if not (squares > 0.99 * self.fastest**2).any():
            return x_speed, y_speed  # the usual case, in a fraction of the time
        before = np.hypot(walkers.x_speed, walkers.y_speed)
        speed = np.hypot(x_speed, y_speed)
        share = np.minimum(1.0, np.maximum(before, self.fastest) / np.maximum(speed, 1e-9))
        return x_speed * share, y_speed * share


def aims_of(x_speed: FloatArray, y_speed: FloatArray, standing_below: float = 0.1) -> Aims:
    """Return the aims of people who keep pace and direction; those who stand remain standing.

    Parameters
    ----------
    x_speed, y_speed : [m/s]
    standing_below : people below this speed stand [m/s]
    """
    speed = np.hypot(x_speed, y_speed)
    walking = speed >= standing_below
    safe = np.where(walking, speed, 1.0)
    return Aims(
        np.where(walking, x_speed / safe, 0.0),
        np.where(walking, y_speed / safe, 0.0),
        np.where(walking, speed, 0.0),
    )
