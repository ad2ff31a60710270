"""Automatic emergency braking: it begins too late to be comfortable, but in time to stop."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving.standing import HOLDING, STANDING
from controllers.geometry.contact_times import box_contact_times, disc_contact_times, sampled_contact_times
from controllers.geometry.footprints import ALONG_THE_LANE
from controllers.interface import Drive, EgoState, Perception
from controllers.prediction.forecast import Forecast, Predictor

GRAVITY = 9.80665
START_SPEED = 2.0
"""A standing car does not start if it would hit somebody at this speed [m/s]."""
HELD_FOR = 3.0
"""Braking goes on while the ego would hit somebody within this time at its present or initial speed [s]."""
FRONT_DEPTH = 0.5
"""A contact up to this far behind the front bumper counts as one with the front [m]."""
FORECAST_TIMES = np.linspace(0.0, 5.0, 51)
"""Times for which a predictor is asked where people will be; afterwards they go straight on [s]."""


@dataclass(frozen=True, slots=True)
class BrakingRule:
    """How the emergency brake works.

    Notes
    -----
    Dead time, linear ramp and full braking f · g are those of the comparison system of [Wu2023]_.
    """

    friction: float = 0.8
    dead_time: float = 0.1
    ramp: float = 0.2
    stop_margin: float = 0.5
    """Distance to be left after a stop [m]."""
    side_margin: float = 0.1
    """Margin by which a pedestrian's disc is grown [m]."""

    def full(self, drive: Drive) -> float:
        """Return the full deceleration [m/s^2]."""
        return min(self.friction * GRAVITY, drive.max_deceleration)


def stopping_distance(speed: float, deceleration: float, dead_time: float, ramp: float) -> float:
    """Return the distance from the trigger to standstill [m].

    It is v · (t_dead + t_ramp / 2) + v² / (2 a) − a · t_ramp² / 24, or the distance within the dead time and
    the ramp if the ego comes to a stop during the ramp.

    Parameters
    ----------
    speed : v [m/s]
    deceleration : full braking a [m/s^2]
    dead_time, ramp : t_dead, t_ramp [s]

    >>> round(stopping_distance(40 / 3.6, 0.8 * GRAVITY, 0.1, 0.2), 2)
    10.08
    """
    if ramp > 0.0 and speed < 0.5 * deceleration * ramp:
        stops = math.sqrt(2.0 * speed * ramp / deceleration)
        return speed * dead_time + 2.0 / 3.0 * speed * stops
    return speed * (dead_time + 0.5 * ramp) + speed**2 / (2.0 * deceleration) - deceleration * ramp**2 / 24.0


class EmergencyBraking:
    """The state of the emergency brake: whether, when and at which speed it was triggered.

    Parameters
    ----------
    rule : how it brakes
    predictor : predicts where pedestrians will be; ``None``: they keep their velocities, in closed form
    """

    def __init__(self, rule: BrakingRule | None = None, predictor: Predictor | None = None) -> None:
        self.rule = rule or BrakingRule()
        self._predictor = predictor
        self._forecast: Forecast | None = None
        self._since: float | None = None
        self._speed = 0.0

    def watch(self, perception: Perception) -> str:
        """Trigger, hold or release the brake; return the name for which it brakes, empty if it does not."""
        ego = perception.ego
        if self._predictor is not None:
            self._forecast = self._predictor.predict(perception, FORECAST_TIMES)
        if ego.speed < STANDING:
            threat = self._threat(perception, START_SPEED)
        elif self._since is None:
            threat = self._threat(perception, ego.speed)
        else:
            threat = self._threat(perception, ego.speed, HELD_FOR) or self._threat(
                perception, self._speed, HELD_FOR
            )
        if not threat:
            self._since = None
        elif self._since is None:
            self._since, self._speed = ego.time, ego.speed
        return threat

    def accelerations(self, ego: EgoState, times: FloatArray) -> FloatArray:
        """Return the greatest accelerations that the brake allows in the steps from ``times`` on [m/s^2]."""
        if self._since is None:
            return np.full(len(times), np.inf)
        if ego.speed < STANDING:
            return np.full(len(times), HOLDING)
        step = float(times[1] - times[0]) if len(times) > 1 else ego.plan_interval
        # On the ramp, the value in the middle of a step is its mean, so the stopping distance is kept.
        elapsed = ego.time - self._since + times + 0.5 * step - self.rule.dead_time
        built_up = np.clip(elapsed / max(self.rule.ramp, 1e-9), 0.0, 1.0)
        return np.where(built_up > 0.0, -built_up * self.rule.full(ego.drive), np.inf)

    def _threat(self, perception: Perception, speed: float, within: float = 0.0) -> str:
        """Return whom the ego would hit at a speed before it can stop, or within a time; empty for nobody."""
        people = _people(perception, speed, self.rule, self._forecast)
        cars = _cars(perception, speed)
        if perception.ego.speed < STANDING:
            # Starting beside a standing vehicle is left to the controller, which steers out.
            cars = (np.full(len(cars[0]), np.inf), cars[1])
        names = (*perception.pedestrians.names, *perception.vehicles.names)
        times = np.concatenate([people[0], cars[0]])
        closing = speed - np.maximum(np.concatenate([people[1], cars[1]]), 0.0)
        drive = perception.ego.drive
        # If the brake is not triggered now, it is one plan later; by then the ego may have become faster.
        late = drive.drive_lag + perception.ego.plan_interval
        gained = max(perception.ego.acceleration, 0.0) * late
        urgent = [
            bool(np.isfinite(time)) and (time <= within or u * time <= self._needed(u + gained, late, drive))
            for time, u in zip(times, np.maximum(closing, 0.0), strict=True)
        ]
        first = np.where(urgent, times, np.inf)
        return names[int(np.argmin(first))] if any(urgent) else ""

    def _needed(self, speed: float, late: float, drive: Drive) -> float:
        """Return the least distance to the contact at which the brake may still be triggered later [m]."""
        rule = self.rule
        stops = stopping_distance(speed, rule.full(drive), rule.dead_time + late, rule.ramp)
        return stops + rule.stop_margin


