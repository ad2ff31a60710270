"""Where to stop: at traffic lights, at stop signs, and for vehicles with crossing paths that go first."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.driving.standing import StoodSince
from controllers.interface import EgoState, JunctionFoe, Perception, RoadAhead, Signal, SignalState

AMBER_DECELERATION = 3.0
"""The ego stops at an amber light if this deceleration is enough [m/s^2]."""
HARD_SHARE = 0.75
"""Share of the greatest deceleration that a stop at a red light, for a sign or for a foe may need."""
OVERSHOOT = 1.0
"""The ego still stops at a line if it overruns it by no more than this [m]."""
CONFLICT_GAP = 1.0
"""Distance kept to a conflict when the ego has already passed its stop line [m]."""
TIME_MARGIN = 1.0
"""Time between one vehicle leaving a conflict and the other entering it [s]."""
FOE_ACCELERATION, REACHED = 1.5, 8.0
"""Acceleration with which a slow foe may drive on, and the speed that it may reach [m/s^2, m/s]."""
BEND_ACCELERATION = 2.5
"""Lateral acceleration that the ego is expected to use in the bends on its way [m/s^2]."""
BRAKING_FOR_BENDS = 2.0
"""Deceleration with which the ego is expected to slow down for bends [m/s^2]."""
SLOWEST = 2.0
"""Lowest speed at which the ego is expected to take a bend, however sharp [m/s]."""
STANDING = 0.3
"""Below this speed, a vehicle counts as standing [m/s]."""
AT_THE_SIGN = 4.0
"""An ego that stands within this distance before a stop sign's line has stopped there [m]."""
SLOW_AT_THE_SIGN, STOPPING, AND_MORE = 2.5, 1.5, 0.5
"""An ego below this speed stops at once instead of creeping up to the line, if it comes to stand near enough
with this deceleration and this additional distance [m/s, m/s^2, m]."""
PATIENCE = 3.0
"""A foe that has stood for this long is taken to let the ego go first [s]."""
PATIENCE_INSIDE = 6.0
"""The same for a foe that stands with its front in the conflict [s]."""
SETS_OFF, NOSE = 2.5, 0.2
"""A foe that lets the ego go first may set off with this acceleration, and is in the ego's way when it has
come this much farther than to the conflict [m/s^2, m]."""
REACTION, LEAST_PAST = 0.3, 3.0
"""The ego then brakes after this time; lowest speed at which it passes a foe [s, m/s]."""
SPEEDING_UP, COMES_FASTER, COMES = 0.5, 0.7, 4.0
"""A foe that has to yield to the ego is expected to come all the same if it would have to brake harder than
the third value to stop before the conflict; if it speeds up by the first, than the second [m/s^2]."""


@dataclass(frozen=True, slots=True)
class StopPlace:
    """A place that the front bumper must not pass for now."""

    name: str
    along: float


@dataclass(frozen=True, slots=True)
class PassedFoe:
    """A vehicle that has stood for long and lets the ego go first, but may set off as the ego comes."""

    name: str
    along: float
    """Where the front bumper meets it [m]."""
    speed: float
    """Up to this speed, the ego passes before it is in the way wherever the ego can no longer stop [m/s]."""


