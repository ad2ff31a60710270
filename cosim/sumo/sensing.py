"""From the surroundings to what one ego is told, in its route frame."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from controllers.interface import (
    Crossing,
    EgoState,
    JunctionFoe,
    Lane,
    NeighbourGaps,
    Pedestrians,
    Perception,
    RoadAhead,
    Signal,
    SignalState,
    Vehicles,
)
from cosim.frames import wrapped
from cosim.plant import Plant
from cosim.sumo.gaps import CentreLine, extents, neighbours
from cosim.sumo.route import VIEW, LanePath, PathCrossing
from cosim.sumo.surroundings import PEDESTRIAN_RADIUS, Surroundings
from cosim.sumo.track import Track

FloatArray = NDArray[np.float64]

CURVATURE_STEP = 1.0
"""[m]"""
CURVATURE_SAMPLES = 151
PASSED_LINE = 2.0
"""A stop line further behind the front bumper than this is forgotten [m]."""

_STATES = {
    "r": SignalState.RED,
    "u": SignalState.RED,
    "y": SignalState.AMBER,
    "Y": SignalState.AMBER,
}
"""SUMO's letters; all others let pass, if need be after yielding."""


class Frame:
    """One ego's route frame at one instant: a path, and where its origin is on it."""

    def __init__(self, plant: Plant, track: Track) -> None:
        self.path: LanePath = track.path
        body, heading = plant.body, plant.heading
        forward = np.array([math.cos(heading), math.sin(heading)])
        rear = np.array([plant.x, plant.y])
        points = np.stack([rear, rear + body.front * forward, rear - body.rear_overhang * forward])
        along, across, path_heading = self.path.curve.project(points)
        self.origin = float(along[0])
        """Along coordinate of the rear axle on the path [m]."""
        self.across = float(across[0])
        self.heading_error = wrapped(heading - float(path_heading[0]))
        self.front = float(along[1]) - self.origin
        """Along coordinate of the front bumper [m]."""
        self.back = float(along[2]) - self.origin

    def to_world(self, along: FloatArray, across: FloatArray) -> FloatArray:
        """Return world coordinates (n, 2) [m]."""
        return self.path.curve.at(np.asarray(along) + self.origin, np.asarray(across))


def perceive(
    ego_state: EgoState,
    frame: Frame,
    track: Track,
    surroundings: Surroundings,
    lights: Mapping[str, str],
    foes: Sequence[JunctionFoe],
) -> Perception:
    """Return what an ego is told.

    Parameters
    ----------
    ego_state, frame, track : the ego
    surroundings : everything near any ego
    lights : states of the traffic lights over its path, by name
    foes : vehicles whose ways cross its own
    """
    crossings = visible_crossings(frame)
    vehicles, back_along, back_across = _vehicles(ego_state.name, frame, surroundings)
    road, centre_lines = _road(frame, track, crossings, lights, foes)
    gaps = _gaps(frame, road, centre_lines, vehicles, back_along, back_across)
    return Perception(
        ego_state, _pedestrians(ego_state.name, frame, surroundings, crossings), vehicles, gaps, road
    )


def visible_crossings(frame: Frame) -> list[PathCrossing]:
    """Return the crossings ahead, and those that the ego's body is on."""
    behind, ahead = frame.origin + frame.back, frame.origin + VIEW
    return [c for c in frame.path.crossings if c.exit > behind and c.entry < ahead]


def visible_signals(frame: Frame) -> list[int]:
    """Return the indices of the path's signals that the ego has not passed."""
    low, high = frame.origin + frame.front - PASSED_LINE, frame.origin + VIEW
    return [i for i, signal in enumerate(frame.path.signals) if low <= signal.stop_line < high]


def _pedestrians(
    ego: str, frame: Frame, surroundings: Surroundings, crossings: Sequence[PathCrossing]
) -> Pedestrians:
    rows = surroundings.persons_near[ego]
    persons = surroundings.persons
    count = len(rows)
    position, velocity = persons.position[rows], persons.velocity[rows]
    along, across, heading = frame.path.curve.project(position)
    cosine, sine = np.cos(heading), np.sin(heading)
    along_speed = velocity[:, 0] * cosine + velocity[:, 1] * sine
    across_speed = velocity[:, 1] * cosine - velocity[:, 0] * sine
    index_of = {crossing.source.name: index for index, crossing in enumerate(crossings)}
    named = [persons.crossing[row] for row in rows]
    crossing = np.array([index_of.get(name, -1) for name in named], dtype=np.int64)
    walked = np.array([persons.edge[row] for row in rows]) == np.array(named)
    for index in np.unique(crossing[crossing >= 0]):
        place = crossings[index]
        members = crossing == index
        forward = np.array([math.cos(place.heading), math.sin(place.heading)])
        leftward = np.array([-forward[1], forward[0]])
        relative = position[members] - place.origin
        along[members] = place.middle + relative @ forward
        across[members] = relative @ leftward
        along_speed[members] = velocity[members] @ forward
        across_speed[members] = velocity[members] @ leftward
    concerned = crossing >= 0
    return Pedestrians(
        tuple(persons.names[row] for row in rows),
        along - frame.origin,
        across,
        along_speed,
        across_speed,
        np.full(count, PEDESTRIAN_RADIUS),
        crossing,
        concerned & walked if count else np.zeros(0, dtype=np.bool_),
        concerned & ~walked if count else np.zeros(0, dtype=np.bool_),
    )


