"""Bends that are tighter than a vehicle can drive, and the way that it takes through them instead.

SUMO's lanes meet in junctions with any radius, down to a sharp corner. A car cuts such a corner with its rear
axle and swings out with its front. Where there is no room for a single arc, as in a hairpin, it swings out
before the bend. The way chosen is the one on which neither the rear axle nor the front bumper gets far from
the lanes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from analysis.polylines import arc_lengths
from controllers.interface import Body, Drive
from cosim.arrays import FloatArray
from cosim.step.plant import CAR_DRIVE
from cosim.sumo.arcs import Arcs, Pose, between
from cosim.sumo.path import SPACING, Path, evenly

RESERVE = 1.1
"""Bends are driven with this many times the vehicle's smallest radius, which leaves room to steer."""
APART = 3.0
"""Bends nearer to each other than this many of the vehicle's smallest radii count as one."""
REACH = 12.0
"""How far before and behind a bend the way may leave the lanes [m]."""
ANTICIPATION = 1.2
"""A way may be driven this many times as fast as wheels can be turned where it bends most suddenly: drivers
see the bend coming and turn them over a longer stretch."""
SLOWEST = 2.0
"""The steering rate never lowers the speed in a bend below this [m/s]."""
BEFORE = 2.5
"""Because paths are smooth, they bend from this far before a bend to this far behind it [m]."""
DETOUR = 2.0
"""A way longer than the shortest one by more than this many radii goes round in circles."""
FINE = 0.2
"""Spacing of the points on a way [m]."""
SOME = 8
"""A first, quick check of a way uses only one of this many points."""
LATER = 0.02
"""A way that leaves the lanes a metre later may get this much further away from them [m]."""
EVENED = 0.02
"""Weight of stations that grow evenly along the way, mixed in so that stations always increase."""


class Turning(NamedTuple):
    """The properties of a vehicle that determine how it gets round a bend."""

    radius: float
    """Smallest radius that the middle of its rear axle can follow [m]."""
    front: float
    """Distance from the rear axle to the front bumper [m]."""
    wheelbase: float
    """[m]"""
    rate: float
    """Highest rate at which its wheels are steered [rad/s]."""


@dataclass(frozen=True, slots=True)
class Bend:
    """A bend that is too tight, and the way through it."""

    start: float
    """Stations where the way leaves the lanes and where it returns to them [m]."""
    end: float
    off: float
    """Largest distance from the lanes that the middle of the rear axle or front bumper reaches [m]."""
    points: FloatArray
    """(n, 2) [m]"""
    stations: FloatArray
    """Station of each point: that of the place on the lanes beside it, (n,) [m]."""


def turning_of(body: Body, drive: Drive) -> Turning:
    """Return how tightly a vehicle turns.

    >>> round(turning_of(Body(), CAR_DRIVE).radius, 2)
    3.8
    """
    radius = body.wheelbase / math.tan(drive.max_steering)
    return Turning(radius, body.front, body.wheelbase, drive.max_steering_rate)


CAR = turning_of(Body(), CAR_DRIVE)


def widened(path: Path, turning: Turning) -> tuple[Path, tuple[Bend, ...]]:
    """Return a path that the vehicle can drive, and the bends that were redrawn for it.

    A path that the vehicle can already drive is returned unchanged.
    """
    tight = _tight(path, turning)
    if not tight:
        return path, ()
    # Two neighbouring bends share the stretch between them equally.
    halves = [0.5 * (one.last + other.first) for one, other in pairwise(tight)]
    lows = [float(path.stations[1]), *(half + 0.5 * SPACING for half in halves)]
    highs = [*(half - 0.5 * SPACING for half in halves), float(path.stations[-2])]
    bends = [
        _drawn_anew(path, *one, turning) for one in zip(tight, zip(lows, highs, strict=True), strict=True)
    ]
    samples: list[FloatArray] = []
    stations: list[FloatArray] = []
    done = 0
    for bend in bends:
        # Where samples and points meet, they are about as far apart as elsewhere.
        begin, end = np.searchsorted(path.stations, [bend.start - 0.5 * SPACING, bend.end + 0.5 * SPACING])
        samples += [path.samples[done:begin], bend.points]
        stations += [path.stations[done:begin], bend.stations]
        done = int(end)
    samples.append(path.samples[done:])
    stations.append(path.stations[done:])
    return Path.through(np.concatenate(samples), np.concatenate(stations)), tuple(bends)


def highest_speed(path: Path, start: float, end: float, turning: Turning) -> float:
    """Return how fast a part of a path [m] can be driven, given how fast the wheels can be steered [m/s]."""
    part = (path.along > start) & (path.along < end)
    angles = np.arctan(turning.wheelbase * path.curvature)
    fastest = float(np.abs(np.gradient(angles, path.along)[part]).max(initial=0.0))
    return max(ANTICIPATION * turning.rate / max(fastest, 1e-6), SLOWEST)


