"""Everything that metrics are computed from: one recorded run, prepared once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.encounters import vehicle_conflicts, vehicle_overlaps
from analysis.encounters.careful_driver import Replay, replay_contact
from analysis.encounters.contacts import Approach, Contact, closest_approaches, find_contacts
from analysis.encounters.crossings import Traversal, traversals
from analysis.encounters.finding import Encounter, Surroundings, find_encounters, find_in_traffic
from analysis.encounters.prediction import PredictedArea, predict_area
from analysis.encounters.samples import Samples, gather
from analysis.encounters.vehicle_conflicts import VehicleConflict, find_vehicle_conflicts, may_be_near
from analysis.encounters.vehicle_encroachment import Encroachment, encroachments
from analysis.encounters.vehicle_overlaps import VehicleOverlap, find_overlaps
from analysis.recording.ego_steps import EgoSteps, ego_steps
from analysis.recording.ego_tracks import EgoTracks
from analysis.recording.fine_grid import Grid, make_grid
from analysis.recording.knowledge import Knowledge, knowledge_of
from analysis.recording.object_tracks import Tracks
from analysis.recording.reading import RecordedRun
from analysis.recording.tracks import There, Track, way_of
from analysis.thresholds import Thresholds

Values = Mapping[str, Any]
"""Column name -> one value, or one for each encounter. nan, inf and ``None`` stand for undefined."""


@dataclass(frozen=True, slots=True)
class Case:
    """A recorded run with its tracks, encounters, samples and contacts."""

    run: RecordedRun
    thresholds: Thresholds
    grid: Grid
    egos: Sequence[Track]
    persons: Sequence[Track]
    """Pedestrians whose encounters this case holds."""
    crowd: Tracks
    """All recorded pedestrians; a long run is judged for some of them at a time."""
    vehicles: Tracks
    """All recorded vehicles; egos are among them while another ego is near."""
    bystanders: EgoTracks
    """Egos of other parts of the run recorded at the same time; none if the run is judged as a whole."""
    traversals: Mapping[tuple[str, str], Sequence[Traversal]]
    encounters: Sequence[Encounter]
    samples: Samples
    predicted: PredictedArea
    contacts: Sequence[Contact]
    replays: Mapping[Contact, Replay]
    """Replay of each contact with the careful driver at the wheel."""
    approach: Approach
    steps: EgoSteps
    overlaps: Sequence[VehicleOverlap]
    vehicle_conflicts: Sequence[VehicleConflict]
    ego_rows: Sequence[IntArray]
    """Rows of the egos during each encounter, until the ego has left the conflict area."""
    ego_enter: FloatArray
    """Entry into the conflict area; nan if there is none [s]."""
    ego_leave: FloatArray
    person_enter: FloatArray
    person_leave: FloatArray
    knowledge: Mapping[tuple[str, str], Knowledge] | None
    """What each ego knew of each pedestrian, by names; ``None`` where it knew the truth."""
    entered: BoolArray
    """Whether the pedestrian was on the crossing or in the ego's path, rather than only waiting.

    It is true if there is a conflict area, or if the pedestrian was exposed or hit by the moving ego."""

    def __len__(self) -> int:
        return len(self.encounters)

    def bodies(self, first: int, last: int) -> Sequence[Track]:
        """Return all that may block the way or the view between two samples; some are in it twice."""
        return _there(self.vehicles, self.egos, self.bystanders)(first, last)

    def collisions(self) -> Sequence[Contact]:
        """Return the contacts with a moving ego."""
        return [contact for contact in self.contacts if not contact.standing]

    def first_collision(self) -> list[Contact | None]:
        """Return each encounter's first collision, or ``None``."""
        first: list[Contact | None] = [None] * len(self)
        for contact in reversed(self.collisions()):
            first[contact.encounter] = contact
        return first

    def first_contact(self) -> list[Contact | None]:
        """Return each encounter's first collision, else its first contact of any kind, or ``None``."""
        first = self.first_collision()
        for contact in self.contacts:
            if first[contact.encounter] is None:
                first[contact.encounter] = contact
        return first

    def smallest_ttc(self) -> FloatArray:
        """Return each encounter's smallest TTC: 0 after a collision, inf without a collision course [s]."""
        low, _ = self.samples.smallest(self.samples.ttc)
        for contact in self.collisions():
            low[contact.encounter] = 0.0
        return low

    def post_encroachment(self) -> FloatArray:
        """Return each encounter's area PET: 0 after a collision, nan where undefined [s]."""
        person_second = self.person_enter - self.ego_leave
        ego_second = self.ego_enter - self.person_leave
        gap = np.fmax(person_second, ego_second)
        gap = np.where(gap >= 0.0, gap, np.nan)
        for contact in self.collisions():
            gap[contact.encounter] = 0.0
        return gap


