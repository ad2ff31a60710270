"""Where pedestrians will be, as discs in a plane, to be compared with the true body of a car."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.geometry.plane import people_in_plane, to_plane
from controllers.interface import Perception
from controllers.prediction.forecast import Forecast


class Discs(NamedTuple):
    """Pedestrians in the plane of :mod:`controllers.geometry.plane`; n of them at K instants."""

    x: FloatArray
    """Shape (n, K) [m]."""
    y: FloatArray
    radius: FloatArray
    """Radius of the disc plus the uncertainty of its place, shape (n, K) [m]."""


def discs(
    perception: Perception,
    who: NDArray[np.intp],
    walks: NDArray[np.bool_],
    forecast: Forecast | None,
    times: FloatArray,
    walk_on: float = 0.0,
    across_speed: FloatArray | None = None,
) -> Discs:
    """Return where some of the pedestrians will be.

    Parameters
    ----------
    perception
        What the ego is told.
    who
        Which pedestrians, by index, shape (n,).
    walks
        Which of all pedestrians walk on; the others come to a stop.
    forecast
        Where walking pedestrians go; ``None``: they keep their velocities.
    times
        Instants from now, shape (K,) [s].
    walk_on
        Time after which the others stand [s]. Those who are at no crossing go on along the road: only their
        movement across it ends.
    across_speed
        For all pedestrians, the speed straight across the road where it is known better than from their
        velocity; nan for others [m/s].
    """
    people = perception.pedestrians
    places, velocities = people_in_plane(perception.ego, perception.road, people)
    _, heading = to_plane(perception.road, people.along, people.across)
    if across_speed is not None:
        across = across_speed[:, None] * np.column_stack((-np.sin(heading), np.cos(heading)))
        velocities = np.where(np.isnan(across), velocities, across)
    ahead = np.column_stack((np.cos(heading), np.sin(heading)))
    kept = np.where(people.crossing < 0, (velocities * ahead).sum(axis=1), 0.0)[:, None] * ahead
    stopped = np.minimum(times, walk_on)
    on = (velocities - kept)[who, :, None] * stopped + kept[who, :, None] * times
    gone = velocities[who, :, None] * times
    reach = np.zeros((len(who), len(times)))
    if forecast is not None:
        # The way from here according to the forecast, in the frame of the road at each pedestrian.
        there, here = forecast.at(times), forecast.at(np.zeros(1))
        along, across = (there.along - here.along)[who], (there.across - here.across)[who]
        cosine, sine = ahead[who, :1], ahead[who, 1:]
        foreseen = np.stack((along * cosine - across * sine, along * sine + across * cosine), axis=1)
        known = np.zeros(len(who), np.bool_) if across_speed is None else np.isfinite(across_speed[who])
        gone = np.where(known[:, None, None], gone, foreseen)
        reach = np.where(known[:, None], reach, there.reach[who])
    moves = walks[who, None]
    return Discs(
        places[who, :1] + np.where(moves, gone[:, 0], on[:, 0]),
        places[who, 1:] + np.where(moves, gone[:, 1], on[:, 1]),
        people.radius[who, None] + np.where(moves, reach, 0.0),
    )
