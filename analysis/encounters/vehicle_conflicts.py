"""Conflicts of egos with other vehicles that came close to them, behind, ahead, beside or across.

A braking ego passes the risk of a rear-end collision on to the traffic behind it; the pairs in which the
other vehicle follows show this. Each pair counts as one conflict for each kind in which it came within the
limits:

- ``followed``: the other vehicle drives behind the ego in about its direction, and their bodies overlap
  laterally; ``following``: the ego drives behind it;
- ``beside``: about the same direction, without such an overlap;
- ``oncoming``: about opposite directions; ``crossing``: any other angle.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.encounters.vehicle_encroachment import Encroachment
from analysis.geometry import to_frame, turned
from analysis.recording.fine_grid import Grid
from analysis.recording.levels import Levels
from analysis.recording.tracks import Track, Way
from analysis.thresholds import DRAC_LIMIT_MPS2, Thresholds

FOLLOWED, FOLLOWING, BESIDE, ONCOMING, CROSSING = KINDS = (
    "followed",
    "following",
    "beside",
    "oncoming",
    "crossing",
)

_STILL_MPS = 1e-12


@dataclass(frozen=True, slots=True)
class VehicleConflict:
    """One ego and one vehicle in one kind of conflict."""

    ego_id: str
    vehicle_id: str
    vehicle_type: str
    kind: str
    start: float
    """First sample within the limits [s]."""
    end: float
    min_ttc: float
    """inf without a collision course [s]."""
    at: float
    """Time of the smallest TTC; without a TTC, time at which the ego was on the ground of the PET [s]."""
    max_drac: float
    """DRAC of the follower; nan for other kinds, and if the two overlapped throughout [m/s^2]."""
    pet: float
    """nan for kinds other than crossing, and if the two share no ground within the limit [s]."""
    ego_speed: float
    """Both speeds are those at ``at``; without a TTC, the vehicle's is that on the PET's ground [m/s]."""
    vehicle_speed: float
    ego_deceleration: float
    """Hardest braking of the ego from ``start`` to ``end`` [m/s^2]."""
    x: float
    """Centre of the ego at ``at`` [m]."""
    y: float


def find_vehicle_conflicts(
    egos: Sequence[Track],
    vehicles: Mapping[int, Track],
    crossed: Mapping[tuple[int, int], Encroachment],
    grid: Grid,
    levels: Levels,
    thresholds: Thresholds,
) -> list[VehicleConflict]:
    """Return all conflicts, sorted by time and names.

    A pair is in conflict if its TTC or, for crossing pairs, its PET is at most the limit of slight severity,
    or if the follower would have to brake harder than the limit of DRAC.

    Parameters
    ----------
    egos
    vehicles
        Their tracks by number; the parts recorded at the same time as an ego are enough.
    crossed
        Encroachments of the pairs that crossed each other's path, by numbers of ego and vehicle.
    grid, levels, thresholds
    """
    found: list[VehicleConflict] = []
    for i, ego in enumerate(egos):
        for j, vehicle in vehicles.items():
            if vehicle.name != ego.name:
                found.extend(_of_pair(ego, vehicle, crossed.get((i, j)), grid, levels, thresholds))
    return in_order(found)


def may_be_near(ego: Way, vehicle: Way, within_s: float) -> bool:
    """Return whether the two may overlap or be within the limits at some time.

    Only samples at which one of the two moved are checked: while both stand, nothing changes. This is done
    only for a vehicle that stood most of the time and has few such samples; any other one may be near.
    """
    if not vehicle.stood:
        return True
    first, last = max(ego.fine[0], vehicle.fine[0]), min(ego.fine[-1], vehicle.fine[-1])
    fine = np.concatenate([[first], ego.fine, vehicle.fine])
    fine = fine[(fine >= first) & (fine <= last)]
    a, b = (np.searchsorted(one.fine, fine, "right") - 1 for one in (ego, vehicle))
    return bool(_near(ego, a, vehicle, b, within_s).any())


def in_order(found: Iterable[VehicleConflict]) -> list[VehicleConflict]:
    """Return conflicts by time and names."""
    return sorted(found, key=lambda one: (one.start, one.ego_id, one.vehicle_id, one.kind))


@dataclass(frozen=True, slots=True)
class _Together:
    """Samples at which both are recorded near each other."""

    fine: IntArray
    """Fine index."""
    own: IntArray
    other: IntArray


def _of_pair(
    ego: Track,
    vehicle: Track,
    crossed: Encroachment | None,
    grid: Grid,
    levels: Levels,
    thresholds: Thresholds,
) -> list[VehicleConflict]:
    found: list[VehicleConflict] = []
    pet = np.nan if crossed is None else crossed.pet
    both = _closing(ego, vehicle, levels, thresholds.severity_ttc_slight_s)
    if both is not None:
        ttc = _times_to_collision(ego, vehicle, both)
        kinds, drac = _kinds(ego, vehicle, both, thresholds.longitudinal_angle_deg)
        close = (ttc <= thresholds.severity_ttc_slight_s) | (drac > DRAC_LIMIT_MPS2)
        for number, kind in enumerate(KINDS):
            chosen = np.flatnonzero(close & (kinds == number))
            if len(chosen):
                own_pet = pet if kind == CROSSING else np.nan
                found.append(_describe(ego, vehicle, grid, both, chosen, kind, ttc, drac, own_pet))
    if crossed is not None and all(one.kind != CROSSING for one in found):
        found.append(_crossed(ego, vehicle, grid, crossed))
    return found


def _closing(ego: Track, vehicle: Track, levels: Levels, within_s: float) -> _Together | None:
    """Return the samples at which the two may be within the limits; ``None`` if there are none."""
    first, last = max(ego.first, vehicle.first), min(ego.last, vehicle.last)
    if first > last:
        return None
    a = slice(first - ego.first, last - ego.first + 1)
    b = slice(first - vehicle.first, last - vehicle.first + 1)
    near = _near(ego, a, vehicle, b, within_s) & ~levels.apart[ego.level[a], vehicle.level[b]]
    fine = np.flatnonzero(near) + first
    return _Together(fine, fine - ego.first, fine - vehicle.first) if len(fine) else None


def _near(
    ego: Track | Way, a: slice | IntArray, vehicle: Track | Way, b: slice | IntArray, within_s: float
) -> BoolArray:
    """Return at which of the given samples the two may be within the limits."""
    reach = 0.5 * float(np.hypot(ego.length, ego.width) + np.hypot(vehicle.length, vehicle.width))
    apart = np.hypot(ego.x[a] - vehicle.x[b], ego.y[a] - vehicle.y[b])
    relative = np.hypot(ego.x_speed[a] - vehicle.x_speed[b], ego.y_speed[a] - vehicle.y_speed[b])
    # A DRAC above its limit means a TTC below the closing speed over twice the limit.
    within = np.maximum(within_s, relative / (2.0 * DRAC_LIMIT_MPS2))
    return np.asarray(apart <= reach + within * relative)


def _times_to_collision(ego: Track, vehicle: Track, both: _Together) -> FloatArray:
    """Return when the two rectangles touch if both keep velocity and heading; inf for never [s].

    Notes
    -----
    Two convex bodies in straight motion touch while their projections onto the normals of all their sides
    overlap: from the latest beginning of such an overlap to the earliest end.
    """
    dx, dy = vehicle.x[both.other] - ego.x[both.own], vehicle.y[both.other] - ego.y[both.own]
    u = vehicle.x_speed[both.other] - ego.x_speed[both.own]
    v = vehicle.y_speed[both.other] - ego.y_speed[both.own]
    turn = vehicle.heading[both.other] - ego.heading[both.own]
    cos, sin = np.abs(np.cos(turn)), np.abs(np.sin(turn))
    enter, leave = np.zeros(len(dx)), np.full(len(dx), np.inf)
    for one, heading, away in (
        (ego, ego.heading[both.own], vehicle),
        (vehicle, vehicle.heading[both.other], ego),
    ):
        along, across = to_frame(dx, dy, heading)
        along_speed, across_speed = to_frame(u, v, heading)
        for place, speed, reach in (
            (along, along_speed, 0.5 * (one.length + away.length * cos + away.width * sin)),
            (across, across_speed, 0.5 * (one.width + away.length * sin + away.width * cos)),
        ):
            moves = np.abs(speed) > _STILL_MPS
            divisor = np.where(moves, speed, 1.0)
            begin, end = (-reach - place) / divisor, (reach - place) / divisor
            inside = np.abs(place) <= reach
            enter = np.maximum(enter, np.where(moves, np.minimum(begin, end), np.where(inside, 0.0, np.inf)))
            leave = np.minimum(leave, np.where(moves, np.maximum(begin, end), np.inf))
    return np.where(enter <= leave, enter, np.inf)


def _kinds(ego: Track, vehicle: Track, both: _Together, angle_deg: float) -> tuple[IntArray, FloatArray]:
    """Return the number of the kind at each sample, and the DRAC of the follower; nan for other kinds."""
    heading, other_heading = ego.heading[both.own], vehicle.heading[both.other]
    turn = turned(heading, other_heading)
    limit = np.radians(angle_deg)
    kinds = np.full(len(turn), KINDS.index(CROSSING))
    kinds[turn <= limit] = KINDS.index(BESIDE)
    kinds[turn >= np.pi - limit] = KINDS.index(ONCOMING)
    drac = np.full(len(turn), np.nan)
    for kind, one, at, two, there in (
        (FOLLOWED, vehicle, both.other, ego, both.own),
        (FOLLOWING, ego, both.own, vehicle, both.other),
    ):
        # In the frame of the follower.
        frame = one.heading[at]
        along, across = to_frame(two.x[there] - one.x[at], two.y[there] - one.y[at], frame)
        cos, sin = np.abs(np.cos(turn)), np.abs(np.sin(turn))
        gap = along - 0.5 * (one.length + two.length * cos + two.width * sin)
        overlap = np.abs(across) < 0.5 * (one.width + two.length * sin + two.width * cos)
        closing = one.speed[at] - to_frame(two.x_speed[there], two.y_speed[there], frame)[0]
        behind: BoolArray = (turn <= limit) & overlap & (along > 0.0)
        kinds[behind] = KINDS.index(kind)
        needed = np.maximum(closing, 0.0) ** 2 / (2.0 * np.where(gap > 0.0, gap, 1.0))
        needed = np.where(gap > 0.0, needed, np.nan)
        drac[behind] = needed[behind]
    return kinds, drac


def _describe(
    ego: Track,
    vehicle: Track,
    grid: Grid,
    both: _Together,
    chosen: IntArray,
    kind: str,
    ttc: FloatArray,
    drac: FloatArray,
    pet: float,
) -> VehicleConflict:
    worst = int(chosen[np.argmin(ttc[chosen])])
    own, other = int(both.own[worst]), int(both.other[worst])
    stretch = slice(int(both.own[chosen[0]]), int(both.own[chosen[-1]]) + 1)
    follows = kind in (FOLLOWED, FOLLOWING)
    return VehicleConflict(
        ego_id=ego.name,
        vehicle_id=vehicle.name,
        vehicle_type=vehicle.kind,
        kind=kind,
        start=float(grid.time[both.fine[chosen[0]]]),
        end=float(grid.time[both.fine[chosen[-1]]]),
        min_ttc=float(ttc[worst]),
        at=float(grid.time[both.fine[worst]]),
        max_drac=float(np.fmax.reduce(drac[chosen])) if follows else np.nan,
        pet=pet,
        ego_speed=float(ego.speed[own]),
        vehicle_speed=float(vehicle.speed[other]),
        ego_deceleration=float(np.maximum(-ego.acceleration[stretch], 0.0).max()),
        x=float(ego.x[own]),
        y=float(ego.y[own]),
    )


def _crossed(ego: Track, vehicle: Track, grid: Grid, crossed: Encroachment) -> VehicleConflict:
    own = crossed.own - ego.first
    times = sorted((float(grid.time[crossed.own]), float(grid.time[crossed.other])))
    return VehicleConflict(
        ego_id=ego.name,
        vehicle_id=vehicle.name,
        vehicle_type=vehicle.kind,
        kind=CROSSING,
        start=times[0],
        end=times[1],
        min_ttc=np.inf,
        at=float(grid.time[crossed.own]),
        max_drac=np.nan,
        pet=crossed.pet,
        ego_speed=float(ego.speed[own]),
        vehicle_speed=crossed.speed,
        ego_deceleration=float(max(-ego.acceleration[own], 0.0)),
        x=float(ego.x[own]),
        y=float(ego.y[own]),
    )
