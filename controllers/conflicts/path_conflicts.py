"""Which pedestrians the ego's path conflicts with, and in which order they can be passed.

A pedestrian conflicts while the disc, grown by the side margin, overlaps the band the ego's body sweeps.
Sorted by the time at which that overlap begins, only n + 1 orders make sense: the ego lets the first j
pass (it goes *behind* them) and goes *ahead* of the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.conflicts.expected_behaviour import (
    OCCUPIED,
    Expectation,
    PedestrianAssumptions,
    Watch,
    expected,
)
from controllers.interface import Pedestrians, Perception
from controllers.prediction.forecast import Forecast
from controllers.velocity_obstacle.mpc.arithmetic import class_bounds as passing_classes

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

STRAIGHT_ON = 3.0
"""How long somebody is expected to keep the speed along the road, where no forecast says more [s]."""
SQUEEZED = 0.03
"""The same for somebody who has let the waiting ego go first [m]."""


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
    people = perception.pedestrians
    road = perception.road
    n = len(people)
    if n == 0:
        return _empty()
    known = expectation or expected(perception, watch, assume, forecast)
    across_speed, enters, assumed, lets_go, _ = known
    # Occupancy comes before intent: for pedestrians who are not expected to enter, only the intent is
    # dropped; the place where they are still counts.
    occupied = np.where(lets_go, SQUEEZED, OCCUPIED)
    margin = np.where(enters, side_margin, occupied)
    low = band[0] - people.radius - margin
    high = band[1] + people.radius + margin
    if forecast is None:
        enter, leave = passing_classes.overlap(people.across, across_speed, low, high)
    else:
        forecast = _with_assumptions(forecast, people, across_speed, assumed | ~enters)
        enter, leave = _sampled_overlap(forecast, low, high)
        across_speed = _speed_at(forecast, enter)
    if clearance is not None:
        enter = np.where(enters, enter, np.where(clearance < occupied, 0.0, np.inf))
        leave = np.where(enters, leave, np.inf)
    body = perception.ego.body
    # Pedestrians behind the rear bumper cannot be hit by driving on, however fast they come. As conflicts
    # they would be first in the order, and nobody ahead could be let pass without letting them pass as well.
    begin = -body.rear_overhang - 0.5 if abreast else body.front
    chosen = passing_classes.by_entry(people.along + people.radius, enter, horizon, begin)
    if not len(chosen):
        return _empty()
    stop = [road.crossings[c].stop_line if c >= 0 else np.inf for c in people.crossing[chosen].tolist()]
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


def _with_assumptions(
    forecast: Forecast, people: Pedestrians, across_speed: FloatArray, assumed: NDArray[np.bool_]
) -> Forecast:
    """Return the forecast with straight lines for those of whom something is assumed."""
    times, who = forecast.times, assumed[:, None]
    straight = people.along[:, None] + people.along_speed[:, None] * np.minimum(times, STRAIGHT_ON)
    beside = people.across[:, None] + across_speed[:, None] * times
    return Forecast(
        times,
        np.where(who, straight, forecast.along),
        np.where(who, beside, forecast.across),
        np.where(who, 0.0, forecast.reach),
    )


def _sampled_overlap(forecast: Forecast, low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return when forecasts first enter [low, high] and when they have left for good; inf for never."""
    times = forecast.times
    outside = np.maximum(low[:, None] - forecast.across, forecast.across - high[:, None]) - forecast.reach
    inside = outside <= 0.0
    each = np.arange(len(inside))
    first = np.argmax(inside, axis=1)
    after_last = inside.shape[1] - np.argmax(inside[:, ::-1], axis=1)

    def border(index: IntArray) -> FloatArray:
        """Return when the border is crossed within the interval that ends with a sample."""
        ends = np.clip(index, 1, len(times) - 1)
        before, after = outside[each, ends - 1], outside[each, ends]
        change = np.where(before == after, 1.0, before - after)
        share = np.clip(before / change, 0.0, 1.0)
        return np.asarray(times[ends - 1] + share * (times[ends] - times[ends - 1]))

    somewhere = inside.any(axis=1)
    enter = np.where(first == 0, times[0], border(first))
    leave = np.where(after_last == len(times), np.inf, border(after_last))
    return np.where(somewhere, enter, np.inf), np.where(somewhere, leave, np.inf)


