"""Stops of an ego with its body over a crossing, and whether they could have been foreseen.

A stop is *foreseeable* if a standing road user was already in the ego's way at the last instant at which
the ego could have stopped before the crossing with the comfortable deceleration. The way is what the body
sweeps from the crossing's near edge until it has left the crossing, continued straight on if the ego never
left it. Road users who moved at that instant do not count, so this is a lower bound.
"""

from __future__ import annotations

import numpy as np

from analysis.encounters.crossings import Traversal
from analysis.encounters.driven_path import DrivenPath, driven_path
from analysis.geometry import clearance, rectangle_separation, to_frame
from analysis.recording.fine_grid import Grid
from analysis.recording.tracks import There, Track
from analysis.stretches import stretches
from analysis.thresholds import Thresholds


def count_stops(passage: Traversal, grid: Grid, limits: Thresholds) -> int:
    """Return how often the ego stopped during a passage."""
    first, last = passage.visit.first, passage.visit.last
    time = grid.time[passage.track.first + first : passage.track.first + last + 1]
    stands = stretches(passage.track.speed[first : last + 1] <= limits.standing_speed_mps)
    return sum(bool(time[end] - time[start] >= limits.stopped_on_crossing_s) for start, end in stands)


def was_foreseeable(passage: Traversal, vehicles: There, persons: There, limits: Thresholds) -> bool:
    """Return whether a road user stood in the way when the ego could last have stopped before the crossing.

    Parameters
    ----------
    passage : Traversal
        Passage during which the ego stopped.
    vehicles, persons : There
        All road users; the ego itself is left out of the vehicles.
    limits : Thresholds
    """
    ego = passage.track
    decided = _last_chance(passage, limits.comfort_deceleration_mps2)
    if decided is None:
        return False
    way = _way_over(passage)
    instant = ego.first + decided
    others = (
        *(one for one in vehicles(instant, instant) if one.name != ego.name),
        *persons(instant, instant),
    )
    there = [(one, instant - one.first) for one in others if one.first <= instant <= one.last]
    return any(one.speed[at] <= limits.standing_speed_mps and _is_in(way, one, at) for one, at in there)


def _last_chance(passage: Traversal, deceleration: float) -> int | None:
    """Return the last sample before the passage from which the ego could stop in time, or ``None``."""
    ego, entered = passage.track, passage.visit.first
    left = ego.path[entered] - ego.path[:entered]
    able = np.flatnonzero(left >= ego.speed[:entered] ** 2 / (2.0 * deceleration))
    return int(able[-1]) if len(able) else None


def _way_over(passage: Traversal) -> DrivenPath:
    ego, visit = passage.track, passage.visit
    left_it = not np.isnan(visit.leave)
    end = ego.path[visit.last] if left_it else ego.path[visit.last] + ego.length
    return driven_path(ego, ego.length).between(float(ego.path[visit.first]), float(end))


def _is_in(way: DrivenPath, one: Track, at: int) -> bool:
    """Return whether a vehicle, or a pedestrian (whose heading is undefined), touches a swept way."""
    if np.isnan(one.heading[at]):
        x, y = to_frame(one.x[at] - way.x, one.y[at] - way.y, way.heading)
        apart = clearance(x, y, 0.5 * way.length, 0.5 * way.width, 0.5 * one.width)
        return bool((apart <= 0.0).any())
    x, y, heading = (np.full_like(way.x, value[at]) for value in (one.x, one.y, one.heading))
    gap, _ = rectangle_separation(
        way.x, way.y, way.heading, way.length, way.width, x, y, heading, one.length, one.width
    )
    return bool((gap <= 0.0).any())
