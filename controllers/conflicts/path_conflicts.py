"""Pedestrians in conflict with the ego's path, ordered by the time at which they enter it.

A pedestrian is in conflict while their disc, grown by the side margin, overlaps the band that the ego's body
sweeps.
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
"""Without a forecast, pedestrians are expected to keep their speed along the road for this long [s]."""
SQUEEZED = 0.03
"""Pedestrians who let the waiting ego go first are in its way if nearer than this to what the body sweeps
[m]."""


@dataclass(frozen=True, slots=True)
class Conflicts:
    """Pedestrians in conflict with the ego's path, ordered by time of entry; arrays of length n."""

    names: tuple[str, ...]
    index: IntArray
    """Position in ``Perception.pedestrians``."""
    along: FloatArray
    along_speed: FloatArray
    across: FloatArray
    across_speed: FloatArray
    """Assumed velocity across the path, or with a forecast the velocity at entry; its sign is the direction
    in which the pedestrian walks [m/s]."""
    radius: FloatArray
    enter: FloatArray
    """Time until the overlap begins; 0 while it lasts [s]."""
    leave: FloatArray
    """Time until the overlap ends; inf for pedestrians who stay, and for those who stand at a crossing and
    are only assumed to set off [s]."""
    stop_line: FloatArray
    """Place where the front bumper should stop if the ego yields; inf without a crossing [m]."""
    forecast: Forecast | None = None
    """Forecast of these pedestrians; ``None`` when they keep their velocities."""

    def __len__(self) -> int:
        return len(self.names)

    def only(self, chosen: IntArray) -> Conflicts:
        """Return the conflicts with the given indices."""
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
        """Return the places of the pedestrians along the road, shape (n, N) [m]."""
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
        Right and left end of the band that the ego's body sweeps (across), for all pedestrians or for each
        of them [m].
    side_margin
        Margin added to the disc on both sides [m].
    horizon
        [s].
    assume
        See :class:`PedestrianAssumptions`.
    forecast
        Forecast of all pedestrians, from now to at least the horizon; ``None``: they keep their velocities.
        Assumptions about pedestrians whose velocity does not tell what they will do take precedence over it.
    abreast
        Whether pedestrians beside the body are in conflict too.
    clearance
        How near the true body comes to those who are not expected to enter, shape (n,); ``None``: their
        distance to the band decides [m].
    expectation
        What is expected of all pedestrians, if known already; ``None``: it is computed here.
    """
    people, body = perception.pedestrians, perception.ego.body
    if not len(people):
        return _empty()
    known = expectation or expected(perception, watch, assume, forecast)
    if forecast is not None:
        forecast = _with_assumptions(forecast, people, known)
    across_speed, enter, leave = _times_in_band(people, known, band, side_margin, forecast, clearance)
    # Those who stand at a crossing may set off at any time, and so leave at any time: nothing can be planned
    # for after them. Those who stop in the road elsewhere are expected to walk on, and so to leave.
    leave = np.where(known.assumed & known.stands & (people.crossing >= 0), np.inf, leave)
    # Pedestrians behind the rear bumper cannot be hit by driving on, however fast they come. As conflicts
    # they would come first, and the ego could let nobody ahead pass without letting them pass as well.
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
    """Return how fast pedestrians cross the path, and when they enter and leave the band, shape (n,) each.

    The arguments are those of :func:`find`; assumptions are already included in the forecast.
    """
    # Occupancy comes before intent: pedestrians who are not expected to enter still count at the place where
    # they are.
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
    """Return the forecast with straight lines for pedestrians whose movement is assumed."""
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