def _vehicles(ego: str, frame: Frame, surroundings: Surroundings) -> tuple[Vehicles, FloatArray, FloatArray]:
    """Return the vehicles, and where their rear bumpers' centres are."""
    rows = surroundings.cars_near[ego]
    cars = surroundings.cars
    front, heading, length = cars.front[rows], cars.heading[rows], cars.length[rows]
    back = front - length[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    along, across, path_heading = frame.path.curve.project(np.concatenate([front, back]))
    count = len(rows)
    along -= frame.origin
    at_front = path_heading[:count]
    velocity = cars.velocity[rows]
    cosine, sine = np.cos(at_front), np.sin(at_front)
    error = heading - at_front
    error = math.pi - np.mod(math.pi - error, 2.0 * math.pi)
    vehicles = Vehicles(
        tuple(cars.names[row] for row in rows),
        along[:count],
        0.5 * (across[:count] + across[count:]),
        velocity[:, 0] * cosine + velocity[:, 1] * sine,
        velocity[:, 1] * cosine - velocity[:, 0] * sine,
        cars.acceleration[rows],
        error,
        length,
        cars.width[rows],
    )
    return vehicles, along[count:], across[count:]


def _road(
    frame: Frame,
    track: Track,
    crossings: Sequence[PathCrossing],
    lights: Mapping[str, str],
    foes: Sequence[JunctionFoe],
) -> tuple[RoadAhead, dict[int, tuple[CentreLine, float]]]:
    """Return the road, and centre line and width of each of its lanes by number."""
    path, origin = frame.path, frame.origin
    route, step = track.route, track.step
    own_width = path.piece_at(origin).lane.width
    lanes = [Lane(track.number, 0.0, own_width, _leads(route.reach(step, track.index) - origin))]
    lines: dict[int, tuple[CentreLine, float]] = {
        track.number: (lambda along: np.zeros_like(along), own_width)
    }
    for index, other in track.beside():
        offset = _at(path, path.beside(other), origin)
        if math.isnan(offset):
            continue
        side = 1 if offset > 0.0 else -1
        width = other.piece_at(origin).lane.width
        leads = _leads(route.reach(step, index) - origin)
        lanes.append(Lane(track.number + side, offset, width, leads))
        lines[track.number + side] = (_centre_line(path, other, origin), width)
    lanes.sort(key=lambda lane: lane.number)
    right, left = _edges(path, track, origin, own_width)
    starts, limits = path.limits
    first = max(int(np.searchsorted(starts, origin, side="right")) - 1, 0)
    limit_along = starts[first:] - origin
    limit_along[0] = min(limit_along[0], 0.0)
    grid = origin + CURVATURE_STEP * np.arange(CURVATURE_SAMPLES)
    road = RoadAhead(
        lanes=tuple(lanes),
        reference=track.number,
        right_edge=right,
        left_edge=left,
        curvature=np.interp(grid, path.curve.along, path.curve.curvature),
        curvature_step=CURVATURE_STEP,
        limit_along=limit_along,
        limit=limits[first:],
        crossings=tuple(_crossing(crossing, origin, lights) for crossing in crossings),
        signals=tuple(
            Signal(signal.name, signal.stop_line - origin, _state(lights, signal.name, signal.index))
            for signal in (path.signals[i] for i in visible_signals(frame))
        ),
        foes=tuple(foes),
        route_end=path.chain_end - origin if path.leads_to_end else math.inf,
    )
    return road, lines


def _leads(distance: float) -> float:
    return distance if distance < VIEW else math.inf


def _at(path: LanePath, values: FloatArray, along: float) -> float:
    return float(np.interp(along, path.curve.along, values))


def _centre_line(path: LanePath, other: LanePath, origin: float) -> CentreLine:
    offsets = path.beside(other)

    def centre(along: FloatArray) -> FloatArray:
        return np.interp(along + origin, path.curve.along, offsets, left=np.nan, right=np.nan)

    return centre


def _edges(path: LanePath, track: Track, origin: float, own_width: float) -> tuple[float, float]:
    """Return the right and left end of the lanes side by side that the ego may use."""
    right, left = -0.5 * own_width, 0.5 * own_width
    for direction in (-1, 1):
        index = track.index + direction
        while track.route.usable(track.step, index):
            other = track.route.path(track.step, index)
            offset = _at(path, path.beside(other), origin)
            if math.isnan(offset):
                break
            half = 0.5 * other.piece_at(origin).lane.width
            right, left = min(right, offset - half), max(left, offset + half)
            index += direction
    return right, left


def _crossing(crossing: PathCrossing, origin: float, lights: Mapping[str, str]) -> Crossing:
    source = crossing.source
    green: bool | None = None
    if source.signal:
        letters = [lights[source.signal][index] for index in source.signal_indices]
        green = None if all(letter in "oO" for letter in letters) else any(c in "gG" for c in letters)
    return Crossing(
        source.name,
        source.kind,
        crossing.entry - origin,
        crossing.exit - origin,
        crossing.stop_line - origin,
        crossing.right,
        crossing.left,
        green,
    )


def _state(lights: Mapping[str, str], name: str, index: int) -> SignalState:
    return _STATES.get(lights[name][index], SignalState.GREEN)


def _gaps(
    frame: Frame,
    road: RoadAhead,
    lines: Mapping[int, tuple[CentreLine, float]],
    vehicles: Vehicles,
    back_along: FloatArray,
    back_across: FloatArray,
) -> NeighbourGaps:
    covered = extents(vehicles, back_along, back_across)
    ego = (frame.back, frame.front)
    pairs = []
    for side in (0, 1, -1):
        line = lines.get(road.reference + side)
        pairs.append(
            (None, None) if line is None else neighbours(vehicles, covered, *line, ego, own_lane=side == 0)
        )
    (ahead, behind), (left_ahead, left_behind), (right_ahead, right_behind) = pairs
    return NeighbourGaps(ahead, behind, left_ahead, left_behind, right_ahead, right_behind)