class RightOfWay:
    """Decides at which places the ego has to stop.

    Parameters
    ----------
    acceleration : acceleration with which the ego clears a conflict [m/s^2]
    """

    def __init__(self, acceleration: float) -> None:
        self._acceleration = acceleration
        self._standing = StoodSince()
        self._speeds: dict[str, tuple[float, float]] = {}
        """For each foe, the time of the last look and its speed then [s, m/s]."""
        self._faster: set[str] = set()
        self._watched_at = -math.inf
        self._braking_for: set[str] = set()
        self._stopped_at: set[str] = set()
        self.firm_line = math.inf
        """The nearest place that the ego must not pass, however hard it has to brake: the line of a red light
        that held it at the last call, or the way of a foe that it would hit; inf for none [m]."""

    def stops(self, perception: Perception) -> list[StopPlace]:
        """Return the places to stop at, in no order."""
        ego, road = perception.ego, perception.road
        self._watch(ego.time, road)
        lights = self._lights(perception)
        foes = [self._before(foe, perception) for foe in road.foes if self._yields(foe, perception)]
        return [*lights, *self._signs(perception), *(stop for stop in foes if stop is not None)]

    def passed(self, perception: Perception) -> list[PassedFoe]:
        """Return the foes ahead that let the ego go first, in no order."""
        ego = perception.ego
        self._watch(ego.time, perception.road)
        return [
            PassedFoe(foe.name, foe.entry, _passing_speed(foe, ego))
            for foe in perception.road.foes
            if _lies_ahead(foe, ego) and self._comes(foe) and self._lets_go(foe, ego.time)
        ]

    def _lights(self, perception: Perception) -> list[StopPlace]:
        """Return the lights to stop at.

        Once begun, a stop at a red light is given up only if even full braking is not enough. Because of lags
        and smooth plans, the stop needs more braking than it seemed at first, and giving it up near the line
        would be dangerous.
        """
        ego = perception.ego
        held = [
            one
            for one in perception.road.signals
            if must_stop(one, ego, 1.0 if one.name in self._braking_for else HARD_SHARE)
        ]
        red = [one for one in held if one.state is SignalState.RED]
        self._braking_for = {one.name for one in red}
        ahead = (one.stop_line for one in red if one.stop_line >= ego.body.front)
        self.firm_line = min(ahead, default=math.inf)
        return [StopPlace(one.name, one.stop_line) for one in held]

    def _signs(self, perception: Perception) -> list[StopPlace]:
        """Return the stop signs at which the ego has not stopped yet."""
        ego, signs = perception.ego, perception.road.stop_signs
        self._stopped_at &= {sign.name for sign in signs}
        if ego.speed < STANDING:
            near = (sign for sign in signs if sign.stop_line - ego.body.front < AT_THE_SIGN)
            self._stopped_at |= {sign.name for sign in near}
        slow, hardest = ego.speed < SLOW_AT_THE_SIGN, _hardest(ego)
        here = ego.body.front + ego.speed**2 / (2.0 * STOPPING) + AND_MORE
        found: list[StopPlace] = []
        for sign in signs:
            if sign.name in self._stopped_at or not _can_stop(sign.stop_line + OVERSHOOT, ego, hardest):
                continue
            at_once = slow and sign.stop_line - here < AT_THE_SIGN - AND_MORE
            found.append(StopPlace(sign.name, min(sign.stop_line, here) if at_once else sign.stop_line))
        return found

    def _watch(self, time: float, road: RoadAhead) -> None:
        """Look at the foes, only once per instant: a second look would see no change of speed."""
        if time == self._watched_at:
            return
        self._watched_at = time
        self._standing.look((foe.name for foe in road.foes if foe.foe_speed < STANDING), time)
        self._faster = {foe.name for foe in road.foes if self._speeds_up(foe, time)}
        self._speeds = {foe.name: (time, foe.foe_speed) for foe in road.foes}

    def _speeds_up(self, foe: JunctionFoe, time: float) -> bool:
        looked, speed = self._speeds.get(foe.name, (time, foe.foe_speed))
        return foe.foe_speed - speed > SPEEDING_UP * (time - looked)

    def _comes(self, foe: JunctionFoe) -> bool:
        """Return whether a foe is expected to enter the conflict, even if it has to yield."""
        if foe.must_yield or foe.foe_entry <= 0.0:
            return True
        needed = foe.foe_speed**2 / (2.0 * foe.foe_entry)
        return needed > (COMES_FASTER if foe.name in self._faster else COMES)

    def _yields(self, foe: JunctionFoe, perception: Perception) -> bool:
        """Return whether the ego has to let the foe go first."""
        ego = perception.ego
        if not _lies_ahead(foe, ego) or not self._comes(foe) or self._lets_go(foe, ego.time):
            return False
        return self._meets(foe, perception, TIME_MARGIN, speeds_up=True)

    def _lets_go(self, foe: JunctionFoe, time: float) -> bool:
        """Return whether a foe has stood for so long that it is taken to let the ego go first."""
        patience = PATIENCE_INSIDE if foe.foe_entry <= 0.0 else PATIENCE
        return self._standing.stood(foe.name, time) >= patience

    def _meets(self, foe: JunctionFoe, perception: Perception, margin: float, speeds_up: bool) -> bool:
        """Return whether ego and foe, if both drive on, are in the conflict less than a margin apart.

        Parameters
        ----------
        foe, perception : the foe, and what the ego is told
        margin : the margin [s]
        speeds_up : whether the foe is taken to speed up
        """
        ego = perception.ego
        reached = max(foe.foe_speed, REACHED) if speeds_up else foe.foe_speed
        fastest = max((float(value) for value in perception.road.limit), default=30.0)
        fastest = max(fastest, SLOWEST)
        # The ego's earliest entry, if it speeds up, and its latest exit, if it has to slow down for bends.
        enters = travel_time(foe.entry - ego.body.front, max(ego.speed, 0.0), self._acceleration, fastest)
        clears = self._time_to(foe.exit + ego.body.rear_overhang, perception, fastest)
        arrives = travel_time(foe.foe_entry, foe.foe_speed, FOE_ACCELERATION, reached)
        leaves = foe.foe_exit / foe.foe_speed if foe.foe_speed > STANDING else math.inf
        return clears + margin > arrives and enters < leaves + margin

    def _time_to(self, along: float, perception: Perception, fastest: float) -> float:
        """Return when the rear axle reaches a place if only bends and limits slow the ego down [s]."""
        ego = perception.ego
        places, highest = _speeds_until(along, perception.road, fastest)
        squares = highest**2
        # First backwards, slowing down for what comes; then forwards, speeding up from what was.
        ahead, behind = 2.0 * BRAKING_FOR_BENDS * places, 2.0 * self._acceleration * places
        squares = np.minimum.accumulate((squares + ahead)[::-1])[::-1] - ahead
        squares[0] = min(squares[0], max(ego.speed, 0.0) ** 2)
        speeds = np.sqrt(np.minimum.accumulate(squares - behind) + behind)
        return float(np.sum(2.0 * np.diff(places) / np.maximum(speeds[:-1] + speeds[1:], 1e-6)))

    def _before(self, foe: JunctionFoe, perception: Perception) -> StopPlace | None:
        """Return the first place before the conflict where the ego can still stop.

        If it cannot stop there any more, it drives on if it gets past before the foe comes or after the foe
        has left. Otherwise it brakes all the same: it meets the foe later, more slowly, or not at all.

        An ego that has passed the line waits at the junction's waiting place: other drivers believe that a
        vehicle beyond it goes first, and stop for it, however far it is from their way. At a green light the
        ego always waits there: in dense traffic, a vehicle that waits at the line may lose the whole green.
        """
        ego = perception.ego
        before = foe.entry - CONFLICT_GAP
        middle = before if foe.waiting_place is None else min(foe.waiting_place, before)
        inside = _waits_inside(foe, perception)
        places, hardest = ((middle, 0.0), (before, 0.0)), _hardest(ego)
        for place, overshoot in places if inside else ((foe.stop_line, OVERSHOOT), *places):
            if _can_stop(place + overshoot, ego, hardest):
                return StopPlace(foe.name, place)
        # It brakes hard only for a foe that comes as it drives now, not for one that could speed up.
        if not self._meets(foe, perception, 0.0, speeds_up=foe.name in self._faster):
            return None
        if not _can_stop(foe.entry, ego, hardest):
            self.firm_line = min(self.firm_line, before)
        return StopPlace(foe.name, before)


