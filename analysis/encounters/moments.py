"""Instants of an encounter that several metrics refer to: evasive action and entry; distances until then."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analysis.arrays import BoolArray, FloatArray
from analysis.encounters.case import Case
from analysis.encounters.crossing_walks import at_crossing
from analysis.encounters.finding import Encounter
from analysis.recording.tracks import Track
from analysis.stretches import stretches


@dataclass(frozen=True, slots=True)
class Ride:
    """A track as functions of time."""

    time: FloatArray
    path: FloatArray
    speed: FloatArray

    def way(self, start: float, end: float) -> float:
        """Return the length of the path between two instants [m]."""
        return float(np.interp(end, self.time, self.path) - np.interp(start, self.time, self.path))

    def speed_at(self, time: float) -> float:
        """Return the speed [m/s]."""
        return float(np.interp(time, self.time, self.speed))


def ride_of(case: Case, track: Track) -> Ride:
    """Return a track's path length and speed over time."""
    return Ride(case.grid.time[track.first : track.last + 1], track.path, track.speed)


def phase_samples(case: Case, encounter: Encounter, *phases: str) -> BoolArray:
    """Return where the person's track is in one of the phases at this encounter's crossing."""
    return at_crossing(encounter.person, case.run.neighbours, encounter.crossing_id, *phases)


def crossing_stay(case: Case, encounter: Encounter) -> tuple[int, int] | None:
    """Return first and last sample of the relevant stay of the person on the crossing.

    That is the stay around their time in the conflict area; without an area, the last stay of the encounter;
    ``None`` for a person who is not on the crossing then.
    """
    if not encounter.crossing_id:
        return None
    inside = phase_samples(case, encounter, "crossing")
    start, end = encounter.first - encounter.person.first, encounter.last - encounter.person.first
    if encounter.area is not None:
        start, end = encounter.area.person.first, encounter.area.person.last
    stays = [stay for stay in stretches(inside) if stay[0] <= end and start <= stay[1]]
    return stays[-1] if stays else None


@dataclass(frozen=True, slots=True)
class Evasion:
    """The beginning of the ego's evasive action."""

    time: FloatArray
    """nan if the ego took no such action and there was no TTC either [s]."""
    ego_speed: FloatArray
    ttc: FloatArray
    """inf without a collision course, nan where the pedestrian did not count yet [s]."""
    braked: BoolArray


def evasions(case: Case) -> Evasion:
    """Return when the ego begins to brake harder than the threshold, else the instant of the smallest TTC."""
    count = len(case)
    samples = case.samples
    time, speed, ttc = (np.full(count, np.nan) for _ in range(3))
    braked = np.zeros(count, dtype=np.bool_)
    low, at = samples.smallest(samples.ttc)
    for i, rows in enumerate(case.ego_rows):
        hard = np.flatnonzero(case.steps.deceleration[rows] > case.thresholds.evasive_deceleration_mps2)
        if len(hard):
            # The acceleration of a row is that of the step that ends there.
            begin = float(case.run.egos.numbers["time_s"][rows[max(int(hard[0]) - 1, 0)]])
            sample = int(samples.starts[i] + np.searchsorted(_own_time(case, i), begin - 1e-9))
            braked[i] = True
        elif np.isfinite(low[i]):
            sample = int(at[i])
        else:
            continue
        sample = min(sample, int(samples.starts[i]) + len(_own_time(case, i)) - 1)
        time[i], speed[i], ttc[i] = samples.time[sample], samples.ego_speed[sample], samples.ttc[sample]
    return Evasion(time, speed, ttc, braked)


def _own_time(case: Case, i: int) -> FloatArray:
    start = int(case.samples.starts[i])
    one = case.encounters[i]
    return case.samples.time[start : start + one.last - one.first + 1]


@dataclass(frozen=True, slots=True)
class Entries:
    """The instant at which each pedestrian could be seen entering, before the ego reached the area."""

    time: FloatArray
    """nan if the ego was in the area before, or if there is no area [s]."""
    distance: FloatArray
    """Distance of the ego from the conflict area at that instant, along its path [m]."""
    ego_speed: FloatArray


def entries(case: Case) -> Entries:
    """Return when each pedestrian stepped on the crossing; without a crossing, when the encounter began."""
    count = len(case)
    time, distance, speed = (np.full(count, np.nan) for _ in range(3))
    for i, one in enumerate(case.encounters):
        if one.area is None:
            continue
        stay = crossing_stay(case, one)
        begin = one.first if stay is None else one.person.first + stay[0]
        # A pedestrian who was on the crossing before the ego is recorded is seen when its recording begins.
        seen = float(case.grid.time[max(begin, one.ego.first)])
        if seen >= one.area.ego.enter:
            continue
        ride = ride_of(case, one.ego)
        time[i], distance[i] = seen, ride.way(seen, one.area.ego.enter)
        speed[i] = ride.speed_at(seen)
    return Entries(time, distance, speed)


def stopping_distance(speed: FloatArray, reaction: float, deceleration: float, ramp: float) -> FloatArray:
    """Return the distance to a standstill: reaction, linear rise of the braking, then constant braking [m].

    Examples
    --------
    >>> stopping_distance(np.array([20 / 3.6]), 0.75, 7.59, 0.6).round(2).tolist()
    [7.75]
    """
    jerk = deceleration / ramp if ramp > 0.0 else np.inf
    lost = 0.5 * deceleration * ramp
    within = np.sqrt(2.0 * speed / jerk)
    ramp_way = speed * ramp - jerk * ramp**3 / 6.0 if ramp > 0.0 else 0.0 * speed
    left = np.maximum(speed - lost, 0.0)
    full = ramp_way + left**2 / (2.0 * deceleration)
    short = speed * within - (jerk * within**3 / 6.0 if ramp > 0.0 else 0.0)
    return np.asarray(speed * reaction + np.where(speed < lost, short, full))
