"""From the surroundings to what one ego is told, in its route frame."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.interface import (
    Crossing,
    EgoState,
    JunctionFoe,
    Lane,
    Pedestrians,
    Perception,
    RoadAhead,
    Signal,
    SignalState,
    Vehicles,
)
from cosim.frames import wrapped
from cosim.plant import Plant
from cosim.sumo.gaps import LaneLine, extents, neighbour_gaps
from cosim.sumo.lane_path import LanePath, PathCrossing, PathSignal
from cosim.sumo.route import VIEW
from cosim.sumo.surroundings import PEDESTRIAN_RADIUS, Surroundings
from cosim.sumo.track import Track

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

CURVATURE_STEP = 1.0
"""[m]"""
_CURVATURE_GRID = CURVATURE_STEP * np.arange(151)
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
    """One ego's route frame at one instant, and everybody near it seen in it.

    Parameters
    ----------
    plant, track : the ego
    near : (n, 2) positions to be seen in the frame [m]
    """

    def __init__(self, plant: Plant, track: Track, near: FloatArray) -> None:
        self.path: LanePath = track.path
        curve, body, x, y = self.path.curve, plant.body, plant.x, plant.y
        east, north = math.cos(plant.heading), math.sin(plant.heading)
        # Found near the front bumper's last place: a path that crosses itself has two nearest points.
        self.origin, self.across = curve.place_near(x, y, track.along - body.front)
        """Along coordinate of the rear axle on the path, and its offset to the left [m]."""
        self.heading_error = wrapped(plant.heading - curve.heading_at(self.origin))
        self.front = track.along - self.origin
        """Along coordinate of the front bumper [m]."""
        tail_x, tail_y = x - body.rear_overhang * east, y - body.rear_overhang * north
        self.back = curve.place_near(tail_x, tail_y, self.origin - body.rear_overhang)[0] - self.origin
        along, across, heading = curve.project(near)
        self.near = (along - self.origin, across, heading)
        """Along and across coordinates of everybody [m], and the path's heading there [rad]."""

    def to_world(self, along: FloatArray, across: FloatArray) -> FloatArray:
        """Return world coordinates (n, 2) [m]."""
        return self.path.curve.at(np.asarray(along) + self.origin, np.asarray(across))


@dataclass(frozen=True, slots=True)
class View:
    """What is near one ego, and its frame."""

    frame: Frame
    persons: IntArray
    """Rows of the surroundings' persons."""
    cars: IntArray
    """Rows of its cars. ``frame.near`` has their front bumpers, their rear bumpers, then the persons."""


def look(name: str, plant: Plant, track: Track, surroundings: Surroundings) -> View:
    """Return an ego's frame with everybody near it."""
    persons, cars = surroundings.persons_near[name], surroundings.cars_near[name]
    front, heading = surroundings.cars.front[cars], surroundings.cars.heading[cars]
    length = surroundings.cars.length[cars]
    back = np.empty_like(front)
    back[:, 0] = front[:, 0] - length * np.cos(heading)
    back[:, 1] = front[:, 1] - length * np.sin(heading)
    near = np.concatenate([front, back, surroundings.persons.position[persons]])
    return View(Frame(plant, track, near), persons, cars)


def perceive(
    ego_state: EgoState,
    view: View,
    track: Track,
    surroundings: Surroundings,
    lights: Mapping[str, str],
    foes: Sequence[JunctionFoe],
    own_limit: float,
) -> Perception:
    """Return what an ego is told.

    Parameters
    ----------
    ego_state, view, track : the ego
    surroundings : everything near any ego
    lights : states of the traffic lights over its path, by name
    foes : vehicles whose ways cross its own
    own_limit : what its kind of vehicle drives at most, told as a speed limit [m/s]
    """
    frame = view.frame
    crossings = visible_crossings(frame)
    vehicles, back_along, back_across = _vehicles(view, surroundings)
    road, lanes = _road(frame, track, crossings, lights, foes, own_limit)
    covered = extents(vehicles, back_along, back_across)
    gaps = neighbour_gaps(vehicles, covered, lanes, (frame.back, frame.front))
    return Perception(ego_state, _pedestrians(view, surroundings, crossings), vehicles, gaps, road)


def visible_crossings(frame: Frame) -> list[PathCrossing]:
    """Return the crossings ahead, and those that the ego's body is on."""
    behind, ahead = frame.origin + frame.back, frame.origin + VIEW
    return [c for c in frame.path.crossings if c.exit > behind and c.entry < ahead]


def visible_signals(frame: Frame) -> list[PathSignal]:
    """Return the path's signals that the ego has not passed."""
    low, high = frame.origin + frame.front - PASSED_LINE, frame.origin + VIEW
    return [signal for signal in frame.path.signals if low <= signal.stop_line < high]