def _speed_at(forecast: Forecast, times: FloatArray) -> FloatArray:
    """Return the speed across at one time for each, that of the last known one beyond it [m/s]."""
    known = np.searchsorted(forecast.times, times, side="right")
    interval = np.clip(known, 1, len(forecast.times) - 1)
    each = np.arange(len(times))
    moved = forecast.across[each, interval] - forecast.across[each, interval - 1]
    return np.asarray(moved / (forecast.times[interval] - forecast.times[interval - 1]))


@cache
def _empty() -> Conflicts:
    none = np.zeros(0)
    return Conflicts((), np.zeros(0, dtype=np.int64), none, none, none, none, none, none, none, none)


def class_name(conflicts: Conflicts, behind: int) -> str:
    """Return who is let pass and who is not: ``behind=p1|p2 ahead=p3``; empty without conflicts."""
    if not len(conflicts):
        return ""
    return f"behind={'|'.join(conflicts.names[:behind])} ahead={'|'.join(conflicts.names[behind:])}"


def stops(
    conflicts: Conflicts, behind: int, front: float, margin_along: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return where those are who are let pass, where the front bumper stops, and how long [m, m, s].

    Parameters
    ----------
    conflicts, behind
        By time of entry, and how many of them are let pass.
    front
        From the rear axle to the front bumper [m].
    margin_along
        [m].
    """
    c = conflicts
    before = c.along[:behind] - c.radius[:behind] - margin_along
    line = c.stop_line[:behind]
    # Once the bumper is past the stop line only the pedestrian counts.
    places = np.where(front <= line + 0.3, np.minimum(before, np.maximum(line, front)), before)
    return c.along[:behind], places, c.leave[:behind]


class ClassBounds(NamedTuple):
    """What each passing class asks of the rear axle's position, shape (n + 1, N) each.

    Row j is the class that lets the first j pass. Every half-plane of this formulation bounds the position
    alone, so per time only the tightest one matters: the program does not grow with the number of
    pedestrians, and nothing is lost.
    """

    upper: FloatArray
    """Largest position while somebody who is let pass has not left; inf where free [m]."""
    lower: FloatArray
    """Least position once somebody who is passed ahead of enters; −inf where free [m]."""
    freeze: FloatArray
    """As ``upper``, but only while somebody is expected in the band: where the ego must still be able to
    stop should they stop walking [m]."""


def class_bounds(
    conflicts: Conflicts,
    times: FloatArray,
    front: float,
    rear: float,
    margin_along: float,
    speed: FloatArray,
) -> ClassBounds:
    """Return the bounds of all passing classes.

    Parameters
    ----------
    conflicts
        By time of entry.
    times
        Horizon, shape (N,) [s].
    front, rear
        From the rear axle to the front bumper, and to the rear bumper (positive) [m].
    margin_along
        [m].
    speed
        Expected speed at each time: carries a bound from the instant it holds to the next grid time,
        shape (N,) [m/s].
    """
    c = conflicts
    reach = c.radius + margin_along
    if c.forecast is None:
        bounds = passing_classes.straight_class_bounds(
            c.enter,
            c.leave,
            c.stop_line,
            c.along,
            c.along_speed,
            STRAIGHT_ON,
            reach,
            times,
            speed,
            front,
            rear,
        )
    else:
        there = c.forecast.at(times)
        kept = reach[:, None] + there.reach
        bounds = passing_classes.class_bounds(
            c.enter, c.leave, c.stop_line, there.along, kept, times, speed, front, rear
        )
    return ClassBounds(*bounds)
