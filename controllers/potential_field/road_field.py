"""The potential field around an ego: lanes and edges of its road, pedestrians it will meet, vehicles beside.

The field is in the route frame and steers the rear axle, but the obstacles push the middle of the body away.
So they stand in the field as far behind their real place as the middle is ahead of the axle.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.interface import EgoState, Perception
from controllers.potential_field.field import (
    Field,
    Gains,
    Obstacles,
    distance_to_shift,
    meeting_time,
    needed_shift,
    side_distance,
)
from controllers.prediction.forecast import Forecast

FORECAST_TIMES: Final = np.arange(0.0, 5.05, 0.1)
"""Times at which the places of people are predicted [s]."""
SLOWEST = 2.0
"""A slower or standing ego is treated as if it drove at this speed [m/s]."""
LONG_BEHIND = 3.0
"""Pedestrians with whom the ego was level longer ago than this do not matter any more [s]."""
SHORTEST_AXIS = 1.0
"""A pedestrian is no obstacle if the ego needs less than this distance to get past [m]."""
VEHICLE_SIDE = 0.4
"""Side half-axis of a vehicle as a share of the safe distance beside it; its field ends at its lane."""
VEHICLE_TIME = 0.5
"""The long half-axis of a vehicle is half of both lengths plus the distance closed in this time [s]."""
VEHICLE_RANGE = 60.0
"""Vehicles further away do not matter [m]."""


@dataclass(frozen=True, slots=True)
class FieldSettings:
    """Parameters of the field.

    Parameters
    ----------
    margin : S_m, distance to be left beside a pedestrian [m]
    lateral_acceleration : a_y, from which the distance for a shift follows [m/s^2]
    fixed_axis : the long half-axis for everybody; ``None``: it follows from the needed shift [m]
    gains : weights
    """

    margin: float = 0.6
    lateral_acceleration: float = 0.3 * 9.80665
    fixed_axis: float | None = None
    gains: Gains = field(default_factory=Gains)


@dataclass(frozen=True, slots=True)
class Meetings:
    """Where the ego will be level with each pedestrian; arrays of length n."""

    along: FloatArray
    """x of the predicted conflict point [m]."""
    across: FloatArray
    radius: FloatArray
    """Radius of the disc plus the uncertainty of the prediction at that time [m]."""
    matters: NDArray[np.bool_]
    """Whether the meeting is neither too far ahead nor too long ago."""


def braked_speeds(ego: EgoState, braking: float, times: FloatArray) -> FloatArray:
    """Return the speeds of an ego that brakes from now on, down to ``SLOWEST`` or its lower speed now [m/s].

    The ego's drive follows the command with a lag: a(t) = −b + (a + b) exp(−t / T).
    """
    lag = max(ego.drive.drive_lag, 1e-3)
    late = (ego.acceleration + braking) * lag * -np.expm1(-times / lag)
    speed = max(ego.speed, 0.0)
    return np.asarray(np.maximum(speed - braking * times + late, min(speed, SLOWEST)))


def meetings(perception: Perception, forecast: Forecast, braking: float = 0.0) -> Meetings:
    """Return the predicted conflict points.

    A conflict point already passed is extrapolated backwards at the pedestrian's present velocity.

    Parameters
    ----------
    perception : what the ego knows
    forecast : where the pedestrians will be, at ``FORECAST_TIMES``
    braking : deceleration of the ego; the paper keeps its speed constant [m/s^2]
    """
    people, ego = perception.pedestrians, perception.ego
    speed, middle = max(ego.speed, SLOWEST), _middle(perception)
    way = speed * forecast.times
    if braking > 0.0:
        speeds = braked_speeds(ego, braking, forecast.times)
        steps = 0.5 * np.diff(forecast.times) * (speeds[:-1] + speeds[1:])
        way = np.concatenate([[0.0], np.cumsum(steps)])
    ahead = forecast.along - way - middle
    passed = ahead <= 0.0
    each, first = np.arange(len(people)), np.argmax(passed, axis=1)
    last = np.maximum(first - 1, 0)
    # Between the last sample ahead and the first one behind, both move uniformly.
    share = ahead[each, last] / np.maximum(ahead[each, last] - ahead[each, first], 1e-9)

    def level(values: FloatArray) -> FloatArray:
        moved = values[each, first] - values[each, last]
        return np.asarray(values[each, last] + np.where(first > 0, share, 0.0) * moved)

    ago = meeting_time(people.along, people.along_speed, middle, speed)
    behind = passed[:, 0]
    back = np.where(behind, np.where(ago <= 0.0, ago, -np.inf), 0.0)
    recent = back > -LONG_BEHIND
    back = np.maximum(back, -LONG_BEHIND)
    return Meetings(
        level(forecast.along) + people.along_speed * back,
        level(forecast.across) + people.across_speed * back,
        people.radius + level(forecast.reach),
        passed.any(axis=1) & recent,
    )


def obstacles_on(
    perception: Perception, met: Meetings, centres: FloatArray, settings: FieldSettings
) -> Obstacles:
    """Return the obstacles for an ego in lanes with given centre lines, shape (m, n).

    Parameters
    ----------
    perception, met : what the ego knows, and where it meets the pedestrians
    centres : across coordinates of the centre lines, shape (m,) [m]
    settings : parameters of the field
    """
    ego = perception.ego
    speed = max(ego.speed, SLOWEST)
    safe = np.array([side_distance(float(r), ego.body.width, settings.margin) for r in met.radius])
    shift = needed_shift(met.across, centres[:, None], safe)
    long_axis = distance_to_shift(speed, shift, settings.lateral_acceleration)
    if settings.fixed_axis is not None:
        long_axis = np.where(shift > 0.0, settings.fixed_axis, 0.0)
    ahead = met.along - _middle(perception)
    matters = met.matters & (long_axis >= SHORTEST_AXIS)
    beside = _vehicles_beside(perception, centres, settings)
    rows = (len(centres), len(met.along))
    still = np.zeros(rows)
    return Obstacles(
        np.hstack([np.broadcast_to(ahead, rows), beside.along]),
        np.hstack([np.broadcast_to(met.across, rows), beside.across]),
        np.hstack([np.maximum(long_axis, SHORTEST_AXIS), beside.long_axis]),
        np.hstack([np.broadcast_to(safe, rows), beside.side_axis]),
        np.hstack([still, beside.along_speed]),
        np.hstack([still, beside.across_speed]),
        np.hstack([matters.astype(np.float64), beside.share]),
    )


def field_of(
    perception: Perception, centres: FloatArray, obstacles: Obstacles, settings: FieldSettings
) -> Field:
    """Return the fields of lanes with given centre lines, shape (m,), on the ego's road."""
    road = perception.road
    edges = {road.right_edge, road.left_edge}
    sides = [lane.offset + half * lane.width for lane in road.lanes for half in (-0.5, 0.5)]
    lines = sorted({round(side, 3) for side in sides if min(abs(side - edge) for edge in edges) > 0.5})
    return Field(
        road.right_edge, road.left_edge, centres, _merged(np.array(lines)), obstacles, settings.gains
    )