def _lies_ahead(foe: JunctionFoe, ego: EgoState) -> bool:
    """Return whether the ego has not come to the conflict yet, nor the foe left it."""
    return foe.foe_exit > 0.0 and ego.body.front <= foe.entry


def _passing_speed(foe: JunctionFoe, ego: EgoState) -> float:
    """Return the speed from which the ego stops before the foe, however it sets off, or has passed [m/s]."""
    in_the_way = travel_time(max(foe.foe_entry, 0.0) + NOSE, 0.0, SETS_OFF, math.inf)
    return max(2.0 * _hardest(ego) * (in_the_way - REACTION), LEAST_PAST)


def _waits_inside(foe: JunctionFoe, perception: Perception) -> bool:
    """Return whether the ego waits for a foe inside the junction: if it is first there, at a green light."""
    place, ego, road = foe.waiting_place, perception.ego, perception.road
    if place is None or place > foe.entry - CONFLICT_GAP or place < foe.stop_line:
        return False
    ahead = perception.gaps.ahead
    if ahead is not None and ego.body.front + ahead.gap < place + CONFLICT_GAP:
        return False
    behind = place - ego.body.length
    if any(crossing.entry < place and crossing.exit > behind for crossing in road.crossings):
        return False
    own = [one for one in road.signals if abs(one.stop_line - foe.stop_line) < OVERSHOOT]
    return bool(own) and all(one.state is SignalState.GREEN for one in own)


