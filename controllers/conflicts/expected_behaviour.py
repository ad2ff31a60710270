"""What is expected of pedestrians: who may come into the ego's way, and how they move."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.interface import Crossing, CrossingKind, Perception, RoadAhead
from controllers.prediction.forecast import Forecast

THERE = 0.3
"""Waiting pedestrians nearer than this to where their crossing begins keep their velocity until they stand
[m]."""
KERB = 0.5
"""Nearer to the road than this counts as on it [m]."""
AT_THE_ROADSIDE = 0.5
"""Pedestrians beside the road who are slower across it stay there [m/s]."""
OCCUPIED = 0.15
"""Pedestrians nearer than this to what the body sweeps are in its way, whatever is expected of them [m]."""


@dataclass(frozen=True, slots=True)
class PedestrianAssumptions:
    """What is assumed of pedestrians whose velocity does not say what they will do."""

    resume_speed: float = 1.2
    """Speed at which somebody who stands on a crossing, or has stopped in the road, may walk on [m/s]."""
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
    waiting_ahead: float = 11.0
    """And, where it is longer than a car, for those so far ahead of its front bumper [m]."""


@dataclass(slots=True)
class Watch:
    """What is remembered of each pedestrian, by name."""

    heading: dict[str, float] = field(default_factory=dict)
    """Sign of the last clear movement across the path."""
    pace: dict[str, float] = field(default_factory=dict)
    """How fast those walked who were seen walking across the road [m/s]."""
    waited: dict[str, float] = field(default_factory=dict)
    """How long both have stood [s]."""
    seen: float = -np.inf
    """When it was looked at last [s]."""
    longest_wait: float = 0.0
    """Of all [s]."""

    def look(self, perception: Perception, assume: PedestrianAssumptions) -> None:
        """Bring it up to date; looking twice at the same instant changes nothing."""
        ego, people = perception.ego, perception.pedestrians
        passed = 0.0 if self.seen == -np.inf else min(ego.time - self.seen, 1.0)
        self.seen = ego.time
        waited: dict[str, float] = {}
        road, within = perception.road, max(assume.waiting_within, ego.body.front + assume.waiting_ahead)
        movements = zip(
            people.names,
            people.across.tolist(),
            people.along.tolist(),
            people.along_speed.tolist(),
            people.across_speed.tolist(),
            strict=True,
        )
        for name, where, at, along, across in movements:
            if abs(across) > assume.standing_below:
                self.heading[name] = math.copysign(1.0, across)
                if road.right_edge < where < road.left_edge:
                    self.pace[name] = abs(across)
            if math.hypot(along, across) <= assume.standing_below:
                before = ego.speed < assume.waiting_below and at < within
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
    comes: FloatArray | None
    """Across speed of those who walk to where their crossing begins, in the lane or through it, and of those
    who stand on a crossing or have stopped in the road and will walk on; for an ego that stands, of those
    too who have priority and are about to cross. nan for others, ``None`` for nobody [m/s]."""
    sets_off: FloatArray
    """How fast those walked who stopped on their way across the road: they may turn back, or walk on as soon
    as the front of an ego that they let go is past; nan for others [m/s]."""


def expected(
    perception: Perception, watch: Watch, assume: PedestrianAssumptions, forecast: Forecast | None
) -> Expectation:
    """Return what is expected of everybody; the arguments are those of ``path_conflicts.find``."""
    watch.look(perception, assume)
    people, road = perception.pedestrians, perception.road
    lets_go = [watch.lets_go_first(name, assume) for name in people.names]
    half = 0.5 * perception.ego.body.width + OCCUPIED
    persons = list(
        map(
            _Person,
            people.names,
            people.across.tolist(),
            people.along_speed.tolist(),
            people.across_speed.tolist(),
            (people.radius + half).tolist(),
            people.on_crossing.tolist(),
            people.waiting.tolist(),
            [road.crossings[at] if at >= 0 else None for at in people.crossing.tolist()],
        )
    )
    movements = [
        _movement(person, road, go, watch, assume) for person, go in zip(persons, lets_go, strict=True)
    ]
    speeds = [speed for speed, _ in movements]
    enters = np.array([why is not _Why.STAYS for _, why in movements], dtype=np.bool_)
    assumed = np.array([why in (_Why.TURNS, _Why.COMES) for _, why in movements], dtype=np.bool_)
    comes = None
    known = {_Why.COMES}
    if perception.ego.speed < assume.waiting_below:
        # Who is about to cross beside an ego that stands is not behind it, nor let pass: it does not start.
        known.add(_Why.TURNS)
    if any(why in known for _, why in movements):
        comes = np.array([speed if why in known else math.nan for speed, why in movements])
    sets_off = [
        watch.pace.get(person.name, assume.resume_speed if person.on_crossing else math.nan)
        if person.has_stopped(assume)
        else math.nan
        for person in persons
    ]
    if forecast is not None:
        enters |= _enters(forecast, road, assume) & (people.crossing < 0)
    return Expectation(
        np.where(enters, speeds, 0.0),
        enters,
        assumed,
        np.array(lets_go, dtype=np.bool_),
        comes,
        np.array(sets_off, dtype=np.float64),
    )


class _Why(Enum):
    """Why a pedestrian is expected to move in this way."""

    STAYS = auto()
    GOES_ON = auto()
    TURNS = auto()
    """Into the road, where pedestrians have priority."""
    COMES = auto()
    """To the waiting place, or on across the crossing or the road."""


class _Person(NamedTuple):
    """One of them."""

    name: str
    across: float
    along_speed: float
    across_speed: float
    reach: float
    """Nearer than this to the middle of the lane, a person is in the way of a car there [m]."""
    on_crossing: bool
    waiting: bool
    crossing: Crossing | None

    def has_stopped(self, assume: PedestrianAssumptions) -> bool:
        """Return whether they stand on their way across, and not at a waiting place."""
        return not self.waiting and math.hypot(self.along_speed, self.across_speed) < assume.standing_below


def _movement(
    person: _Person, road: RoadAhead, lets_go: bool, watch: Watch, assume: PedestrianAssumptions
) -> tuple[float, _Why]:
    """Return the speed across the road that is expected of somebody, and why [m/s]."""
    speed = person.across_speed
    if person.on_crossing:
        # On the crossing itself whoever lets the ego go first may go on: the whole margin is kept.
        if abs(speed) < assume.standing_below and person.name in watch.heading and not lets_go:
            return watch.heading[person.name] * assume.resume_speed, _Why.COMES
        return speed, _Why.GOES_ON
    if lets_go:
        return speed, _Why.STAYS
    if person.waiting and person.crossing is not None:
        return _to_the_crossing(person, person.crossing, assume)
    outside = person.across > road.left_edge + KERB or person.across < road.right_edge - KERB
    if abs(speed) >= (AT_THE_ROADSIDE if outside else assume.standing_below):
        return speed, _Why.GOES_ON
    if outside or person.name not in watch.heading:
        return speed, _Why.STAYS
    # Pedestrians who stop on their way across the road go on; those who never walked across it stay there,
    # and those who walk along it keep their velocity.
    if road.right_edge < person.across < road.left_edge and person.has_stopped(assume):
        return watch.heading[person.name] * assume.resume_speed, _Why.COMES
    return speed, _Why.GOES_ON


def _to_the_crossing(
    person: _Person, crossing: Crossing, assume: PedestrianAssumptions
) -> tuple[float, _Why]:
    """Return the same of somebody who is about to enter a crossing."""
    pace = math.hypot(person.along_speed, person.across_speed)
    stands = pace < assume.standing_below
    has_priority = crossing.kind is CrossingKind.ZEBRA or bool(crossing.pedestrians_have_green)
    if has_priority and (assume.yield_to_standing or not stands):
        # On the waiting area people still walk along the kerb: count on them to turn and cross.
        return math.copysign(max(pace, assume.resume_speed), -person.across), _Why.TURNS
    begins = crossing.begins(person.across)
    inwards = 1.0 if begins == crossing.right else -1.0
    if (person.across - begins) * inwards > 0.0 and person.across_speed * inwards >= AT_THE_ROADSIDE:
        # Past the waiting place without stopping: they are crossing, whoever has priority.
        return person.across_speed, _Why.GOES_ON
    first, last = sorted((person.across, begins))
    if stands or first > person.reach or last < -person.reach:
        return person.across_speed, _Why.STAYS
    # The waiting place is near the beginning of the crossing: in the ego's lane, or on its other side.
    way = begins - person.across
    towards = way if abs(way) > THERE else person.across_speed
    return math.copysign(max(pace, assume.resume_speed), towards), _Why.COMES


def _enters(forecast: Forecast, road: RoadAhead, assume: PedestrianAssumptions) -> NDArray[np.bool_]:
    """Return who is on the road in a forecast and has not been there all along, shape (n,)."""
    on_road = (forecast.across > road.right_edge - KERB) & (forecast.across < road.left_edge + KERB)
    passed = forecast.times[-1] - forecast.times[0]
    turns = np.ptp(forecast.across, axis=1) > assume.standing_below * passed
    return np.asarray(on_road.any(axis=1) & (turns | ~on_road[:, 0]))