def _vehicles_beside(perception: Perception, centres: FloatArray, settings: FieldSettings) -> Obstacles:
    """Return the vehicles beside each lane; the ego follows those in the lane and does not go round them."""
    vehicles, ego = perception.vehicles, perception.ego
    turned_length = vehicles.length * np.abs(np.cos(vehicles.heading_error))
    middle = vehicles.along - 0.5 * vehicles.length * np.cos(vehicles.heading_error)
    apart = 0.5 * (vehicles.width + ego.body.width)
    beside = np.abs(vehicles.across - centres[:, None]) > apart
    near = np.abs(middle) < VEHICLE_RANGE
    closed = VEHICLE_TIME * np.abs(ego.speed - vehicles.along_speed)
    rows = (len(centres), len(vehicles))

    def everywhere(values: FloatArray) -> FloatArray:
        return np.broadcast_to(values, rows)

    return Obstacles(
        everywhere(middle - _middle(perception)),
        everywhere(vehicles.across),
        everywhere(0.5 * (turned_length + ego.body.length) + closed),
        everywhere(VEHICLE_SIDE * (apart + settings.margin)),
        everywhere(vehicles.along_speed),
        everywhere(vehicles.across_speed),
        (beside & near).astype(np.float64),
    )


def _middle(perception: Perception) -> float:
    """Return how far the middle of the body is ahead of the rear axle [m]."""
    body = perception.ego.body
    return body.front - 0.5 * body.length


def _merged(lines: FloatArray) -> FloatArray:
    """Return the lines, with the border that two lanes share only once."""
    return lines[np.diff(lines, prepend=-np.inf) > 0.5]
