"""Which pedestrians the ego's path conflicts with, by the time at which they enter it.

A pedestrian conflicts while the disc, grown by the side margin, overlaps the band the ego's body sweeps.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from controllers.arrays import FloatArray, IntArray
from controllers.conflicts.band_overlap import sampled_overlap, speed_across, straight_overlap
from controllers.conflicts.expected_behaviour import (
    OCCUPIED,
    Expectation,
    PedestrianAssumptions,
    Watch,
    expected,
)
from controllers.interface import Pedestrians, Perception
from controllers.prediction.forecast import Forecast

STRAIGHT_ON = 3.0
"""How long somebody is expected to keep the speed along the road, where no forecast says more [s]."""
SQUEEZED = 0.03
"""Nearer than this to what the body sweeps, those who let the waiting ego go first are in its way [m]."""


@dataclass(frozen=True, slots=True)
class Conflicts:
    """Pedestrians in conflict with the ego's path, by time of entry; arrays of length n."""

    names: tuple[str, ...]
    index: IntArray
    """Position in ``Perception.pedestrians``."""
    along: FloatArray
    along_speed: FloatArray
    across: FloatArray
    across_speed: FloatArray
    """Assumed velocity across the path, with a forecast the one at entry; its sign says which way the
    pedestrian walks [m/s]."""
    radius: FloatArray
    enter: FloatArray
    """Time until the overlap begins; 0 while it lasts [s]."""
    leave: FloatArray
    """Time until it ends; inf for somebody who stays [s]."""
    stop_line: FloatArray
    """Where a front bumper that yields should stop; inf without a crossing [m]."""
    forecast: Forecast | None = None
    """Of these pedestrians; ``None`` when they keep their velocities."""

    def __len__(self) -> int:
        return len(self.names)

    def only(self, chosen: IntArray) -> Conflicts:
        """Return some of the conflicts, by index."""
        return Conflicts(
            tuple(self.names[i] for i in chosen),
            self.index[chosen],
            self.along[chosen],
            self.along_speed[chosen],
            self.across[chosen],
            self.across_speed[chosen],
            self.radius[chosen],
            self.enter[chosen],
            self.leave[chosen],
            self.stop_line[chosen],
            None if self.forecast is None else self.forecast.only(chosen),
        )

    def along_at(self, times: FloatArray) -> FloatArray:
        """Return the places along the road, shape (n, N) [m]."""
        if self.forecast is not None:
            return self.forecast.at(times).along
        return self.along[:, None] + self.along_speed[:, None] * np.minimum(times, STRAIGHT_ON)


def find(
    perception: Perception,
    watch: Watch,
    band: tuple[float | FloatArray, float | FloatArray],
    side_margin: float,
    horizon: float,
    assume: PedestrianAssumptions,
    forecast: Forecast | None = None,
    abreast: bool = True,
    clearance: FloatArray | None = None,
    expectation: Expectation | None = None,
) -> Conflicts:
    """Return the pedestrians who will be in the band within the horizon.

    Parameters
    ----------
    perception
        What the ego is told.
    watch
        What is remembered of the pedestrians; updated here.
    band
        Right and left end of what the ego's body sweeps (across), for all or for each of them [m].
    side_margin
        Added to the disc on both sides [m].
    horizon
        [s].
    assume
        See :class:`PedestrianAssumptions`.
    forecast
        Of all pedestrians, from now to at least the horizon; ``None``: they keep their velocities. What is
        assumed of pedestrians whose velocity does not say what they will do takes precedence over it.
    abreast
        Whether those beside the body are in conflict too.
    clearance
        How near the true body comes to those who are not expected to enter, shape (n,); ``None``: their
        distance to the band decides [m].
    expectation
        Of everybody, where it is known already; ``None``: it is worked out.
    """
    people, body = perception.pedestrians, perception.ego.body
    if not len(people):
        return _empty()
    known = expectation or expected(perception, watch, assume, forecast)
    if forecast is not None:
        forecast = _with_assumptions(forecast, people, known)
    across_speed, enter, leave = _times_in_band(people, known, band, side_margin, forecast, clearance)
    # Pedestrians behind the rear bumper cannot be hit by driving on, however fast they come. As conflicts
    # they would be first in the order, and nobody ahead could be let pass without letting them pass as well.
    begin = -body.rear_overhang - 0.5 if abreast else body.front
    chosen = np.flatnonzero((enter < horizon) & (people.along + people.radius >= begin))
    if not len(chosen):
        return _empty()
    chosen = chosen[np.argsort(enter[chosen], kind="mergesort")]
    crossings = perception.road.crossings
    stop = [crossings[c].stop_line if c >= 0 else np.inf for c in people.crossing[chosen].tolist()]
    return Conflicts(
        tuple(people.names[i] for i in chosen.tolist()),
        chosen,
        people.along[chosen],
        people.along_speed[chosen],
        people.across[chosen],
        across_speed[chosen],
        people.radius[chosen],
        enter[chosen],
        leave[chosen],
        np.array(stop),
        None if forecast is None else forecast.only(chosen),
    )


def _times_in_band(
    people: Pedestrians,
    known: Expectation,
    band: tuple[float | FloatArray, float | FloatArray],
    side_margin: float,
    forecast: Forecast | None,
    clearance: FloatArray | None,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return how fast everybody crosses the path, and when they enter and leave the band, shape (n,) each.

    The arguments are those of :func:`find`, the forecast the one with assumptions.
    """
    # Occupancy comes before intent: for pedestrians who are not expected to enter, only the intent is
    # dropped; the place where they are still counts.
    occupied = np.where(known.lets_go, SQUEEZED, OCCUPIED)
    margin = np.where(known.enters, side_margin, occupied)
    low = band[0] - people.radius - margin
    high = band[1] + people.radius + margin
    if forecast is None:
        across_speed = known.across_speed
        enter, leave = straight_overlap(people.across, across_speed, low, high)
    else:
        enter, leave = sampled_overlap(forecast, low, high)
        across_speed = speed_across(forecast, enter)
    if clearance is not None:
        enter = np.where(known.enters, enter, np.where(clearance < occupied, 0.0, np.inf))
        leave = np.where(known.enters, leave, np.inf)
    return across_speed, enter, leave


def _with_assumptions(forecast: Forecast, people: Pedestrians, known: Expectation) -> Forecast:
    """Return the forecast with straight lines for those of whom something is assumed."""
    times, who = forecast.times, (known.assumed | ~known.enters)[:, None]
    straight = people.along[:, None] + people.along_speed[:, None] * np.minimum(times, STRAIGHT_ON)
    beside = people.across[:, None] + known.across_speed[:, None] * times
    return Forecast(
        times,
        np.where(who, straight, forecast.along),
        np.where(who, beside, forecast.across),
        np.where(who, 0.0, forecast.reach),
    )


@cache
def _empty() -> Conflicts:
    none = np.zeros(0)
    return Conflicts((), np.zeros(0, dtype=np.int64), none, none, none, none, none, none, none, none)
