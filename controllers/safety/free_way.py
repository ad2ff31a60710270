"""The search for a way at walking pace round standing people and vehicles.

The search starts at the rear axle and continues every way by arcs of equal length, one for each of several
steering angles. It keeps the arcs that touch nobody and end near the lane, and of those that end in a small
cell the cheapest. After some metres, the cheapest way is the answer. The arcs are short, so that a car can
turn between two people, and the distance from the lane's centre line costs, so that the ego comes back to it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.geometry.box_clearances import Boxes, box_clearances
from controllers.geometry.path_clearance import disc_clearances
from controllers.geometry.plane import to_plane
from controllers.interface import Body, EgoState, Perception, RoadAhead

ARC, REACH = 0.5, 12.0
"""Length of an arc, and of the way that is searched for [m]."""
WITHIN_ARC = 0.25, 0.5, 0.75
"""Shares of an arc at which the body is checked too. A front corner moves up to 0.8 m along an arc, past
somebody and clear of them again; between these places, it comes nearer by less than ``DRIFT`` [-]."""
SHORTEST, SHORTEST_OFF = 6.0, 2.0
"""Least length of a way, and of one that leads the car away from people who lean on it [m]."""
ANGLES = 13
"""Number of steering angles tried for an arc, evenly spaced from right to left [-]."""
ASIDE = 1.8
"""The rear axle may be up to this far beside the lane's centre line [m]."""
IN_LANE = 0.1
"""The front bumper must overlap the lane by this much, as SUMO cannot place a vehicle beside it [m]."""
KEPT = 400
"""Number of ways that are followed at a time [-]."""
DRIFT = 0.03
"""When a way is driven, it may come nearer to obstacles than planned by this much, see ``drifted`` [m]."""
CELL, CELL_TURNED = 0.2, 0.05
"""Size of the cells in which poses count as the same [m, rad]."""
CELLS = 10_000
"""No way has this many cells in one direction [-]."""
OFF_LANE, TURNED, STEERED = 1.0, 2.0, 0.1
"""Costs of a metre driven 1 m beside the centre line, of a metre at 1 rad to it, and of 1 rad of steering."""
CROWDED, CROWD = 0.4, 2.0
"""Driving nearer than this to an obstacle costs more [m], and so much more per metre at distance 0 [1/m]."""


class Obstacles(NamedTuple):
    """What the body may not touch, in the plane of :mod:`controllers.geometry.plane`: n discs and v boxes."""

    x: FloatArray
    """Centres of the discs, shape (n,) [m]."""
    y: FloatArray
    kept: FloatArray
    """Radius of each disc plus the distance kept to it, shape (n,) [m]."""
    boxes: Boxes
    kept_to_boxes: FloatArray
    """Distance kept to each box, shape (v,) [m]."""
    until: FloatArray
    """Length of the way up to which each box counts, as vehicles that drive are then gone, shape (v,) [m]."""

    def after(self, gone: float) -> Obstacles:
        """Return those that still count after this length of the way [m]."""
        left = self.until > gone
        if left.all():
            return self
        boxes = Boxes(*(values[left] for values in self.boxes))
        return self._replace(boxes=boxes, kept_to_boxes=self.kept_to_boxes[left], until=self.until[left])


class _Line(NamedTuple):
    """Places and headings of the lane's centre line, shape (k,) each."""

    x: FloatArray
    y: FloatArray
    heading: FloatArray


class _Poses(NamedTuple):
    """Poses at the ends of the ways found so far; shape (m,) each."""

    x: FloatArray
    y: FloatArray
    heading: FloatArray
    steering: FloatArray
    """Steering angle of the last arc [rad]."""
    cost: FloatArray
    before: NDArray[np.intp]
    """Index of the pose one arc before."""
    away: FloatArray
    """How much farther than required the body is from obstacles, at most ``CROWDED`` [m]."""

    def only(self, chosen: NDArray[np.intp]) -> _Poses:
        """Return the poses with the given indices."""
        return _Poses(
            self.x[chosen],
            self.y[chosen],
            self.heading[chosen],
            self.steering[chosen],
            self.cost[chosen],
            self.before[chosen],
            self.away[chosen],
        )


