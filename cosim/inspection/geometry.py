"""Findings on where SUMO places people and cars: waiting places, bends, and areas swept by turning cars."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from analysis.polylines import inside
from cosim.arrays import FloatArray
from cosim.inspection.finding import Finding, Level
from cosim.inspection.ways import CAR
from cosim.sensing.lines_of_sight import distance_to_pieces
from cosim.sumo.bends import CAR as CAR_TURNING
from cosim.sumo.bends import widened
from cosim.sumo.network import TURNAROUND, Connection, NetCrossing, Network, junction_of
from cosim.sumo.path import Path

HALF_CAR = 0.9
PERSON = 0.25
"""Radius of a person [m]."""
LENGTH, REAR_OVERHANG = 4.5, 0.95
"""Length and rear overhang of a passenger car [m]."""
TIGHTEST = 3.8
"""Smallest radius that the middle of a passenger car's rear axle can drive: 2.6 m / tan 0.6 rad [m]."""
OUTSIDE = 0.3
"""SUMO's pedestrians wait this far before the crossing [m]."""
STRIPE = 0.32
"""Half the width that SUMO gives a pedestrian [m]."""
SWEPT = 0.2
"""Cars that reach less than this into a walking area do not count [m]."""
_APPROACH = 12.0
"""Length of the lanes before and behind a junction that is examined with a way through it [m]."""


def waiting_places(network: Network) -> list[Finding]:
    """Return findings on crossings where waiting pedestrians stand in a car lane.

    They do if their place is nearer to a car lane's centre line than half the width of a car plus the radius
    of a person, 1.15 m in all.
    """
    ends = [(name, end) for name in network.crossings for end in (0, -1)]
    if not ends:
        return []
    lanes = _car_segments(network)
    bad = [
        name
        for name, end in ends
        if _nearest(waiting_at(network.crossings[name], end), lanes) < HALF_CAR + PERSON
    ]
    if not bad:
        return [Finding("waiting places", Level.GOOD, f"none of {len(ends)} is in a car lane")]
    text = (
        f"{len(bad)} of {len(ends)} places where pedestrians wait for a crossing are in a car lane: "
        f"{_some(bad)}. SUMO draws these crossings shorter than the road is wide, so that cars, including "
        "SUMO's own, meet waiting pedestrians there: give each <crossing> a shape from kerb to kerb "
        "(netedit), or evaluate contacts with waiting pedestrians separately"
    )
    return [Finding("waiting places", Level.NOTE, text)]


def waiting_at(crossing: NetCrossing, end: int) -> FloatArray:
    """Return where people wait at one end of a crossing: right, middle and left, (3, 2) [m].

    Parameters
    ----------
    crossing : the crossing
    end : 0 for the first point of its axis, −1 for the last
    """
    tip, inner = (crossing.axis[0], crossing.axis[1]) if end == 0 else (crossing.axis[-1], crossing.axis[-2])
    outward = (tip - inner) / max(float(np.hypot(*(tip - inner))), 1e-9)
    aside = max(0.5 * crossing.width - STRIPE, 0.0) * np.array([-outward[1], outward[0]])
    return np.asarray(tip + OUTSIDE * outward + np.array([[-1.0], [0.0], [1.0]]) * aside)


def tight_bends(network: Network) -> list[Finding]:
    """Report ways through junctions that bend more tightly than a passenger car can drive."""
    ways = list(_turning(network))
    if not ways:
        return []
    radii = {connection.via[0]: radius for connection, _, radius in ways}
    off = max((bend.off for _, path, _ in ways for bend in widened(path, CAR_TURNING)[1]), default=0.0)
    bad = sorted((name for name, radius in radii.items() if radius < TIGHTEST), key=lambda name: radii[name])
    if not bad:
        return [Finding("bends", Level.GOOD, f"a car can drive all {len(radii)} junction movements")]
    text = (
        f"{len(bad)} of {len(radii)} junction movements are tighter than a car can drive (radius below "
        f"{TIGHTEST:g} m): {_some(bad)}, {radii[bad[0]]:.1f} m. An ego takes a wider path there, up to "
        f"{off:.1f} m from its lane's centre line: give the junction a larger radius (netconvert "
        "--default.junctions.radius 8) or draw the lane wider (netedit)"
    )
    return [Finding("bends", Level.NOTE, text)]


