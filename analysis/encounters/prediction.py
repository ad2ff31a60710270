"""Predicted times of ego and pedestrian in their conflict area if both keep their velocity.

At each sample, the ego's *strip* is the body's width straight ahead. The pedestrian is in the area while
their disc touches the strip; the ego is in it while the body touches the piece of the strip that the disc
sweeps. All times are counted from the sample; they are nan if the pedestrian is not in the strip then or
later.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.arrays import BoolArray, FloatArray
from analysis.encounters.samples import Samples


@dataclass(frozen=True, slots=True)
class PredictedArea:
    """Entry and exit of both, at constant velocity."""

    person_in: FloatArray
    """−inf for pedestrians in the strip who do not move across it, negative for others already inside [s]."""
    person_out: FloatArray
    """inf for pedestrians in the strip who do not move across it [s]."""
    distance_in: FloatArray
    """From the front bumper to the area; negative once inside [m]."""
    distance_out: FloatArray
    """From the rear bumper to the far end of the area; negative once past [m]."""
    ego_in: FloatArray
    """inf for a standing ego before the area [s]."""
    ego_out: FloatArray
    longitudinal: BoolArray
    """Whether the pedestrian moves along the strip rather than across it."""


def predict_area(samples: Samples, longitudinal_angle_deg: float) -> PredictedArea:
    """Return the predicted times for every sample."""
    reach = samples.half_width + samples.radius
    w = samples.y_speed
    walks = w != 0.0
    safe = np.where(walks, w, 1.0)
    one, two = (-reach - samples.y) / safe, (reach - samples.y) / safe
    inside = np.abs(samples.y) <= reach
    person_in = np.where(walks, np.minimum(one, two), np.where(inside, -np.inf, np.nan))
    person_out = np.where(walks, np.maximum(one, two), np.where(inside, np.inf, np.nan))
    gone = person_out < 0.0
    person_in = np.where(gone, np.nan, person_in)
    person_out = np.where(gone, np.nan, person_out)

    from_x = samples.x + samples.x_speed * np.maximum(np.nan_to_num(person_in, neginf=0.0), 0.0)
    stay = np.isinf(person_out)
    to_x = samples.x + np.where(stay, 0.0, samples.x_speed * np.nan_to_num(person_out, posinf=0.0))
    low = np.minimum(from_x, to_x) - samples.radius
    high = np.maximum(from_x, to_x) + samples.radius
    known = ~np.isnan(person_in)
    distance_in = np.where(known, low - samples.half_length, np.nan)
    distance_out = np.where(known, high + samples.half_length, np.nan)
    driving = samples.ego_speed > 0.0
    speed = np.where(driving, samples.ego_speed, 1.0)
    ego_in = np.where(driving, distance_in / speed, np.where(distance_in > 0.0, np.inf, -np.inf))
    ego_out = np.where(driving, distance_out / speed, np.where(distance_out >= 0.0, np.inf, -np.inf))
    across = np.abs(w) / np.where(samples.person_speed > 0.0, samples.person_speed, 1.0)
    return PredictedArea(
        person_in=person_in,
        person_out=person_out,
        distance_in=distance_in,
        distance_out=distance_out,
        ego_in=np.where(known, ego_in, np.nan),
        ego_out=np.where(known, ego_out, np.nan),
        longitudinal=(samples.person_speed > 0.0) & (across < np.sin(np.radians(longitudinal_angle_deg))),
    )


def required_deceleration(speed: FloatArray, distance: FloatArray, time: FloatArray) -> FloatArray:
    """Return the smallest constant deceleration with which the ego is not in an area before ``time``.

    It is 0 for ``d >= v T``; ``2 (v − d/T) / T`` down to ``d = v T / 2``; ``v^2 / (2 d)`` below, where the
    ego has to stop before the area; inf for d <= 0 with T > 0 and v > 0.

    Parameters
    ----------
    speed, distance, time : FloatArray
        v [m/s], distance d to the area [m], time T until the pedestrian has left it [s].

    Examples
    --------
    >>> required_deceleration(np.array([10.0]), np.array([30.0]), np.array([4.0])).tolist()
    [1.25]
    """
    v, d, t = np.broadcast_arrays(speed, distance, time)
    free = (t <= 0.0) | (v <= 0.0) | (d >= v * t)
    ahead = (d > 0.0) & ~free
    passing = ahead & (2.0 * d >= v * t)
    finite = np.where(passing, t, 1.0)
    by_time = 2.0 * (v - d / finite) / finite
    by_stop = v * v / (2.0 * np.where(ahead, d, 1.0))
    return np.where(free, 0.0, np.where(passing, by_time, np.where(ahead, by_stop, np.inf)))