SAMPLES_AT_ONCE = 400_000
"""Vehicles or pedestrians with more samples of the fine grid than this are judged some at a time. For
pedestrians, the samples beside each ego count as well."""


def prepare(run: RecordedRun, thresholds: Thresholds | None = None) -> Case:
    """Return the case of a recorded run."""
    rides = _rides(run, thresholds or Thresholds())
    return _case(rides, list(rides.crowd), find_encounters)


def prepare_in_parts(run: RecordedRun, thresholds: Thresholds) -> Iterator[Case]:
    """Yield cases of a recorded run, or of a part of it that :class:`analysis.recording.rides.Rides` gives.

    Each case holds the encounters with some of the pedestrians, and everything else of the run or part. There
    is at least one case.
    """
    rides = _rides(run, thresholds)
    for persons in rides.crowd.some(SAMPLES_AT_ONCE, rides.egos) if len(rides.crowd) else ([],):
        yield _case(rides, persons, find_encounters)


def prepare_traffic(run: RecordedRun, thresholds: Thresholds | None = None) -> Case:
    """Return the case of all traffic of a run, in which vehicles take the place of egos.

    Parameters
    ----------
    run : RecordedRun
        All or a part of what :class:`analysis.recording.traffic.Traffic` gives.
    thresholds : Thresholds
    """
    rides = _rides(run, thresholds or Thresholds())
    return _case(rides, list(rides.crowd), find_in_traffic)


@dataclass(frozen=True, slots=True)
class _Rides:
    """What the cases of a run have in common."""

    run: RecordedRun
    thresholds: Thresholds
    grid: Grid
    egos: Sequence[Track]
    bystanders: EgoTracks
    crowd: Tracks
    vehicles: Tracks
    traversals: Mapping[tuple[str, str], Sequence[Traversal]]
    steps: EgoSteps
    overlaps: Sequence[VehicleOverlap]
    vehicle_conflicts: Sequence[VehicleConflict]
    knowledge: Mapping[tuple[str, str], Knowledge] | None


def _rides(run: RecordedRun, thresholds: Thresholds) -> _Rides:
    grid = make_grid(run, thresholds)
    egos = list(EgoTracks(run, run.egos, grid, thresholds))
    vehicles = Tracks(run, grid, "vehicle")
    overlaps, conflicts = _with_vehicles(egos, vehicles, run, grid, thresholds)
    bystanders = run.egos.picked(np.empty(0, np.int64)) if run.bystanders is None else run.bystanders
    return _Rides(
        run=run,
        thresholds=thresholds,
        grid=grid,
        egos=egos,
        bystanders=EgoTracks(run, bystanders, grid, thresholds),
        crowd=Tracks(run, grid, "pedestrian"),
        vehicles=vehicles,
        traversals=traversals(egos, run, grid),
        steps=ego_steps(run, egos, grid, thresholds),
        overlaps=overlaps,
        vehicle_conflicts=conflicts,
        knowledge=knowledge_of(run),
    )


def _with_vehicles(
    egos: Sequence[Track], vehicles: Tracks, run: RecordedRun, grid: Grid, thresholds: Thresholds
) -> tuple[list[VehicleOverlap], list[VehicleConflict]]:
    """Return the overlaps and conflicts of egos with other vehicles."""
    overlaps: list[VehicleOverlap] = []
    conflicts: list[VehicleConflict] = []
    crossed: dict[tuple[int, int], Encroachment] = {}
    near: list[int] = []
    own, within_s = [way_of(ego) for ego in egos], thresholds.severity_ttc_slight_s
    for ways in vehicles.ways(SAMPLES_AT_ONCE):
        crossed |= encroachments(own, ways, grid, run.levels, thresholds, run.largest[0])
        near += [to for to, way in ways.items() if any(may_be_near(one, way, within_s) for one in own)]
    chosen = sorted({*near, *(to for _, to in crossed)})
    first, last = min((ego.first for ego in egos), default=0), max((ego.last for ego in egos), default=0)
    for some in vehicles.beside(chosen, SAMPLES_AT_ONCE, first, last):
        overlaps += find_overlaps(egos, list(some.values()), grid, run.levels)
        conflicts += find_vehicle_conflicts(egos, some, crossed, grid, run.levels, thresholds)
    return vehicle_overlaps.in_order(overlaps), vehicle_conflicts.in_order(conflicts)


