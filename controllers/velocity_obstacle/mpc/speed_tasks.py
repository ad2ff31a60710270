"""Bounds on the speed plan other than people in conflict: road, signals, vehicles, people beside the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from controllers.arrays import BoolArray, FloatArray
from controllers.conflicts import hidden_pedestrians
from controllers.conflicts.expected_behaviour import Watch
from controllers.driving import road_speeds
from controllers.driving.keep_clear import keep_clear_line
from controllers.driving.right_of_way import PassedFoe, RightOfWay, StopPlace
from controllers.driving.standing import standing
from controllers.driving.vehicles_ahead import Blockade, blockade
from controllers.driving.waiting_for_the_ego import WaitingForTheEgo, in_queue
from controllers.geometry.footprints import footprints
from controllers.interface import Lane, Perception
from controllers.velocity_obstacle.mpc.arithmetic import position_bounds
from controllers.velocity_obstacle.mpc.longitudinal import SpeedLimits, SpeedTask
from controllers.velocity_obstacle.mpc.passing_settings import PassingSettings
from controllers.velocity_obstacle.mpc.plan_memory import PlanMemory

SIDE_CLEARANCE = 0.3
"""Distance kept beside other vehicles [m]."""
BESIDE = 0.1
"""Side clearance of a standing ego, and from vehicles in the lane being left, where only those that are truly
in the way count [m]."""
SIDE_CLEARANCE_FROM = 2.0
"""From this speed, the full side clearance is kept; below it, the clearance shrinks in proportion [m/s]."""
SLOW = 1.0
"""Below this speed, the ego counts as slow [m/s]."""
CAREFUL_BEFORE = 5.0
"""The ego passes pedestrians who let it go first slowly from this distance before them [m]."""
SLOWING_FOR_THE_ROAD, SLOWING_FOR_PEOPLE = 2.5, 1.5
"""Decelerations before bends and speed limits, and before people who are passed slowly or may be hidden, and
vehicles that let the ego go first [m/s^2]."""
CEILING_SHARE, CEILING_MARGIN = 1.25, 0.3
"""How far bends and limits may be exceeded: factor on the comfortable lateral acceleration in bends, and
addition to the resulting speeds and the limits [-, m/s]."""
LATEST_FOR_THE_ROAD, LATEST_FOR_PEOPLE = 3.3, 2.0
"""Decelerations before those ceilings, for the road and for people [m/s^2]."""
SPEEDING_UP = 1.0
"""Rate at which the wanted speed rises after people who are passed slowly [m/s^2]."""
STOPPING, STOPPING_FOR_PEOPLE = 3.0, 2.0
"""Decelerations with which the ego stops for lines and vehicles, and for people, who may come nearer than
expected [m/s^2]."""
SpeedLimit = tuple[FloatArray, FloatArray]
"""Positions of the rear axle, and the speed allowed there [m, m/s]."""


@dataclass(slots=True)
class SpeedTasks:
    """Makes the speed tasks of one ego."""

    settings: PassingSettings
    limits: SpeedLimits
    memory: PlanMemory
    right_of_way: RightOfWay
    stops: list[StopPlace] = field(default_factory=list)
    waiting_place: float = np.inf
    """Where the front bumper waits in the present lane for a change to another; inf for nowhere [m]."""
    _past_foes: SpeedLimit | None = None
    """How fast the ego may come to vehicles that let it go first; ``None`` without any."""
    _kept_clear: set[str] = field(default_factory=set)
    _keeps_clear: set[str] = field(default_factory=set)
    # Crossings that the last plan kept clear, and those that this one does.
    _watched: WaitingForTheEgo = field(default_factory=WaitingForTheEgo)
    _wait_for_the_ego: BoolArray = field(init=False)
    _centres: dict[int, float] = field(default_factory=dict)
    """Across coordinates of the lanes' centre lines, by number; plans may be based on others [m]."""
    _no_lower_bound: FloatArray = field(init=False)
    _demands: FloatArray = field(init=False)
    # Lateral acceleration in bends and deceleration before them, for the wanted speed and for the ceiling.

    def __post_init__(self) -> None:
        lateral = self.settings.bend_acceleration
        wanted, ceiling = (lateral, SLOWING_FOR_THE_ROAD), (CEILING_SHARE * lateral, LATEST_FOR_THE_ROAD)
        self._demands = np.array([wanted, ceiling])
        self._no_lower_bound = np.full(len(self.memory.times), -np.inf)

    def look(self, perception: Perception, waiting_place: float) -> None:
        """Take note of signals and of vehicles with priority."""
        self.stops = self.right_of_way.stops(perception)
        self._past_foes = _past_foes(self.right_of_way.passed(perception), perception.ego.body.front)
        if perception.ego.speed < SLOW:
            self._wait_for_the_ego = self._watched.look(perception)
        else:
            self._watched = WaitingForTheEgo()  # waiting counts from the ego's present stop
        self.waiting_place = waiting_place
        self._kept_clear, self._keeps_clear = self._keeps_clear, set()
        self._centres = {lane.number: lane.offset for lane in perception.road.lanes}

    def task(
        self,
        perception: Perception,
        lane: Lane | None,
        leaving_for: float,
        watch: Watch,
        slowly: SpeedLimit | None,
    ) -> tuple[SpeedTask, str, float]:
        """Return the speed task without people in conflict, what bounds the position, and where to wait.

        A slow ego has to wait with its front bumper there: for lights, for vehicles that will go on, for the
        lane's end; inf for nowhere, and for a faster ego [m].

        Parameters
        ----------
        perception, lane, leaving_for
            As for :meth:`controllers.velocity_obstacle.mpc.speed_planning.SpeedPlanner.cheapest`.
        watch
            Memory of the pedestrians.
        slowly
            How fast the ego may pass people who stay beside the way; ``None``: nobody is near.
        """
        s, ego, front = self.settings, perception.ego, perception.ego.body.front
        times, limits = self.memory.times, self.limits
        positions, expected = self.memory.expected(ego)
        ahead = self._vehicles(perception, lane, leaving_for)
        line, stop = self._line(perception, lane, ahead.rest, self.stops)
        waits_at = self._waits_at(perception, lane) if ego.speed < SLOW else np.inf
        gap_now = s.standstill_gap + limits.headway * ego.speed
        upper, stoppable, headway = position_bounds.position_bounds(
            ahead.rear, ahead.rest, ahead.follow, line, front, s.standstill_gap, gap_now, times
        )
        reference, ceiling = road_speeds.reference_speeds(
            perception,
            positions,
            self._demands,
        )
        ceiling += CEILING_MARGIN
        reference = _without_a_run_up(reference, times, limits.acceleration)
        for along in watch.carefully_past(perception, s.assume):
            beside = (positions + front > along - CAREFUL_BEFORE) & (positions < along)
            reference = np.where(beside, np.minimum(reference, s.assume.careful_speed), reference)
        hidden = hidden_pedestrians.speed_limit(perception, swept(perception, lane), s.hidden)
        for limit in (slowly, hidden, self._past_foes):
            if limit is not None:
                slow = hidden_pedestrians.reached(*limit, positions, SLOWING_FOR_PEOPLE)
                reference = np.minimum(reference, _without_a_run_up(slow, times, SPEEDING_UP))
                latest = hidden_pedestrians.reached(*limit, positions, LATEST_FOR_PEOPLE)
                ceiling = np.minimum(ceiling, latest)
        comes_to = np.minimum(
            stopping_within(line - position_bounds.BEFORE_LINE - front - positions),
            stopping_within(ahead.rear - s.standstill_gap - front - positions, ahead.pace),
        )
        task = SpeedTask(
            speed=ego.speed,
            acceleration=ego.acceleration,
            command=self.memory.commanded(ego)[0],
            # A vehicle in the lane being left counts only until it is left: no run-up to that instant either.
            reference=_without_a_run_up(np.minimum(reference, comes_to), times, limits.acceleration),
            wanted=reference,
            positions=positions,
            expected=expected,
            ceiling=ceiling,
            upper=upper,
            lower=self._no_lower_bound,
            stoppable=stoppable,
            headway=headway,
        )
        return task, stop or ahead.name, waits_at

    def _vehicles(self, perception: Perception, lane: Lane | None, leaving_for: float) -> Blockade:
        """Return who is ahead in the target lane and, for as long as it matters, in the lane being left."""
        ego, times = perception.ego, self.memory.times
        # If two vehicles beside each other wait for each other, one has to pass closely and slowly.
        kept = BESIDE + (SIDE_CLEARANCE - BESIDE) * min(ego.speed / SIDE_CLEARANCE_FROM, 1.0)
        reach = 0.5 * ego.body.width + kept
        offset = lane.offset if lane is not None else 0.0
        then = blockade(perception, (offset - reach, offset + reach), times)
        if abs(offset - ego.across) < 0.3:
            return then
        # The front bumper is what would touch a vehicle ahead; the rear follows it out of the lane.
        body, at = 0.5 * ego.body.width + BESIDE, front_across(perception)
        now = blockade(perception, (at - body, at + body), times)
        left = times > leaving_for
        return Blockade(
            np.minimum(np.where(left, np.inf, now.rear), then.rear),
            np.minimum(np.where(left, np.inf, now.rest), then.rest),
            np.minimum(np.where(left, np.inf, now.rear), then.follow),
            then.name or (now.name if leaving_for > 0.0 else ""),
        )

    def _waits_at(self, perception: Perception, lane: Lane | None) -> float:
        """Return the line, or the place behind a vehicle, where the ego has to wait; inf for nowhere [m].

        A vehicle that stands across the ego's way, or beside it with nothing ahead, is itself waiting for the
        ego, so waiting for it does not help.
        """
        vehicles = perception.vehicles
        stand = {vehicles.names[i] for i in np.flatnonzero(standing(vehicles))}
        box = footprints(vehicles)
        right, left = swept(perception, lane)
        ahead = box.same_way & (box.rear > 0.0) & (box.right < left) & (box.left > right)
        centre = 0.0 if lane is None else self._centres[lane.number]
        ahead &= in_queue(perception, centre) | ~self._wait_for_the_ego
        leader = float(box.rear[ahead].min(initial=np.inf))
        others = [stop for stop in self.stops if stop.name not in stand]
        line, _ = self._line(perception, lane, np.full(len(self.memory.times), leader), others)
        return min(line, leader - self.settings.standstill_gap)

    def _line(
        self, perception: Perception, lane: Lane | None, rest: FloatArray, stops: Sequence[StopPlace]
    ) -> tuple[float, str]:
        """Return the place that the front bumper must not pass now, and why; inf for none [m]."""
        places = [(stop.along, stop.name) for stop in stops]
        gap = self.settings.standstill_gap
        clear = keep_clear_line(perception, self.memory.times, rest, gap, self._kept_clear)
        self._keeps_clear.add(clear[1])
        places.append(clear)
        if lane is not None:
            here = lane.number == perception.road.reference
            end = min(lane.follows_route_for, self.waiting_place) if here else lane.follows_route_for
            places.append((end, "lane end"))
        nearest, name = min(places)
        return nearest, name if np.isfinite(nearest) else ""