def must_stop(signal: Signal, ego: EgoState, share: float = HARD_SHARE) -> bool:
    """Return whether the ego has to stop at a traffic light.

    At red it has to, unless the given share of full braking would end beyond the line; at amber only if
    ``AMBER_DECELERATION`` is enough.
    """
    if signal.state is SignalState.RED:
        return _can_stop(signal.stop_line + OVERSHOOT, ego, share * ego.drive.max_deceleration)
    if signal.state is SignalState.AMBER:
        return _can_stop(signal.stop_line, ego, AMBER_DECELERATION)
    return False


def travel_time(distance: float, speed: float, acceleration: float, limit: float) -> float:
    """Return the time to drive a distance while speeding up to a limit [s].

    >>> travel_time(10.0, 5.0, 1.0, 5.0)
    2.0
    >>> travel_time(8.0, 0.0, 1.0, 100.0)
    4.0
    """
    if distance <= 0.0:
        return 0.0
    if speed >= limit:
        return distance / max(speed, 1e-6)
    until_limit = (limit**2 - speed**2) / (2.0 * acceleration)
    if distance <= until_limit:
        return (math.sqrt(speed**2 + 2.0 * acceleration * distance) - speed) / acceleration
    return (limit - speed) / acceleration + (distance - until_limit) / limit


def _hardest(ego: EgoState) -> float:
    """Return the greatest deceleration that a stop for a sign or a foe may need [m/s^2]."""
    return HARD_SHARE * ego.drive.max_deceleration


def _can_stop(place: float, ego: EgoState, deceleration: float) -> bool:
    return ego.speed**2 / (2.0 * deceleration) <= place - ego.body.front


def _speeds_until(along: float, road: RoadAhead, fastest: float) -> tuple[FloatArray, FloatArray]:
    """Return places from the rear axle up to ``along`` [m], and the highest speeds there [m/s]."""
    count = math.ceil(along / road.curvature_step) if road.curvature_step > 0.0 else 0
    bends = np.abs(road.curvature[:count])
    if not len(bends):
        bends = np.zeros(1)
    highest = np.sqrt(BEND_ACCELERATION / np.maximum(bends, BEND_ACCELERATION / fastest**2))
    places = np.append(np.arange(len(bends)) * road.curvature_step, along)
    limits = road.limit[np.maximum(np.searchsorted(road.limit_along, places, side="right") - 1, 0)]
    return places, np.maximum(np.minimum(np.append(highest, highest[-1]), limits), SLOWEST)
