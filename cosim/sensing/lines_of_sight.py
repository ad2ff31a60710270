"""Lines of sight, which the rectangles of vehicles and the walls of buildings may block."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cosim.arrays import BoolArray, FloatArray, IntArray
from cosim.sensing.interface import Scene, State


@dataclass(frozen=True, slots=True)
class Boxes:
    """Rectangles that may block lines of sight; arrays of length n."""

    x: FloatArray
    """Centres [m]."""
    y: FloatArray
    cosine: FloatArray
    """Cosines of the headings; ``sine`` holds the sines."""
    sine: FloatArray
    half_length: FloatArray
    half_width: FloatArray

    def near(self, eye: FloatArray, reach: float) -> Boxes:
        """Return the rectangles that may have a part within a distance of a point [m]."""
        close = np.hypot(self.x - eye[0], self.y - eye[1]) <= reach + self.half_length + self.half_width
        return Boxes(*(getattr(self, name)[close] for name in Boxes.__slots__))


def boxes_of(front: FloatArray, heading: FloatArray, length: FloatArray, width: FloatArray) -> Boxes:
    """Return the rectangles of vehicles, given their front bumpers."""
    cosine, sine = np.cos(heading), np.sin(heading)
    half = 0.5 * length
    return Boxes(front[:, 0] - half * cosine, front[:, 1] - half * sine, cosine, sine, half, 0.5 * width)


def visible(
    eye: FloatArray, position: FloatArray, radius: FloatArray, boxes: Boxes, walls: FloatArray
) -> BoolArray:
    """Return which discs can be seen from a point.

    A disc is visible if the line from the eye to its centre is free, or one of the lines to its two edges,
    ``centre ± radius · n`` with n perpendicular to the line to the centre. So a disc counts as visible as
    soon as the first sliver of it appears from behind a corner.

    Parameters
    ----------
    eye : (2,) [m]
    position, radius : (n, 2) centres and (n,) radii [m]
    boxes : rectangles that may be in the way
    walls : (m, 4) straight pieces that may be in the way [m]

    Examples
    --------
    >>> bus = boxes_of(np.array([[10.0, 3.0]]), np.zeros(1), np.array([6.0]), np.array([2.0]))
    >>> there = np.array([[12.0, 6.0], [10.0, 0.0]])
    >>> visible(np.zeros(2), there, np.full(2, 0.25), bus, np.zeros((0, 4))).tolist()
    [False, True]
    """
    if not len(position):
        return np.zeros(0, dtype=np.bool_)
    away = position - eye
    distance = np.hypot(away[:, 0], away[:, 1])
    reach = float(distance.max() + radius.max())
    boxes, walls = boxes.near(eye, reach), _walls_near(walls, eye, reach)
    seen = ~_blocked(eye, position, boxes, walls)
    rest = np.flatnonzero(~seen)
    if len(rest):
        beside = np.column_stack([-away[rest, 1], away[rest, 0]])
        beside *= (radius[rest] / np.maximum(distance[rest], 1e-9))[:, None]
        edges = np.concatenate([position[rest] + beside, position[rest] - beside])
        free = ~_blocked(eye, edges, boxes, walls)
        seen[rest] = free[: len(rest)] | free[len(rest) :]
    return seen


def in_view(
    eye: FloatArray, heading: float, position: FloatArray, reach: float, field_of_view: float
) -> BoolArray:
    """Return which points are within range [m] and field of view, its full angle [rad]."""
    away = position - eye
    within = np.hypot(away[:, 0], away[:, 1]) <= reach
    if field_of_view < 2.0 * math.pi:
        forward = math.cos(heading) * away[:, 0] + math.sin(heading) * away[:, 1]
        leftward = math.cos(heading) * away[:, 1] - math.sin(heading) * away[:, 0]
        within &= np.abs(np.arctan2(leftward, forward)) <= 0.5 * field_of_view
    return within


def states(within: BoolArray, seen: BoolArray, detected: BoolArray) -> IntArray:
    """Return the state of each point: in range or not, behind something or not, detected or not."""
    found = np.full(len(within), int(State.OUT_OF_RANGE), dtype=np.int64)
    found[within] = State.HIDDEN
    found[seen] = State.MISSED
    found[detected] = State.VISIBLE
    return found


def vehicles_in(scene: Scene) -> Boxes:
    """Return the rectangles of a scene's vehicles."""
    return boxes_of(scene.front, scene.vehicle_heading, scene.length, scene.width)