def find(
    perception: Perception,
    obstacles: Obstacles,
    farthest: float,
    beyond: float = 0.0,
    off: Obstacles | None = None,
    shortest: float = SHORTEST,
) -> FloatArray | None:
    """Return the steering angles of the cheapest way, one per arc, shape (k,) [rad]; ``None`` for no way.

    Parameters
    ----------
    perception
        What the ego is told.
    obstacles
        Obstacles that may not be touched.
    farthest
        Greatest distance that the front bumper may move [m].
    beyond
        How much farther beside its lane the ego may get than where SUMO has a place for it [m].
    off
        If given, a shorter way is enough if the body is clear of these obstacles at its end.
    shortest
        Least length of any other way [m].
    """
    ego = perception.ego
    space = _space(perception, obstacles, beyond)
    angles = np.linspace(-ego.drive.max_steering, ego.drive.max_steering, ANGLES)
    arcs = int(min(REACH, farthest) / ARC)
    tree = [_start(ego)]
    while len(tree) <= arcs:
        onward = _cheapest_of_cells(_driven(space, tree[-1], angles, (len(tree) - 1) * ARC))
        if not len(onward.x):
            break
        tree.append(onward)
    ends, reached = tree[-1].cost, (len(tree) - 1) * ARC
    if reached < shortest:
        if off is None or reached < SHORTEST_OFF:
            return None
        last = tree[-1]
        away = _away(ego, last.x, last.y, last.heading, off.after(reached))
        ends = np.where(away >= 0.0, ends, np.inf)
        if not np.isfinite(ends).any():
            return None
    at, way = int(np.argmin(ends)), []
    for poses in reversed(tree[1:]):
        way.append(poses.steering[at])
        at = int(poses.before[at])
    return np.array(way[::-1])


def leads_on(
    perception: Perception, obstacles: Obstacles, way: FloatArray, done: float, beyond: float = 0.0
) -> bool:
    """Return whether the rest of a way is still free.

    Parameters
    ----------
    perception, beyond : as for :func:`find`
    obstacles : obstacles, with the distances kept while the way is driven (:func:`drifted`)
    way : steering angles of the way, shape (k,) [rad]
    done : length that has been driven already [m]
    """
    at = _start(perception.ego)
    space = _space(perception, obstacles, beyond + DRIFT)
    for number in range(int(done / ARC), len(way)):
        gone, length = max(number * ARC - done, 0.0), min(ARC, (number + 1) * ARC - done)
        at = _driven(space, at, way[number : number + 1], gone, length)
        if not len(at.x):
            return False
    return True


def drifted(kept: FloatArray, least: float) -> FloatArray:
    """Return the distances kept while a way is driven, given those with which it was found, shape (n,) [m].

    They are reduced by ``DRIFT``, because the ego does not follow its way exactly, but not below ``least``:
    each search measures the distances anew, so the drifts would add up until the ego touches somebody. For
    those who touch it already, there is no such bound.

    >>> drifted(np.array([0.1, 0.02, -0.2]), 0.01).round(2).tolist()
    [0.07, 0.01, -0.23]
    """
    apart = np.maximum(kept - DRIFT, np.minimum(kept, least))
    return np.where(kept > 0.0, apart, kept - DRIFT)


class _Space(NamedTuple):
    """The space that ways may use."""

    ego: EgoState
    line: _Line
    obstacles: Obstacles
    rear: float
    """Greatest distance of the rear axle from the line [m]."""
    front: float
    """Greatest distance of the middle of the front bumper from the line [m]."""


def _space(perception: Perception, obstacles: Obstacles, beyond: float) -> _Space:
    ego, line = perception.ego, _centre_line(perception.road)
    at = _start(ego)
    rear, front, _ = _aside(ego, line, at.x, at.y, at.heading)
    lane = perception.road.lane(perception.road.reference)
    reaches = 0.5 * (ego.body.width + (lane.width if lane else ego.body.width)) - IN_LANE
    # An ego that is farther beside the lane already may stay so.
    limits = max(ASIDE, float(rear[0])) + beyond, max(reaches, float(front[0])) + beyond
    return _Space(ego, line, obstacles, *limits)


def _start(ego: EgoState) -> _Poses:
    zero = np.zeros(1)
    return _Poses(
        zero,
        zero + ego.across,
        zero + ego.heading_error,
        zero + ego.steering,
        zero,
        np.array([-1]),
        zero,
    )


def _driven(space: _Space, at: _Poses, angles: FloatArray, gone: float, length: float = ARC) -> _Poses:
    """Return the free poses to which one more arc leads with each steering angle, after a length gone [m]."""
    ego, line, obstacles = space.ego, space.line, space.obstacles.after(gone)
    steering = np.tile(angles, len(at.x))
    before = np.repeat(np.arange(len(at.x)), len(angles))
    bend = np.tan(steering) / ego.body.wheelbase
    cost = at.cost[before] + STEERED * np.abs(steering - at.steering[before])
    start = at.x[before], at.y[before], at.heading[before]
    x, y, heading = _after(*start, bend, length)
    away = _away(ego, x, y, heading, obstacles)
    free = np.flatnonzero(away >= 0.0)
    for share in WITHIN_ARC:
        # No part of the body moves as far as ``CROWDED`` in half an arc.
        unsure = np.full(len(free), True)
        if share <= 0.5:
            unsure &= at.away[before[free]] < CROWDED
        if share >= 0.5:
            unsure &= away[free] < CROWDED
        x_from, y_from, turned, bent = (values[free[unsure]] for values in (*start, bend))
        between = _after(x_from, y_from, turned, bent, share * length)
        unsure[unsure] = _away(ego, *between, obstacles) < 0.0
        free = free[~unsure]
    poses = _Poses(x, y, heading, steering, cost, before, away).only(free)
    rear, front, turned = _aside(ego, line, poses.x, poses.y, poses.heading)
    cost = poses.cost + length * (OFF_LANE * rear**2 + TURNED * turned**2)
    cost = cost + length * CROWD * np.maximum(1.0 - poses.away / CROWDED, 0.0)
    inside = np.flatnonzero((rear <= space.rear) & (front <= space.front))
    return poses._replace(cost=cost).only(inside)


