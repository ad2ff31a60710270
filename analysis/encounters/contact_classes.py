"""Classes of contacts: place, the party that moved into the other, and whether the ego could be at fault.

The classes follow from geometry and recorded motion alone; right of way plays no part.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.arrays import FloatArray
from analysis.encounters.careful_driver import Replay, eye_of
from analysis.encounters.contacts import Contact
from analysis.encounters.line_of_sight import is_visible
from analysis.encounters.moments import stopping_distance
from analysis.geometry import signed_distance, to_frame
from analysis.recording.fine_grid import Grid
from analysis.recording.tracks import There, Track
from analysis.thresholds import Thresholds

CLASSES = ("ego", "rolled_off", "walked_in", "appeared", "touching_at_start")
MOVERS = ("ego", "pedestrian", "both")

_STOOD_S = 0.5
"""An ego counts as having stood at a contact if it had stood for this long [s]."""
_SMALL_SHARE = 0.1
"""A party that closed at most this share of the last gap did not move into the other."""


@dataclass(frozen=True, slots=True)
class Circumstances:
    """One contact and the two tracks that touched."""

    ego: Track
    person: Track
    contact: Contact
    replay: Replay
    grid: Grid
    thresholds: Thresholds

    @property
    def first(self) -> int:
        """Fine index of the first sample at which both are recorded."""
        return max(self.ego.first, self.person.first)


def contact_class(one: Circumstances, vehicles: There) -> str:
    """Return the class of a contact.

    ``touching_at_start``
        They touch in the first sample that holds both.
    ``walked_in``
        The ego had stood for 0.5 s when they touched, and did not move while they did.
    ``rolled_off``
        The ego had stood for 0.5 s when they touched, and then began to move while they still did.
    ``appeared``
        The careful driver does not prevent it, and at the first sample that holds both, the pedestrian was in
        view and nearer than that driver's stopping distance: they appeared suddenly in the recording, not
        from behind a vehicle.
    ``ego``
        Any other contact.
    """
    if one.contact.began <= one.grid.time[one.first] + 1e-9:
        return "touching_at_start"
    if _had_stood(one):
        return "walked_in" if one.contact.standing else "rolled_off"
    if not one.replay.prevented and _appeared(one, vehicles):
        return "appeared"
    return "ego"


def _had_stood(one: Circumstances) -> bool:
    time = one.grid.time[one.ego.first : one.ego.last + 1]
    before = (time >= one.contact.began - _STOOD_S - 1e-9) & (time <= one.contact.began + 1e-9)
    return bool(np.all(one.ego.speed[before] <= one.thresholds.standing_speed_mps))


def _appeared(one: Circumstances, vehicles: There) -> bool:
    limits = one.thresholds
    own, other = slice(*_at(one.ego, one.first)), slice(*_at(one.person, one.first))
    needed = stopping_distance(
        one.ego.speed[own], limits.r157_reaction_s, limits.r157_deceleration_mps2, limits.r157_ramp_s
    )
    if _gap(one.ego, own.start, one.person, other.start) >= needed[0]:
        return False
    eye_x, eye_y = eye_of(one.ego, own, limits)
    others = [vehicle for vehicle in vehicles(one.first, one.first) if vehicle.name != one.ego.name]
    seen = is_visible(eye_x, eye_y, one.person.x[other], one.person.y[other], one.first, others)
    return bool(seen[0])


def _at(track: Track, index: int) -> tuple[int, int]:
    return index - track.first, index - track.first + 1


def moved_by(one: Circumstances) -> str | None:
    """Return the party whose motion closed the last gap; ``None`` if no sample before the contact holds both.

    What each party closed is computed with the other held still. A party that closed at most a tenth of the
    sum of both did not move into the other.
    """
    after = int(np.searchsorted(one.grid.time, one.contact.began - 1e-9))
    before = after - 1
    if before < one.first:
        return None
    own, other = before - one.ego.first, before - one.person.first
    gap = _gap(one.ego, own, one.person, other)
    by_ego = max(gap - _gap(one.ego, own + 1, one.person, other), 0.0)
    by_person = max(gap - _gap(one.ego, own, one.person, other + 1), 0.0)
    if by_person <= _SMALL_SHARE * (by_ego + by_person):
        return "ego"
    return "pedestrian" if by_ego <= _SMALL_SHARE * (by_ego + by_person) else "both"


def _gap(ego: Track, own: int, person: Track, other: int) -> float:
    """Return the distance between the surfaces at two samples, negative where they overlap [m]."""
    x, y = to_frame(person.x[other] - ego.x[own], person.y[other] - ego.y[own], ego.heading[own])
    outside: FloatArray = signed_distance(x, y, 0.5 * ego.length, 0.5 * ego.width)
    return float(outside) - 0.5 * person.width