class _Tight(NamedTuple):
    """The stretch in which a path bends too tightly; stations [m]."""

    first: float
    middle: float
    last: float


def _tight(path: Path, turning: Turning) -> list[_Tight]:
    """Return the bends that are too tight."""
    tight = np.flatnonzero(np.abs(path.curvature) * turning.radius > 1.0)
    if not len(tight):
        return []
    gaps = np.flatnonzero(np.diff(path.along[tight]) > APART * turning.radius)
    found = []
    for bend in np.split(tight, gaps + 1):
        stations, weights = path.stations[bend], np.abs(path.curvature[bend]) * turning.radius - 1.0
        # Unlike the place of the largest curvature, the mean does not depend on where samples happen to be.
        middle = float(np.average(stations, weights=weights))
        found.append(_Tight(float(stations[0]), middle, float(stations[-1])))
    return found


def _drawn_anew(path: Path, tight: _Tight, room: tuple[float, float], turning: Turning) -> Bend:
    """Return a bend with the best way through it.

    Parameters
    ----------
    path
    tight : the bend
    room : stations between which the way may leave the lanes [m]
    turning
    """
    least = math.inf
    half = max(tight.last - tight.middle, tight.middle - tight.first)
    steps = range(math.floor(half / SPACING) + 1, math.ceil((half + REACH) / SPACING) + 1)
    for reach in (SPACING * step for step in steps):
        begin, end = max(tight.middle - reach, room[0]), min(tight.middle + reach, room[1])
        near = _between(path, begin - SPACING, end + 2.0 * turning.front)
        start = _pose(path, begin)
        for way in _ways(start, _pose(path, end), turning):
            points, headings = way.places(start, FINE)
            fronts = points + turning.front * np.column_stack([np.cos(headings), np.sin(headings)])
            swept = np.concatenate([points, fronts])
            # Most ways are already too far from the lanes at one of a few points.
            if _on_lanes(path, swept[::SOME], near)[0].max() + LATER * reach >= least:
                continue
            away, beside = _on_lanes(path, swept, near)
            cost = float(away.max()) + LATER * reach
            if cost < least:
                least, found = cost, (begin, end, points, beside[: len(points)], float(away.max()))
    begin, end, points, beside, off = found
    beside = np.clip(beside, begin, end)
    beside[0], beside[-1] = begin, end
    gone = arc_lengths(points)
    grid = evenly(float(gone[-1]))
    drawn = np.column_stack([np.interp(grid, gone, points[:, axis]) for axis in (0, 1)])
    return Bend(begin, end, off, drawn, np.interp(grid, gone, _stations(gone, beside)))


def _between(path: Path, begin: float, end: float) -> slice:
    """Return the samples between two stations [m]."""
    first, last = np.searchsorted(path.stations, [begin, end])
    return slice(max(int(first) - 1, 0), int(last) + 1)


def _pose(path: Path, station: float) -> Pose:
    """Return place and direction of the lanes at a station [m]."""
    x, y, heading = (
        float(np.interp(station, path.stations, values)) for values in (*path.samples.T, path.heading)
    )
    return Pose(x, y, heading)


def _ways(start: Pose, end: Pose, turning: Turning) -> list[Arcs]:
    """Return the ways worth considering: those that do not go round in circles."""
    ways = list(between(start, end, RESERVE * turning.radius))
    longest = min(way.length for way in ways) + DETOUR * turning.radius
    return [way for way in ways if way.length <= longest]


def _on_lanes(path: Path, points: FloatArray, near: slice) -> tuple[FloatArray, FloatArray]:
    """Return how far points (n, 2) are from the lanes [m], and the stations where they are nearest [m].

    Parameters
    ----------
    path
    points
    near : samples of the path to compare with
    """
    line, stations = path.samples[near], path.stations[near]
    # Axes are treated separately: sums over pairs of coordinates take several times as long.
    x_steps, y_steps = np.diff(line, axis=0).T
    x_rest, y_rest = points.T[:, :, None] - line.T[:, None, :-1]
    share = np.clip((x_rest * x_steps + y_rest * y_steps) / (x_steps**2 + y_steps**2), 0.0, 1.0)
    away = np.hypot(x_rest - share * x_steps, y_rest - share * y_steps)
    nearest = away.argmin(axis=1)
    rows = np.arange(len(points))
    station = stations[nearest] + share[rows, nearest] * np.diff(stations)[nearest]
    return away[rows, nearest], station


def _stations(gone: FloatArray, beside: FloatArray) -> FloatArray:
    """Return increasing stations of points on a way [m].

    Parameters
    ----------
    gone : distances along the way (n,) [m]
    beside : stations of the nearest places on the lanes (n,) [m]
    """
    # Where a way swings out of a hairpin, the places beside it jump or go back; stations must not.
    onward = np.maximum.accumulate(beside)
    evened = onward[0] + (onward[-1] - onward[0]) * gone / gone[-1]
    return np.asarray((1.0 - EVENED) * onward + EVENED * evened)