def _people(
    perception: Perception, speed: float, rule: BrakingRule, forecast: Forecast | None
) -> tuple[FloatArray, FloatArray]:
    """Return when the front hits each pedestrian [s], and their speed in the ego's direction then [m/s]."""
    them, ego = perception.pedestrians, perception.ego
    x, y, x_speed, y_speed = _seen_from(ego, them.along, them.across, them.along_speed, them.across_speed)
    body = ego.body
    side, radius = 0.5 * body.width, them.radius
    relative = x_speed - speed
    grown = radius + rule.side_margin
    within = disc_contact_times(-body.rear_overhang, body.front, side, x, y, 0.0 * x, 0.0 * y, radius)
    if forecast is None:
        times = disc_contact_times(-body.rear_overhang, body.front, side, x, y, relative, y_speed, grown)
    else:
        times, x, relative = _forecast_contacts(ego, speed, forecast, grown)
        x_speed = relative + speed
    return np.where((within == 0.0) | _at_front(times, x, relative, body.front), times, np.inf), x_speed


def _forecast_contacts(
    ego: EgoState, speed: float, forecast: Forecast, radius: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return when the ego hits each pedestrian [s], and the line along which they move ahead of it then.

    The second value is where that line is at time 0 [m], the third its slope [m/s], both relative to the ego.
    """
    body, samples = ego.body, forecast.times
    x, y = _turned(ego, forecast.along, forecast.across - ego.across)
    x = x - speed * samples
    times, interval = sampled_contact_times(
        -body.rear_overhang, body.front, 0.5 * body.width, samples, x, y, radius[:, None] + forecast.reach
    )
    each = np.arange(len(times))
    begins = samples[interval]
    slope = (x[each, interval + 1] - x[each, interval]) / (samples[interval + 1] - begins)
    return times, x[each, interval] - slope * begins, slope


def _cars(perception: Perception, speed: float) -> tuple[FloatArray, FloatArray]:
    """Return when the ego hits each vehicle that stands or goes the same way [s], and its speed [m/s]."""
    them, ego = perception.vehicles, perception.ego
    along = them.along - 0.5 * them.length * np.cos(them.heading_error)
    x, y, x_speed, y_speed = _seen_from(ego, along, them.across, them.along_speed, them.across_speed)
    turned = them.heading_error - ego.heading_error
    half_length = 0.5 * (them.length * np.abs(np.cos(turned)) + them.width * np.abs(np.sin(turned)))
    half_width = 0.5 * (them.width * np.abs(np.cos(turned)) + them.length * np.abs(np.sin(turned)))
    body = ego.body
    relative = x_speed - speed
    times = box_contact_times(
        -body.rear_overhang - half_length,
        body.front + half_length,
        0.5 * body.width + half_width,
        x,
        y,
        relative,
        y_speed,
    )
    # A standing vehicle, perhaps about to turn across the ego's way, will not have left it in time.
    concerned = (np.abs(turned) < ALONG_THE_LANE) | (np.hypot(them.along_speed, them.across_speed) < STANDING)
    met = concerned & _at_front(times, x - half_length, relative, body.front)
    return np.where(met, times, np.inf), x_speed


def _at_front(times: FloatArray, x: FloatArray, relative: FloatArray, front: float) -> np.ndarray:
    """Return which contacts are with the front; braking does not prevent those with a side."""
    met = np.where(np.isfinite(times), times, 0.0)
    return np.isfinite(times) & (x + relative * met >= front - FRONT_DEPTH)


def _seen_from(
    ego: EgoState, along: FloatArray, across: FloatArray, along_speed: FloatArray, across_speed: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return places and velocities in the ego's own axes, with the origin at its rear axle."""
    return (
        *_turned(ego, along, across - ego.across),
        *_turned(ego, along_speed, across_speed),
    )


def _turned(ego: EgoState, along: FloatArray, across: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return vectors of the route frame in the ego's own axes."""
    cosine, sine = math.cos(ego.heading_error), math.sin(ego.heading_error)
    return cosine * along + sine * across, cosine * across - sine * along