def _case(
    rides: _Rides,
    persons: Sequence[Track],
    find: Callable[[Sequence[Track], Sequence[Track], Surroundings], list[Encounter]],
) -> Case:
    run, grid, thresholds = rides.run, rides.grid, rides.thresholds
    kinds = {area.name: area.crossing_kind for area in run.crossings()}
    encounters = find(rides.egos, persons, Surroundings(run, grid, thresholds, rides.traversals, kinds))
    samples = gather(encounters, run, grid, thresholds)
    areas = [one.area for one in encounters]
    contacts = _once(
        find_contacts(samples, thresholds.contact_separation_s, thresholds.standing_speed_mps),
        encounters,
        thresholds.contact_separation_s,
    )
    return Case(
        run=run,
        thresholds=thresholds,
        grid=grid,
        egos=rides.egos,
        persons=persons,
        crowd=rides.crowd,
        vehicles=rides.vehicles,
        bystanders=rides.bystanders,
        traversals=rides.traversals,
        encounters=encounters,
        samples=samples,
        predicted=predict_area(samples, thresholds.longitudinal_angle_deg),
        contacts=contacts,
        replays=_replays(rides, encounters, contacts),
        approach=closest_approaches(samples),
        steps=rides.steps,
        overlaps=rides.overlaps,
        vehicle_conflicts=rides.vehicle_conflicts,
        ego_rows=[_ego_rows(one, grid) for one in encounters],
        ego_enter=np.array([np.nan if area is None else area.ego.enter for area in areas]),
        ego_leave=np.array([np.nan if area is None else area.ego.leave for area in areas]),
        person_enter=np.array([np.nan if area is None else area.person.enter for area in areas]),
        person_leave=np.array([np.nan if area is None else area.person.leave for area in areas]),
        knowledge=rides.knowledge,
        entered=_entered(encounters, samples, contacts),
    )


def _entered(encounters: Sequence[Encounter], samples: Samples, contacts: Sequence[Contact]) -> BoolArray:
    entered = np.array([one.area is not None for one in encounters], dtype=np.bool_)
    entered |= samples.any(samples.exposed)
    entered[[contact.encounter for contact in contacts if not contact.standing]] = True
    return entered


def _once(contacts: Sequence[Contact], encounters: Sequence[Encounter], separation_s: float) -> list[Contact]:
    """Return each contact of a pair once: two encounters of one pair may hold the same instant.

    Of contacts that are the same, the one with a moving ego is kept, else that of an encounter with a
    conflict area, else that of the first encounter.
    """

    def rank(contact: Contact) -> tuple[bool, bool, int]:
        return contact.standing, encounters[contact.encounter].area is None, contact.encounter

    kept: dict[tuple[str, str], list[Contact]] = {}
    for contact in sorted(contacts, key=rank):
        one = encounters[contact.encounter]
        others = kept.setdefault((one.ego.name, one.person.name), [])
        if all(
            other.encounter == contact.encounter
            or contact.began - other.ended >= separation_s
            or other.began - contact.ended >= separation_s
            for other in others
        ):
            others.append(contact)
    chosen = {contact for some in kept.values() for contact in some}
    return [contact for contact in contacts if contact in chosen]


def _replays(
    rides: _Rides, encounters: Sequence[Encounter], contacts: Sequence[Contact]
) -> Mapping[Contact, Replay]:
    limits = rides.run.egos.numbers["speed_limit_mps"]
    there = _there(rides.vehicles, rides.egos, rides.bystanders)
    found = {}
    for contact in contacts:
        one = encounters[contact.encounter]
        found[contact] = replay_contact(
            one.ego, one.person, contact, limits[one.ego.rows], there, rides.grid, rides.thresholds
        )
    return found


def _there(vehicles: Tracks, egos: Sequence[Track], bystanders: EgoTracks) -> There:
    """Return a function that gives the vehicles and the egos recorded between two samples."""

    def there(first: int, last: int) -> list[Track]:
        own = [track for track in egos if track.first <= last and first <= track.last]
        return [*vehicles.during(first, last), *own, *bystanders.during(first, last)]

    return there


def _ego_rows(encounter: Encounter, grid: Grid) -> IntArray:
    last = encounter.last
    if encounter.area is not None:
        last = min(last, encounter.ego.first + encounter.area.ego.last + 1)
    last = max(last, encounter.first)
    # The first recorded instant at or after the beginning.
    first = -(-encounter.first // grid.factor) * grid.factor
    index = np.arange(first, last + 1, grid.factor) - encounter.ego.first
    rows = encounter.ego.rows[index[index < len(encounter.ego.rows)]]
    return np.asarray(rows)
