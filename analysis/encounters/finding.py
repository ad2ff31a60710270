"""Which ego met which pedestrian, when and where.

An *encounter* lasts from the instant when both are within 45 m of their conflict area (of each other where
their paths do not cross) until one has left that range. It counts if the pedestrian crosses the ego's path,
was on a crossing, or was about to step onto one. Passers-by on the sidewalk do not count, nor do riders of
vehicles, whom a recording does not hold.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from analysis.arrays import BoolArray, IntArray
from analysis.encounters.candidates import Meeting, met, waited
from analysis.encounters.conflict_area import ConflictArea, conflict_areas
from analysis.encounters.crossings import Traversal
from analysis.geometry import clearance, to_frame
from analysis.recording.fine_grid import Grid
from analysis.recording.reading import RecordedRun
from analysis.recording.tracks import Track
from analysis.stretches import stretches
from analysis.thresholds import Thresholds

_MARGIN_M = 3.0


@dataclass(frozen=True, slots=True)
class Encounter:
    """One ego and one pedestrian over consecutive samples of the fine grid."""

    ego: Track
    person: Track
    first: int
    """Fine index of the first sample."""
    last: int
    area: ConflictArea | None
    crossing_id: str
    """Crossing the person is on or next to; empty for none."""
    crossing_kind: str
    traversal: Traversal | None
    """The ego's passage over that crossing that is nearest in time."""
    passes_crossing: bool
    """Whether the ego's body was over that crossing, or the map does not hold it."""
    censored: bool
    """Whether the recording of one of the two ended before the encounter was over."""

    @property
    def passage_id(self) -> str:
        """Ego and crossing and the number of the traversal; empty away from crossings."""
        if not self.crossing_id:
            return ""
        number = 1 if self.traversal is None else self.traversal.number
        return f"{self.ego.name}|{self.crossing_id}|{number}"


@dataclass(frozen=True, slots=True)
class Surroundings:
    """Data of a run in which encounters are looked up."""

    run: RecordedRun
    grid: Grid
    thresholds: Thresholds
    traversals: Mapping[tuple[str, str], Sequence[Traversal]]
    crossing_kinds: Mapping[str, str]


def find_encounters(egos: Sequence[Track], persons: Sequence[Track], around: Surroundings) -> list[Encounter]:
    """Return all encounters, sorted by beginning, ego and pedestrian."""
    found = []
    for ego in egos:
        for person in persons:
            if come_within(ego, person, 2.0 * around.thresholds.encounter_range_m):
                areas = conflict_areas(ego, person, around.grid, around.thresholds.visit_pairing_s)
                found.extend(_of_pair(ego, person, areas, around))
    return sorted(found, key=place_in_run)


def find_in_traffic(
    vehicles: Sequence[Track], persons: Sequence[Track], around: Surroundings
) -> list[Encounter]:
    """Return the encounters of all vehicles that drove over the pedestrian's path or crossing.

    As `find_encounters`, but without vehicles that passed neither the pedestrian's path within
    traffic_pairing_s nor their crossing.
    """
    grid, within = around.grid, around.thresholds.traffic_pairing_s
    meetings = met(vehicles, persons, grid, within, around.run.largest)
    pairs = meetings.keys() | waited(vehicles, persons, around.traversals, around.run, grid, within)
    found: list[Encounter] = []
    for pair in sorted(pairs):
        vehicle, person = vehicles[pair[0]], persons[pair[1]]
        if vehicle.last < person.first or person.last < vehicle.first:
            continue
        meeting = meetings.get(pair)
        areas = [] if meeting is None else _areas_near(vehicle, person, meeting, grid, within)
        of_pair = _of_pair(vehicle, person, areas, around)
        found.extend(one for one in of_pair if one.area is not None or one.traversal is not None)
    return sorted(found, key=place_in_run)


def place_in_run(one: Encounter) -> tuple[int, str, str, int]:
    """Return the key by which the encounters of a run are sorted: beginning, ego, pedestrian, end."""
    return one.first, one.ego.name, one.person.name, one.last


def _areas_near(
    vehicle: Track, person: Track, meeting: Meeting, grid: Grid, within_s: float
) -> list[ConflictArea]:
    """Return the conflict areas on the ground where the two came near each other."""
    own, other = _around(vehicle, meeting.vehicle), _around(person, meeting.person)
    return _areas_on(vehicle, person, own, other, grid, within_s)