def with_ego(scene: Scene) -> Boxes:
    """Return the rectangles of a scene's vehicles and, first, of the ego itself."""
    body = scene.body
    front = [[scene.x + body.front * math.cos(scene.heading), scene.y + body.front * math.sin(scene.heading)]]
    return boxes_of(
        np.concatenate([np.array(front), scene.front]),
        np.append(scene.heading, scene.vehicle_heading),
        np.append(body.length, scene.length),
        np.append(body.width, scene.width),
    )


def distance_to_pieces(x: float, y: float, pieces: FloatArray) -> float:
    """Return the distance from a point to the nearest of (n, 4) straight pieces [m].

    >>> distance_to_pieces(2.0, 3.0, np.array([[0.0, 0.0, 10.0, 0.0]]))
    3.0
    """
    from_x, from_y, along = x - pieces[:, 0], y - pieces[:, 1], pieces[:, 2:] - pieces[:, :2]
    square = np.maximum((along**2).sum(axis=1), 1e-12)
    share = np.clip((from_x * along[:, 0] + from_y * along[:, 1]) / square, 0.0, 1.0)
    return float(np.hypot(from_x - share * along[:, 0], from_y - share * along[:, 1]).min())


def _blocked(eye: FloatArray, targets: FloatArray, boxes: Boxes, walls: FloatArray) -> BoolArray:
    blocked = np.zeros(len(targets), dtype=np.bool_)
    if len(boxes.x):
        blocked |= _behind_boxes(eye, targets, boxes)
    if len(walls):
        blocked |= _behind_walls(eye, targets, walls)
    return blocked


def _behind_boxes(eye: FloatArray, targets: FloatArray, boxes: Boxes) -> BoolArray:
    """Return which lines meet a rectangle: those that none of the three possible axes separates from it."""
    half = 0.5 * (targets - eye)
    to_x, to_y = (eye[0] - boxes.x), (eye[1] - boxes.y)
    # In each rectangle's own frame, (targets, rectangles): half the line, and its middle.
    half_along = half[:, :1] * boxes.cosine + half[:, 1:] * boxes.sine
    half_across = half[:, 1:] * boxes.cosine - half[:, :1] * boxes.sine
    middle_along = half_along + (to_x * boxes.cosine + to_y * boxes.sine)
    middle_across = half_across + (to_y * boxes.cosine - to_x * boxes.sine)
    size_along, size_across = np.abs(half_along), np.abs(half_across)
    meets = np.abs(middle_along) < boxes.half_length + size_along
    meets &= np.abs(middle_across) < boxes.half_width + size_across
    turned = np.abs(middle_along * half_across - middle_across * half_along)
    meets &= turned < boxes.half_length * size_across + boxes.half_width * size_along
    return np.asarray(meets.any(axis=1))


def _behind_walls(eye: FloatArray, targets: FloatArray, walls: FloatArray) -> BoolArray:
    """Return which lines cross a straight piece: the ends of each lie on different sides of the other."""
    line = targets - eye
    begin, end = walls[:, :2] - eye, walls[:, 2:] - eye
    of_begin = line[:, :1] * begin[:, 1] - line[:, 1:] * begin[:, 0]
    of_end = line[:, :1] * end[:, 1] - line[:, 1:] * end[:, 0]
    wall = end - begin
    of_eye = begin[:, 0] * wall[:, 1] - begin[:, 1] * wall[:, 0]
    of_target = of_eye - (line[:, :1] * wall[:, 1] - line[:, 1:] * wall[:, 0])
    return np.asarray(((of_begin * of_end < 0.0) & (of_eye * of_target < 0.0)).any(axis=1))


def _walls_near(walls: FloatArray, eye: FloatArray, reach: float) -> FloatArray:
    if not len(walls):
        return walls
    low, high = np.minimum(walls[:, :2], walls[:, 2:]), np.maximum(walls[:, :2], walls[:, 2:])
    return walls[((low <= eye + reach) & (high >= eye - reach)).all(axis=1)]