def _after(
    x: FloatArray, y: FloatArray, heading: FloatArray, bend: FloatArray, length: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x, y and heading after an arc of that curvature [1/m] and length [m]."""
    chord = heading + 0.5 * length * bend
    return x + length * np.cos(chord), y + length * np.sin(chord), heading + length * bend


def _away(
    ego: EgoState, x: FloatArray, y: FloatArray, heading: FloatArray, obstacles: Obstacles
) -> FloatArray:
    """Return how much farther than required the body is from obstacles, at most ``CROWDED`` [m]."""
    where = x[None], y[None], heading[None]
    places = (values[:, None] for values in (obstacles.x, obstacles.y, obstacles.kept))
    away = disc_clearances(*where, ego.body, *places)[0].min(axis=1, initial=CROWDED)
    if not len(obstacles.kept_to_boxes):
        return np.asarray(away)
    close = _close(ego.body, x, y, heading, obstacles)
    poses, boxes = close.any(axis=1), close.any(axis=0)
    if poses.any():
        where = x[None, poses], y[None, poses], heading[None, poses]
        them = Boxes(*(values[boxes] for values in obstacles.boxes))
        to_boxes = box_clearances(*where, ego.body, them)[0] - obstacles.kept_to_boxes[boxes]
        away[poses] = np.minimum(away[poses], to_boxes.min(axis=1))
    return np.asarray(away)


def _close(
    body: Body, x: FloatArray, y: FloatArray, heading: FloatArray, obstacles: Obstacles
) -> NDArray[np.bool_]:
    """Return to which boxes the body may be so near that it matters, shape (m, v): most are far away."""
    boxes, middle = obstacles.boxes, body.front - 0.5 * body.length
    away_x = boxes.x - (x + middle * np.cos(heading))[:, None]
    away_y = boxes.y - (y + middle * np.sin(heading))[:, None]
    reach = 0.5 * (np.hypot(body.length, body.width) + np.hypot(boxes.length, boxes.width))
    return np.asarray(np.hypot(away_x, away_y) < reach + obstacles.kept_to_boxes + CROWDED)


def _cheapest_of_cells(poses: _Poses) -> _Poses:
    """Return the cheapest pose of each cell, at most ``KEPT`` of them."""
    order = np.argsort(poses.cost, kind="stable")
    cells = np.zeros(len(order), np.int64)  # a number for each cell, faster to sort than three
    for values, size in ((poses.x, CELL), (poses.y, CELL), (poses.heading, CELL_TURNED)):
        cells = cells * CELLS + np.round(values[order] / size).astype(np.int64)
    _, first = np.unique(cells, return_index=True)
    chosen = order[np.sort(first)[:KEPT]]
    return poses.only(chosen)


def _centre_line(road: RoadAhead) -> _Line:
    along = np.arange(-6.0, REACH + 8.0, 0.5)
    places, heading = to_plane(road, along, np.zeros(len(along)))
    return _Line(places[:, 0], places[:, 1], heading)


def _aside(
    ego: EgoState, line: _Line, x: FloatArray, y: FloatArray, heading: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return how far rear axle and front bumper are from the centre line [m], and the angle to it [rad]."""
    rear, at_rear = _beside(line, x, y)
    ahead = ego.body.front
    front, _ = _beside(line, x + ahead * np.cos(heading), y + ahead * np.sin(heading))
    return rear, front, np.asarray(np.abs(heading - line.heading[at_rear]))


def _beside(line: _Line, x: FloatArray, y: FloatArray) -> tuple[FloatArray, NDArray[np.intp]]:
    squared = np.square(x[:, None] - line.x)
    squared += np.square(y[:, None] - line.y)
    at = np.argmin(squared, axis=1)
    beside = np.cos(line.heading[at]) * (y - line.y[at]) - np.sin(line.heading[at]) * (x - line.x[at])
    return np.abs(beside), at