def _areas_on(
    ego: Track, person: Track, own: tuple[int, int], other: tuple[int, int], grid: Grid, within_s: float
) -> list[ConflictArea]:
    """Return the conflict areas of parts of two tracks, between two samples of each."""
    areas = conflict_areas(ego.between(*own), person.between(*other), grid, within_s)
    return [replace(area, ego=area.ego.later(own[0]), person=area.person.later(other[0])) for area in areas]


def _around(track: Track, samples: tuple[int, int]) -> tuple[int, int]:
    """Return first and last sample, extended by a distance on the path so that stays are complete."""
    margin = track.length + _MARGIN_M
    first = np.searchsorted(track.path, track.path[samples[0]] - margin, "left")
    last = np.searchsorted(track.path, track.path[samples[1]] + margin, "right")
    return int(first), int(last) - 1


def come_within(ego: Track, person: Track, distance_m: float) -> bool:
    """Return whether the centres of an ego and a pedestrian come as near as this at one instant [m]."""
    first, last = max(ego.first, person.first), min(ego.last, person.last)
    if first > last:
        return False
    a, b = _slice(ego, first, last), _slice(person, first, last)
    apart = np.hypot(ego.x[a] - person.x[b], ego.y[a] - person.y[b])
    return bool(apart.min() <= distance_m)


def _of_pair(
    ego: Track, person: Track, areas: Sequence[ConflictArea], around: Surroundings
) -> list[Encounter]:
    first, last = max(ego.first, person.first), min(ego.last, person.last)
    own, other = _slice(ego, first, last), _slice(person, first, last)
    reach = around.thresholds.encounter_range_m
    accepted: list[Encounter] = []
    apart = around.run.levels.apart
    for area in sorted(areas, key=lambda one: max(one.time_between, 0.0)):
        if apart[ego.level[area.ego.first], person.level[area.person.first]]:
            continue
        near = np.hypot(ego.x[own] - area.x, ego.y[own] - area.y) <= reach
        near &= np.hypot(person.x[other] - area.x, person.y[other] - area.y) <= reach
        stretch = _nearest_stretch(near, first, ego.first + area.ego.first, person.first + area.person.first)
        if stretch is None:
            continue
        encounter = _make(ego, person, *stretch, area, around)
        if not any(_same(encounter, one) for one in accepted):
            accepted.append(encounter)
    near = np.hypot(ego.x[own] - person.x[other], ego.y[own] - person.y[other]) <= reach
    near &= ~apart[ego.level[own], person.level[other]]
    for begin, end in stretches(near):
        if any(one.first <= first + end and first + begin <= one.last for one in accepted):
            continue
        encounter = _make(ego, person, first + begin, first + end, None, around)
        if encounter.crossing_id:
            accepted.append(encounter)
    accepted.extend(_of_contacts(ego, person, first, near, accepted, around))
    return accepted


def _of_contacts(
    ego: Track, person: Track, first: int, near: BoolArray, known: Sequence[Encounter], around: Surroundings
) -> Iterator[Encounter]:
    """Yield encounters for the contacts that no known encounter holds, so that none is missed.

    These are rare: the conflict area is longer than the range, as the pedestrian walks along the lane, or
    their second area of the same encounter is far from the first.

    Parameters
    ----------
    ego, person : Track
    first : int
        Fine index of the first sample of ``near``.
    near : array
        Whether the two are near each other, shape (n,).
    known : Sequence
        Encounters of the two.
    around : Surroundings
    """
    left = near.copy()
    for one in known:
        left[max(one.first - first, 0) : one.last - first + 1] = False
    touch = _may_touch(ego, person, first + np.flatnonzero(left)) - first
    for begin, end in stretches(left) if len(touch) else ():
        if not ((begin <= touch) & (touch <= end)).any():
            continue
        stretch = first + begin, first + end
        own = stretch[0] - ego.first, stretch[1] - ego.first
        other = stretch[0] - person.first, stretch[1] - person.first
        areas = _areas_on(ego, person, own, other, around.grid, around.thresholds.visit_pairing_s)
        area = min(areas, key=lambda one: max(one.time_between, 0.0), default=None)
        if area is not None:
            yield _make(ego, person, *stretch, area, around)


