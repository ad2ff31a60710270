"""Expected behaviour of pedestrians: who may come into the ego's way, and how they move."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.driving.keep_clear import waiting_places
from controllers.driving.standing import STANDING as EGO_STANDING
from controllers.interface import Crossing, CrossingKind, EgoState, Pedestrians, Perception, RoadAhead
from controllers.prediction.forecast import Forecast

STAYED = 0.5
"""Pedestrians whose velocity is only estimated still stand while no farther than this from where they stopped
[m]."""
THERE = 0.3
"""Waiting pedestrians nearer than this to where their crossing begins keep their velocity until they stand
[m]."""
KERB = 0.5
"""Pedestrians nearer than this to the road count as on it [m]."""
AT_THE_ROADSIDE = 0.5
"""Pedestrians beside the road whose speed across it is below this are expected to stay there [m/s]."""
OCCUPIED = 0.15
"""Pedestrians nearer than this to the area that the body sweeps are in its way, whatever they are expected to
do [m]."""


@dataclass(frozen=True, slots=True)
class PedestrianAssumptions:
    """Assumptions about pedestrians whose velocity does not tell what they will do."""

    resume_speed: float = 1.2
    """Speed at which a pedestrian who stands on a crossing, or has stopped in the road, may walk on [m/s]."""
    standing_below: float = 0.2
    """Below this speed, a pedestrian counts as standing [m/s]."""
    yield_to_standing: bool = True
    """Whether a pedestrian who stands at the kerb of a zebra is expected to step out."""
    patience: float = 3.0
    """A pedestrian who has stood this long while the ego waited is taken to let it go first [s]."""
    careful_speed: float = 5.0
    """Speed at which the ego passes a pedestrian who lets it go first [m/s]."""
    waiting_below: float = 0.5
    """Below this speed, the ego counts as waiting [m/s]."""
    waiting_within: float = 15.0
    """The ego counts as waiting for people up to this far ahead of its rear axle [m]."""
    waiting_ahead: float = 11.0
    """An ego longer than a car waits for people up to this far ahead of its front bumper [m]."""
    waiting_near: float = 3.0
    """An ego that stands this near to where it has to stop for a crossing waits for people there, however far
    away they are [m]."""
    courtesy: float = 0.0
    """Before a crossing without priority, an ego that has come to rest lets people who stand at its end go
    first, until they have not stepped onto it for this long [s]."""
    courteous_below: float = 1.5
    """So does an ego that approaches such a crossing more slowly than this, which looks as if it stopped
    [m/s]."""


@dataclass(slots=True)
class Watch:
    """What is remembered of each pedestrian, by name."""

    heading: dict[str, float] = field(default_factory=dict)
    """Sign of the last clear movement across the path."""
    pace: dict[str, float] = field(default_factory=dict)
    """Largest speed across the road of pedestrians who were seen walking on it; before they stop, they slow
    down [m/s]."""
    waited: dict[str, float] = field(default_factory=dict)
    """How long the pedestrian has stood while the ego waited for them [s]."""
    stopped_at: dict[str, tuple[float, float]] = field(default_factory=dict)
    """Where in the world the pedestrian was first seen to stand [m]."""
    declined: dict[str, float] = field(default_factory=dict)
    """How long the pedestrian has stood while the ego was at rest [s]."""
    seen: float = -np.inf
    """Time of the last look [s]."""
    longest_wait: float = 0.0
    """Longest of the waiting times [s]."""
    at_red: set[str] = field(default_factory=set)
    """Pedestrians whose crossing showed red; when it turns green, they have not yet let anybody go first."""

    def look(self, perception: Perception, assume: PedestrianAssumptions) -> None:
        """Update what is remembered; a second look at the same instant changes nothing."""
        ego, people = perception.ego, perception.pedestrians
        passed = 0.0 if self.seen == -np.inf else min(ego.time - self.seen, 1.0)
        self.seen = ego.time
        waited: dict[str, float] = {}
        declined: dict[str, float] = {}
        at_rest = passed if ego.speed < EGO_STANDING else 0.0
        road, waits_for = perception.road, _waits_for(perception, assume)
        at_red, at_green = set[str](), set[str]()
        for number, crossing in enumerate(road.crossings):
            if crossing.pedestrians_have_green is not None:
                there = at_green if crossing.pedestrians_have_green else at_red
                there |= {people.names[i] for i in np.flatnonzero(people.crossing == number)}
        turned_green, self.at_red = self.at_red & at_green, at_red
        stand = self._standing(people, assume)
        movements = zip(people.names, people.across.tolist(), people.across_speed.tolist(), strict=True)
        for name, where, across in movements:
            if abs(across) > assume.standing_below:
                self.heading[name] = math.copysign(1.0, across)
                if road.right_edge < where < road.left_edge:
                    self.pace[name] = max(abs(across), self.pace.get(name, 0.0))
            if name in stand:
                before_that = 0.0 if name in turned_green else self.waited.get(name, 0.0)
                waited[name] = before_that + (passed if name in waits_for else 0.0)
                declined[name] = self.declined.get(name, 0.0) + at_rest
        self.waited, self.declined = waited, declined
        self.longest_wait = max(waited.values(), default=0.0)

    def _standing(self, people: Pedestrians, assume: PedestrianAssumptions) -> dict[str, tuple[float, float]]:
        """Return who stands, and where they stopped [m].

        An estimated velocity is seldom near 0, even if they do not move at all.
        """
        stand = dict[str, tuple[float, float]]()
        pace = np.hypot(people.along_speed, people.across_speed).tolist()
        places = zip(people.names, pace, people.uncertainty.tolist(), people.position.tolist(), strict=True)
        for name, speed, uncertainty, (x, y) in places:
            before = self.stopped_at.get(name)
            if uncertainty > 0.0 and before is not None and math.dist(before, (x, y)) <= STAYED:
                stand[name] = before
            elif speed <= assume.standing_below:
                stand[name] = (x, y)
        self.stopped_at = stand
        return stand

    def carefully_past(self, perception: Perception, assume: PedestrianAssumptions) -> FloatArray:
        """Return the along coordinates of those who let the ego go first and should not be raced past [m]."""
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
        """Return whether a pedestrian has stood so long before a waiting ego that it may go first."""
        return self.waited.get(name, 0.0) >= assume.patience

    def may_go_first(
        self, name: str, crossing: Crossing, ego: EgoState, assume: PedestrianAssumptions
    ) -> bool:
        """Return whether the ego, at rest or about to be, lets someone at the end of a crossing go first.

        People whose crossing has no priority wait for a vehicle that rolls towards it. They step out as soon
        as it has stopped, or has passed its line.
        """
        before = ego.speed < assume.courteous_below and ego.body.front < crossing.entry
        unmarked = crossing.kind is CrossingKind.UNMARKED
        return before and unmarked and self.declined.get(name, 0.0) < assume.courtesy


def _waits_for(perception: Perception, assume: PedestrianAssumptions) -> set[str]:
    """Return the names of those before whom the ego waits, if they stand."""
    ego, people = perception.ego, perception.pedestrians
    if ego.speed >= assume.waiting_below or not len(people):
        return set()
    within = max(assume.waiting_within, ego.body.front + assume.waiting_ahead)
    near = ego.body.front + assume.waiting_near
    at = np.array([place < near for place in waiting_places(perception)] + [False])
    before = (people.along < within) | at[people.crossing]  # the last is for -1, no crossing of the ego's
    return {people.names[i] for i in np.flatnonzero(before)}


class Expectation(NamedTuple):
    """What is expected of all pedestrians in a perception; arrays of length n."""

    across_speed: FloatArray
    """Expected speed across the path; 0 for those who are not expected to enter it [m/s]."""
    enters: NDArray[np.bool_]
    """True for those who may come into the way; the others count only where they are."""
    assumed: NDArray[np.bool_]
    """True for those whose speed is assumed, because their movement does not tell what they will do."""
    stands: NDArray[np.bool_]
    """True for those who stand, as the memory of them tells."""
    lets_go: NDArray[np.bool_]
    """True for those who have stood so long before the waiting ego that it may go first."""
    comes: FloatArray | None
    """Expected speed across of those who walk to where their crossing begins, if that leads into the lane or
    through it, and of those who stand on a crossing or have stopped in the road and will walk on. If the ego
    stands, also of those who have priority and are about to cross. nan for others; ``None`` if there are no
    such pedestrians [m/s]."""
    sets_off: FloatArray
    """Walking speed of those who stopped on their way across the road: they may turn back, or walk on as soon
    as the front of an ego that they let go first is past; nan for others [m/s]."""


def expected(
    perception: Perception, watch: Watch, assume: PedestrianAssumptions, forecast: Forecast | None
) -> Expectation:
    """Return what is expected of all pedestrians; the arguments are those of ``path_conflicts.find``."""
    watch.look(perception, assume)
    people, road = perception.pedestrians, perception.road
    lets_go = [watch.lets_go_first(name, assume) for name in people.names]
    stands = [name in watch.stopped_at for name in people.names]
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
            stands,
            [road.crossings[at] if at >= 0 else None for at in people.crossing.tolist()],
        )
    )
    movements = [
        _movement(person, perception, go, watch, assume) for person, go in zip(persons, lets_go, strict=True)
    ]
    speeds = [speed for speed, _ in movements]
    enters = np.array([why is not _Why.STAYS for _, why in movements], dtype=np.bool_)
    assumed = np.array([why in (_Why.TURNS, _Why.COMES) for _, why in movements], dtype=np.bool_)
    comes = None
    known = {_Why.COMES}
    if perception.ego.speed < assume.waiting_below:
        # A standing ego can pass neither behind nor ahead of those about to cross beside it: it stays.
        known.add(_Why.TURNS)
    if any(why in known for _, why in movements):
        comes = np.array([speed if why in known else math.nan for speed, why in movements])
    sets_off = [
        watch.pace.get(person.name, assume.resume_speed if person.on_crossing else math.nan)
        if person.has_stopped
        else math.nan
        for person in persons
    ]
    if forecast is not None:
        enters |= _enters(forecast, road, assume) & (people.crossing < 0)
    return Expectation(
        np.where(enters, speeds, 0.0),
        enters,
        assumed,
        np.array(stands, dtype=np.bool_),
        np.array(lets_go, dtype=np.bool_),
        comes,
        np.array(sets_off, dtype=np.float64),
    )


class _Why(Enum):
    """Why a pedestrian is expected to move in this way."""

    STAYS = auto()
    GOES_ON = auto()
    TURNS = auto()
    """They turn into the road, where pedestrians have priority."""
    COMES = auto()
    """They walk to the waiting place, or on across the crossing or the road."""


class _Person(NamedTuple):
    """One pedestrian."""

    name: str
    across: float
    along_speed: float
    across_speed: float
    reach: float
    """A person nearer than this to the middle of the lane is in the way of a car there [m]."""
    on_crossing: bool
    waiting: bool
    stands: bool
    crossing: Crossing | None

    @property
    def has_stopped(self) -> bool:
        """Whether they stand, and not at a waiting place."""
        return self.stands and not self.waiting


def _movement(
    person: _Person, perception: Perception, lets_go: bool, watch: Watch, assume: PedestrianAssumptions
) -> tuple[float, _Why]:
    """Return the speed across the road that is expected of a pedestrian [m/s], and why."""
    speed, road = person.across_speed, perception.road
    if person.on_crossing:
        # On the crossing itself, even those who let the ego go first may go on: the whole margin is kept.
        heading = watch.heading.get(person.name, _unseen_heading(person))
        if abs(speed) < assume.standing_below and heading and not lets_go:
            return heading * assume.resume_speed, _Why.COMES
        return speed, _Why.GOES_ON
    if lets_go:
        return speed, _Why.STAYS
    if person.waiting and person.crossing is not None:
        may_go = watch.may_go_first(person.name, person.crossing, perception.ego, assume)
        return _to_the_crossing(person, person.crossing, may_go, assume)
    on_the_road = road.right_edge < person.across < road.left_edge
    outside = not road.right_edge - KERB <= person.across <= road.left_edge + KERB
    if abs(speed) >= (AT_THE_ROADSIDE if outside else assume.standing_below):
        return speed, _Why.GOES_ON
    # Those who walk along the kerb go on along it, and those who never walked across the road stay there.
    if not on_the_road or person.name not in watch.heading:
        return speed, _Why.STAYS
    # Those who stop on their way across the road go on; those who walk along it keep their velocity.
    if person.has_stopped:
        return watch.heading[person.name] * assume.resume_speed, _Why.COMES
    return speed, _Why.GOES_ON


def _unseen_heading(person: _Person) -> float:
    """Return the way in which someone on a crossing will go who was never seen walking; 0 for neither.

    If they have priority, they may be on their way into the lane.
    """
    crossing = person.crossing
    has_priority = crossing is not None and crossing.gives_priority
    return -math.copysign(1.0, person.across) if has_priority and abs(person.across) > person.reach else 0.0


def _to_the_crossing(
    person: _Person, crossing: Crossing, may_go: bool, assume: PedestrianAssumptions
) -> tuple[float, _Why]:
    """Return the same as ``_movement`` for a pedestrian who is about to enter a crossing."""
    pace = math.hypot(person.along_speed, person.across_speed)
    stands = pace < assume.standing_below
    if crossing.gives_priority and (assume.yield_to_standing or not stands):
        # In the waiting area people still walk along the kerb: expect them to turn and cross.
        return math.copysign(max(pace, assume.resume_speed), -person.across), _Why.TURNS
    begins = crossing.begins(person.across)
    inwards = 1.0 if begins == crossing.right else -1.0
    if (person.across - begins) * inwards > 0.0 and person.across_speed * inwards >= AT_THE_ROADSIDE:
        # They have walked past the waiting place without stopping: they cross, no matter who has priority.
        return person.across_speed, _Why.GOES_ON
    if stands and may_go:
        return inwards * assume.resume_speed, _Why.COMES
    first, last = sorted((person.across, begins))
    if stands or first > person.reach or last < -person.reach:
        return person.across_speed, _Why.STAYS
    # The waiting place is near the beginning of the crossing: in the ego's lane, or on its other side.
    way = begins - person.across
    towards = way if abs(way) > THERE else person.across_speed
    return math.copysign(max(pace, assume.resume_speed), towards), _Why.COMES


def _enters(forecast: Forecast, road: RoadAhead, assume: PedestrianAssumptions) -> NDArray[np.bool_]:
    """Return who comes onto the road in a forecast, or moves across it if already there, shape (n,)."""
    on_road = (forecast.across > road.right_edge - KERB) & (forecast.across < road.left_edge + KERB)
    passed = forecast.times[-1] - forecast.times[0]
    turns = np.ptp(forecast.across, axis=1) > assume.standing_below * passed
    return np.asarray(on_road.any(axis=1) & (turns | ~on_road[:, 0]))