def _past_foes(passed: Sequence[PassedFoe], front: float) -> SpeedLimit | None:
    if not passed:
        return None
    return np.array([foe.along for foe in passed]) - front, np.array([foe.speed for foe in passed])


def stopping_within(
    room: FloatArray, then: float | FloatArray = 0.0, braking: float = STOPPING
) -> FloatArray:
    """Return the speeds from which the ego stops comfortably, ``sqrt(then^2 + 2 b room)``, shape (N,) [m/s].

    Without these speeds, it is cheapest to use all of the horizon's time on the way to a place that must not
    be passed. As every step plans anew, the ego would slow down far away and creep. An ego that stands would
    plan to set out late, to be fast at the end of the horizon, and never set out.

    Parameters
    ----------
    room : distance from the expected positions to where the ego stops, shape (N,) [m]
    then : speed at that place, if a vehicle there drives on [m/s]
    braking : deceleration b [m/s^2]
    """
    return np.asarray(np.sqrt(np.square(then) + 2.0 * braking * np.maximum(room, 0.0)))


def _without_a_run_up(wanted: FloatArray, times: FloatArray, rate: float) -> FloatArray:
    """Return wanted speeds that rise gently over the horizon, shape (N,) [m/s].

    If the wanted speed jumps at the end of a slow stretch, it is cheaper to dawdle before the jump and to be
    accelerating already when it comes. As every step plans anew, the stretch still ends as far ahead, and the
    ego dawdles on until it stands.

    >>> _without_a_run_up(np.array([9.0, 1.0, 1.0, 9.0]), np.array([1.0, 2.0, 3.0, 4.0]), 1.0).tolist()
    [9.0, 1.0, 1.0, 2.0]
    """
    rise = rate * times
    return np.asarray(np.minimum.accumulate(wanted - rise) + rise)


def front_across(perception: Perception) -> float:
    """Return the across coordinate of the front bumper's centre [m]."""
    ego = perception.ego
    return ego.across + ego.body.front * float(np.sin(ego.heading_error))


def swept(perception: Perception, lane: Lane | None) -> tuple[float, float]:
    """Return the right and left edge of the area that the body sweeps on its way into a lane [m]."""
    half = 0.5 * perception.ego.body.width
    offset = lane.offset if lane is not None else 0.0
    across = perception.ego.across
    return min(across, offset) - half, max(across, offset) + half
