"""Which pedestrians the ego's path conflicts with, and in which order they can be passed.

A pedestrian conflicts while the disc, grown by the side margin, overlaps the band the ego's body sweeps.
Sorted by the time at which that overlap begins, only n + 1 orders make sense: the ego lets the first j
pass (it goes *behind* them) and goes *ahead* of the rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.interface import CrossingKind, Pedestrians, Perception
from controllers.numerics import passing_classes
from controllers.prediction.forecast import Forecast

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

STRAIGHT_ON = 3.0
"""How long somebody is expected to keep the speed along the road, where no forecast says more [s]."""
THERE = 0.3
"""Nearer than this to where his crossing begins somebody goes on as he goes until he stands [m]."""
KERB = 0.5
"""Nearer to the road than this counts as on it [m]."""
OCCUPIED = 0.15
"""Whoever is nearer than this to what the body sweeps is in its way, whatever he is expected to do [m]."""
SQUEEZED = 0.03
"""The same for somebody who has let the waiting ego go first [m]."""


@dataclass(frozen=True, slots=True)
class PedestrianAssumptions:
    """What is assumed of pedestrians whose velocity does not say what they will do."""

    resume_speed: float = 1.2
    """Speed at which somebody who stands on a crossing may walk on [m/s]."""
    standing_below: float = 0.2
    """Slower than this is standing [m/s]."""
    yield_to_standing: bool = True
    """Whether somebody who stands at the kerb of a zebra is expected to step out."""
    patience: float = 3.0
    """Somebody who has stood this long while the ego waited is taken to let it go first [s]."""
    careful_speed: float = 5.0
    """With which the ego passes somebody who lets it go [m/s]."""
    waiting_below: float = 0.5
    """A slower ego waits [m/s]."""
    waiting_within: float = 15.0
    """For people so far ahead of its rear axle [m]."""


@dataclass(slots=True)
class Watch:
    """What is remembered of each pedestrian, by name."""

    heading: dict[str, float] = field(default_factory=dict)
    """Sign of the last clear movement across the path."""
    waited: dict[str, float] = field(default_factory=dict)
    """How long both have stood [s]."""
    seen: float = -np.inf
    """When it was looked at last [s]."""
    longest_wait: float = 0.0
    """Of all [s]."""

    def look(self, perception: Perception, assume: PedestrianAssumptions) -> None:
        """Bring it up to date; looking twice at the same instant changes nothing."""
        ego, people = perception.ego, perception.pedestrians
        passed = min(ego.time - self.seen, 1.0)
        self.seen = ego.time
        waited: dict[str, float] = {}
        movements = zip(
            people.names,
            people.along.tolist(),
            people.along_speed.tolist(),
            people.across_speed.tolist(),
            strict=True,
        )
        for name, at, along, across in movements:
            if abs(across) > assume.standing_below:
                self.heading[name] = math.copysign(1.0, across)
            if math.hypot(along, across) <= assume.standing_below:
                before = ego.speed < assume.waiting_below and at < assume.waiting_within
                waits = passed if before else 0.0
                waited[name] = self.waited.get(name, 0.0) + waits
        self.waited = waited
        self.longest_wait = max(waited.values(), default=0.0)

    def carefully_past(self, perception: Perception, assume: PedestrianAssumptions) -> FloatArray:
        """Return the along coordinates of those who let the ego go: it should not race past them [m]."""
        people = perception.pedestrians
        if self.longest_wait < assume.patience:
            return np.empty(0)
        at = [
            float(people.along[i])
            for i, name in enumerate(people.names)
            if self.lets_go_first(name, assume) and (people.on_crossing[i] or people.waiting[i])
        ]
        return np.array(at, dtype=np.float64)

    def lets_go_first(self, name: str, assume: PedestrianAssumptions) -> bool:
        """Return whether somebody has stood so long before a waiting ego that it may go."""
        return self.waited.get(name, 0.0) >= assume.patience


class Expectation(NamedTuple):
    """What is expected of everybody in a perception, arrays of length n."""

    across_speed: FloatArray
    """Across the path; 0 for those who are not expected to enter it [m/s]."""
    enters: NDArray[np.bool_]
    """Who may come into the way who is not there yet; the others count where they are."""
    assumed: NDArray[np.bool_]
    """Whose speed is assumed, because their movement does not say what they will do."""
    lets_go: NDArray[np.bool_]
    """Who has stood so long before the waiting ego that it may go first."""
    comes: FloatArray
    """Across speed of those who walk to where their crossing begins, in the lane or through it, and of those
    who stand on a crossing and will walk on; nan for others [m/s]."""


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
        assumed of somebody whose velocity does not say what he will do goes before it.
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
    # Occupancy comes before intent: of somebody who is not expected to enter, only that is dropped. Where he
    # is he counts.
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
    # Whoever is behind the rear bumper cannot be hit by driving on, however fast he comes. As a conflict he
    # would be first in the order and nobody ahead could be let pass without letting him pass as well.
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


def expected(
    perception: Perception, watch: Watch, assume: PedestrianAssumptions, forecast: Forecast | None
) -> Expectation:
    """Return what is expected of everybody; the arguments are those of :func:`find`."""
    watch.look(perception, assume)
    people = perception.pedestrians
    road = perception.road
    speed = people.across_speed.tolist()
    along_speed, across = people.along_speed.tolist(), people.across.tolist()
    waiting, on_crossing = people.waiting.tolist(), people.on_crossing.tolist()
    radius = people.radius.tolist()
    lets_go = [watch.lets_go_first(name, assume) for name in people.names]
    considered, assumed = [True] * len(people), [False] * len(people)
    comes = np.full(len(people), np.nan)
    for i, (name, at) in enumerate(zip(people.names, people.crossing.tolist(), strict=True)):
        crossing = road.crossings[at] if at >= 0 else None
        if on_crossing[i]:
            # On the crossing itself whoever lets the ego go first may go on: the whole margin is kept.
            if abs(speed[i]) < assume.standing_below and name in watch.heading and not lets_go[i]:
                speed[i] = comes[i] = watch.heading[name] * assume.resume_speed
                assumed[i] = True
        elif lets_go[i]:
            considered[i] = False
        elif waiting[i] and crossing is not None:
            has_priority = crossing.kind is CrossingKind.ZEBRA or bool(crossing.pedestrians_have_green)
            pace = math.hypot(along_speed[i], speed[i])
            stands = pace < assume.standing_below
            if not has_priority or (stands and not assume.yield_to_standing):
                place = crossing.right if 2.0 * across[i] < crossing.right + crossing.left else crossing.left
                way = place - across[i]
                reach = 0.5 * perception.ego.body.width + radius[i] + OCCUPIED
                beyond = min(across[i], place) > reach or max(across[i], place) < -reach
                if stands or beyond:
                    considered[i] = False
                else:
                    # He waits about where his crossing begins: in the ego's lane, or on its other side.
                    towards = way if abs(way) > THERE else speed[i]
                    speed[i] = comes[i] = math.copysign(max(pace, assume.resume_speed), towards)
                    assumed[i] = True
            else:
                # On the waiting area people still walk along the kerb: count on them to turn and cross.
                speed[i] = math.copysign(max(pace, assume.resume_speed), -across[i])
                assumed[i] = True
        else:
            outside = across[i] > road.left_edge + KERB or across[i] < road.right_edge - KERB
            if abs(speed[i]) < (0.5 if outside else assume.standing_below):
                # Who stands on the road on his way across goes on; who never walked across it stays there.
                considered[i] = not outside and name in watch.heading
    enters = np.array(considered, dtype=np.bool_)
    if forecast is not None:
        on_road = (forecast.across > road.right_edge - KERB) & (forecast.across < road.left_edge + KERB)
        turns = np.ptp(forecast.across, axis=1) > assume.standing_below * (
            forecast.times[-1] - forecast.times[0]
        )
        enters |= on_road.any(axis=1) & (turns | ~on_road[:, 0]) & (people.crossing < 0)
    return Expectation(
        np.where(enters, speed, 0.0),
        enters,
        np.array(assumed, dtype=np.bool_),
        np.array(lets_go, dtype=np.bool_),
        comes,
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