def _pedestrians(view: View, surroundings: Surroundings, crossings: Sequence[PathCrossing]) -> Pedestrians:
    rows, frame = view.persons, view.frame
    persons = surroundings.persons
    first = 2 * len(view.cars)
    along, across, heading = (values[first:] for values in frame.near)
    position, velocity = persons.position[rows], persons.velocity[rows]
    cosine, sine = np.cos(heading), np.sin(heading)
    along_speed = velocity[:, 0] * cosine + velocity[:, 1] * sine
    across_speed = velocity[:, 1] * cosine - velocity[:, 0] * sine
    crossing = np.full(len(rows), -1, dtype=np.int64)
    if crossings and len(rows):
        index_of = {crossing.source.name: index for index, crossing in enumerate(crossings)}
        crossing[:] = [index_of.get(persons.crossing[row], -1) for row in rows.tolist()]
    for index in set(crossing.tolist()) - {-1}:
        place = crossings[index]
        members = crossing == index
        forward = np.array([math.cos(place.heading), math.sin(place.heading)])
        leftward = np.array([-forward[1], forward[0]])
        relative = position[members] - place.origin
        along[members] = place.middle - frame.origin + relative @ forward
        across[members] = relative @ leftward
        along_speed[members] = velocity[members] @ forward
        across_speed[members] = velocity[members] @ leftward
    on_crossing = persons.on_crossing[rows]
    concerned = crossing >= 0
    return Pedestrians(
        tuple(persons.names[row] for row in rows.tolist()),
        along,
        across,
        along_speed,
        across_speed,
        np.full(len(rows), PEDESTRIAN_RADIUS),
        crossing,
        concerned & on_crossing,
        concerned & ~on_crossing,
        np.zeros(len(rows)) if persons.uncertainty is None else persons.uncertainty[rows],
    )


def _vehicles(view: View, surroundings: Surroundings) -> tuple[Vehicles, FloatArray, FloatArray]:
    """Return the vehicles, and along and across coordinates of their rear bumpers' centres."""
    rows, cars = view.cars, surroundings.cars
    count = len(rows)
    along, across, path_heading = (values[: 2 * count] for values in view.frame.near)
    at_front = path_heading[:count]
    velocity = cars.velocity[rows]
    cosine, sine = np.cos(at_front), np.sin(at_front)
    error = math.pi - np.mod(math.pi - (cars.heading[rows] - at_front), 2.0 * math.pi)
    vehicles = Vehicles(
        tuple(cars.names[row] for row in rows.tolist()),
        along[:count],
        0.5 * (across[:count] + across[count:]),
        velocity[:, 0] * cosine + velocity[:, 1] * sine,
        velocity[:, 1] * cosine - velocity[:, 0] * sine,
        cars.acceleration[rows],
        error,
        cars.length[rows],
        cars.width[rows],
    )
    return vehicles, along[count:], across[count:]


def _road(
    frame: Frame,
    track: Track,
    crossings: Sequence[PathCrossing],
    lights: Mapping[str, str],
    foes: Sequence[JunctionFoe],
    own_limit: float,
) -> tuple[RoadAhead, dict[int, LaneLine]]:
    """Return the road, and the lines of its lanes: 0 for the ego's, 1 for the one left of it, −1 right."""
    path, origin = frame.path, frame.origin
    route, step = track.route, track.step
    own_width = path.piece_at(origin).lane.width
    lanes = [Lane(track.number, 0.0, own_width, _leads(route.reach(step, track.index) - origin))]
    lines = {0: LaneLine(own_width)}
    right, left = -0.5 * own_width, 0.5 * own_width
    for direction in (-1, 1):
        index = track.index
        while route.usable(step, index := index + direction):
            other = route.path(step, index)
            offsets = path.beside(other)
            offset = float(np.interp(origin, path.curve.along, offsets))
            if math.isnan(offset):
                break
            width = other.piece_at(origin).lane.width
            right, left = min(right, offset - 0.5 * width), max(left, offset + 0.5 * width)
            if index == track.index + direction:
                side = 1 if offset > 0.0 else -1
                leads = _leads(route.reach(step, index) - origin)
                lanes.append(Lane(track.number + side, offset, width, leads))
                lines[side] = LaneLine(width, path.curve.along - origin, offsets)
    lanes.sort(key=lambda lane: lane.number)
    starts, limits = path.limits
    first = max(int(np.searchsorted(starts, origin, side="right")) - 1, 0)
    limit_along = starts[first:] - origin
    limit_along[0] = min(limit_along[0], 0.0)
    grid = origin + _CURVATURE_GRID
    road = RoadAhead(
        lanes=tuple(lanes),
        reference=track.number,
        right_edge=right,
        left_edge=left,
        curvature=np.interp(grid, path.curve.along, path.curve.curvature),
        curvature_step=CURVATURE_STEP,
        limit_along=limit_along,
        limit=np.minimum(limits[first:], own_limit),
        crossings=tuple(_crossing(crossing, origin, lights) for crossing in crossings),
        signals=tuple(
            Signal(signal.name, signal.stop_line - origin, _state(lights, signal.name, signal.index))
            for signal in visible_signals(frame)
        ),
        foes=tuple(foes),
        route_end=path.chain_end - origin if path.leads_to_end else math.inf,
    )
    return road, lines


def _leads(distance: float) -> float:
    return distance if distance < VIEW else math.inf


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