def swept_walking_areas(network: Network) -> list[Finding]:
    """Report ways on which the body of a turning car reaches over a walking area, where people stand."""
    areas: dict[str, list[FloatArray]] = {}
    for area in network.walking_areas.values():
        areas.setdefault(area.name[1:].rpartition("_w")[0], []).append(area.outline)
    if not areas:
        return []
    bad: list[str] = []
    number = 0
    for connection, path, _ in _turning(network):
        number += 1
        near = areas.get(junction_of(connection.via[0]), [])
        body = swept(path)
        if any(inside(outline, body).any() for outline in near):
            bad.append(connection.via[0])
    if not bad:
        return [Finding("swept paths", Level.GOOD, "no turning car reaches over a walking area")]
    text = (
        f"on {len(bad)} of {number} junction movements the body of a car reaches over a walking area: "
        f"{_some(bad)}. It touches pedestrians who only wait there: give the junction a larger radius, or "
        "evaluate contacts on walking areas separately"
    )
    return [Finding("swept paths", Level.NOTE, text)]


def swept(path: Path) -> FloatArray:
    """Return the corners of a car whose rear axle follows a path, 0.2 m inside its sides, (n, 2) [m]."""
    along = np.asarray(path.along)
    heading = np.asarray(path.heading)
    middle = path.at(along, np.zeros(len(along)))
    forward = np.column_stack([np.cos(heading), np.sin(heading)])
    leftward = np.column_stack([-forward[:, 1], forward[:, 0]])
    corners = [
        middle + at * forward + side * (HALF_CAR - SWEPT) * leftward
        for at in (-REAR_OVERHANG, 0.0, LENGTH - REAR_OVERHANG - SWEPT)
        for side in (-1.0, 1.0)
    ]
    return np.concatenate(corners)


def _turning(network: Network) -> Iterator[tuple[Connection, Path, float]]:
    """Yield each way of cars through a junction, with its path and its smallest radius [m]."""
    for source, connections in network.connections.items():
        if source.startswith(":") or not network.lanes[source].permissions.allows(CAR):
            continue
        for one in connections:
            if not one.via or one.direction == TURNAROUND or not network.passable(one, CAR):
                continue
            before = _last(network.lanes[source].shape, _APPROACH)
            behind = _last(network.lanes[one.target].shape[::-1], _APPROACH)[::-1]
            inner = [network.lanes[name].shape for name in one.via]
            points = np.concatenate([before, *inner, behind])
            apart = np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 0.05])
            if apart.sum() < 3:
                continue
            path = Path.rounded(points[apart])
            yield one, path, 1.0 / max(float(np.abs(path.curvature).max()), 1e-6)


def _last(shape: FloatArray, length: float) -> FloatArray:
    """Return the last part of a shape, of the given length [m]; all of it if it is shorter."""
    pieces = np.hypot(*np.diff(shape, axis=0).T)
    gone = np.cumsum(pieces[::-1])
    count = int(np.searchsorted(gone, length)) + 1
    if count > len(pieces):
        return shape
    start, end = shape[-count - 1], shape[-count]
    rest = float(gone[count - 1]) - length
    first = start + (end - start) * rest / max(float(pieces[-count]), 1e-9)
    return np.concatenate([first[None, :], shape[-count:]])


def _car_segments(network: Network) -> FloatArray:
    """Return the segments of the centre lines of all car lanes, (n, 4) [m]."""
    shapes = [lane.shape for lane in network.lanes.values() if lane.permissions.allows(CAR)]
    return np.concatenate([np.zeros((0, 4)), *(np.hstack([shape[:-1], shape[1:]]) for shape in shapes)])


def _nearest(points: FloatArray, segments: FloatArray) -> float:
    """Return the smallest distance of any point from any segment [m]."""
    if not len(segments):
        return math.inf
    return min((distance_to_pieces(x, y, segments) for x, y in points.tolist()), default=math.inf)


def _some(names: Sequence[str]) -> str:
    """Return the first three different names.

    >>> _some(["a", "b", "b", "c", "d"])
    'a, b, c, …'
    """
    different = list(dict.fromkeys(names))
    return ", ".join(different[:3]) + (", …" if len(different) > 3 else "")