def _may_touch(ego: Track, person: Track, samples: IntArray) -> IntArray:
    """Return at which of the samples the two touch, or may do so until the next one."""
    own, other = samples - ego.first, samples - person.first
    x, y = to_frame(person.x[other] - ego.x[own], person.y[other] - ego.y[own], ego.heading[own])
    apart = clearance(x, y, 0.5 * ego.length, 0.5 * ego.width, 0.5 * person.width)
    return samples[apart <= ego.largest_shift + person.largest_step]


def _same(one: Encounter, other: Encounter) -> bool:
    overlap = one.first <= other.last and other.first <= one.last
    return overlap and one.crossing_id == other.crossing_id


def _make(
    ego: Track, person: Track, first: int, last: int, area: ConflictArea | None, around: Surroundings
) -> Encounter:
    crossing_id = _crossing(person, first, last, area, around.run)
    time = around.grid.time
    passed = around.traversals.get((ego.name, crossing_id), ())
    middle = area.ego.enter if area is not None else 0.5 * (time[first] + time[last])
    traversal = min(passed, key=lambda one: abs(one.visit.enter - middle), default=None)
    return Encounter(
        ego=ego,
        person=person,
        first=first,
        last=last,
        area=area,
        crossing_id=crossing_id,
        crossing_kind=around.crossing_kinds.get(crossing_id, ""),
        traversal=traversal,
        passes_crossing=traversal is not None or crossing_id not in around.crossing_kinds,
        censored=_is_censored(ego, person, last, area),
    )


def _crossing(person: Track, first: int, last: int, area: ConflictArea | None, run: RecordedRun) -> str:
    """Return the crossing that the person walked on last, else the one they waited for; empty for none.

    With a conflict area, only their samples inside it count.
    """
    texts = run.neighbours.texts["crossing_id"]
    if area is not None:
        rows = person.rows[area.person.first : area.person.last + 1]
    else:
        rows = person.rows[_slice(person, first, last)]
    phase = run.neighbours.texts["phase"]
    crossing = rows[phase.equal("crossing", rows)]
    waiting = rows[phase.equal("waiting", rows)]
    for chosen in (crossing, waiting):
        codes = texts.codes[chosen]
        known = chosen[codes >= 0]
        if len(known):
            return texts.at(int(known[-1]))
    return ""


def _is_censored(ego: Track, person: Track, last: int, area: ConflictArea | None) -> bool:
    if last < min(ego.last, person.last):
        return False
    if area is None:
        return True
    return area.ego.leave != area.ego.leave or area.person.leave != area.person.leave


def _nearest_stretch(
    near: BoolArray, first: int, ego_enters: int, person_enters: int
) -> tuple[int, int] | None:
    """Return the stretch nearest to the instants of entry, as fine indices; ``None`` if there is none."""
    found = [(first + a, first + b) for a, b in stretches(near)]
    low, high = min(ego_enters, person_enters), max(ego_enters, person_enters)

    def away(stretch: tuple[int, int]) -> int:
        return max(stretch[0] - high, low - stretch[1], 0)

    return min(found, key=away, default=None)


def _slice(track: Track, first: int, last: int) -> slice:
    return slice(first - track.first, last - track.first + 1)


def exposed_samples(encounter: Encounter, run: RecordedRun, standing_speed: float) -> BoolArray:
    """Return the samples at which a predicted collision counts.

    A person on the encounter's crossing counts while on it, if the ego passes that crossing in this run or
    the encounter is censored; a person who crosses the ego's path elsewhere counts throughout. Nobody counts
    while waiting at the kerb, and nothing counts while the ego stands.
    """
    ego = _slice(encounter.ego, encounter.first, encounter.last)
    rows = encounter.person.rows[_slice(encounter.person, encounter.first, encounter.last)]
    moving = encounter.ego.speed[ego] > standing_speed
    texts = run.neighbours.texts
    on_crossing: BoolArray = texts["phase"].equal("crossing", rows)
    on_crossing &= texts["crossing_id"].equal(encounter.crossing_id, rows)
    if on_crossing.any():
        meets = encounter.area is not None or encounter.passes_crossing or encounter.censored
        return on_crossing & moving if meets else np.zeros_like(moving)
    if encounter.area is None:
        return np.zeros_like(moving)
    return np.asarray(moving)
