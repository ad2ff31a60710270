"""A perception as a fixed list of numbers with units and bounds, for policies and other foreign code."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.interface import (
    Crossing,
    CrossingKind,
    JunctionFoe,
    Neighbour,
    Pedestrians,
    Perception,
    Signal,
    SignalState,
)

Observation = NDArray[np.float32]

FAR = 150.0
"""Larger distances are reported as this [m]."""
BEHIND = 10.0
"""Pedestrians further behind the rear axle are left out [m]."""
FASTEST = 60.0
"""Higher speeds are reported as this [m/s]."""
PER_PEDESTRIAN = 7
"""How many numbers describe one pedestrian."""
NEIGHBOURS = ("ahead", "behind", "left_ahead", "left_behind", "right_ahead", "right_behind")


@dataclass(frozen=True, slots=True)
class Entry:
    """One number of an observation."""

    name: str
    """Ends in the unit, if there is one."""
    low: float
    high: float
    meaning: str


class View:
    """Turns a perception into numbers; distances are measured along the route from the front bumper.

    Parameters
    ----------
    pedestrians
        Number of pedestrians reported, the nearest ones; places that are not needed are 0.
    """

    def __init__(self, pedestrians: int = 6) -> None:
        if pedestrians < 0:
            raise ValueError(f"pedestrians = {pedestrians} must be at least 0")
        self.pedestrians = pedestrians
        self.entries: tuple[Entry, ...] = tuple(_entries(pedestrians))
        self.low: Observation = np.array([one.low for one in self.entries], np.float32)
        self.high: Observation = np.array([one.high for one in self.entries], np.float32)
        self._places = {one.name: place for place, one in enumerate(self.entries)}

    def __len__(self) -> int:
        return len(self.entries)

    def place(self, name: str) -> int:
        """Return the index of a number in an observation.

        Raises
        ------
        KeyError
            If there is no such number.
        """
        return self._places[name]

    def observe(self, perception: Perception) -> Observation:
        """Return the numbers, limited to their bounds; shape (n,)."""
        scalars = [*_ego(perception), *_road(perception), *_vehicles(perception)]
        seen = np.zeros(len(self.entries), np.float32)
        seen[: len(scalars)] = scalars
        _tell_people(perception, seen[len(scalars) :].reshape(-1, PER_PEDESTRIAN))
        np.maximum(seen, self.low, out=seen)
        return np.minimum(seen, self.high, out=seen)


def _entries(pedestrians: int) -> Iterator[Entry]:
    yield Entry("speed_mps", 0.0, FASTEST, "of the ego")
    yield Entry("acceleration_mps2", -12.0, 12.0, "of the ego, realised")
    yield Entry("steering_rad", -1.0, 1.0, "front-wheel angle, realised, left positive")
    yield Entry("across_m", -30.0, 30.0, "offset from the middle of its lane, left positive")
    yield Entry("heading_error_rad", -math.pi, math.pi, "relative to its lane")
    yield Entry("speed_limit_mps", 0.0, FASTEST, "here")
    yield Entry("curvature_1pm", -1.0, 1.0, "of the lane 10 m ahead of the rear axle, left positive")
    yield Entry("lane_left", 0.0, 1.0, "1: there is a lane on the left")
    yield Entry("lane_right", 0.0, 1.0, "1: there is a lane on the right")
    yield Entry("route_end_m", -FAR, FAR, f"distance to the end of the route or of the lane; {FAR:g}: beyond")
    yield Entry("crossing_stop_line_m", -FAR, FAR, f"distance to the next crossing; {FAR:g}: none")
    yield Entry("crossing_exit_m", -FAR, FAR, f"distance to its end; {FAR:g}: none")
    yield Entry("crossing_zebra", 0.0, 1.0, "1: pedestrians have priority there")
    yield Entry("crossing_green", 0.0, 1.0, "1: a signal shows pedestrians green there")
    yield Entry("crossing_people", 0.0, 500.0, "pedestrians on it or waiting for it")
    yield Entry("signal_stop_line_m", -FAR, FAR, f"distance to the next signal's stop line; {FAR:g}: none")
    yield Entry("signal_red", 0.0, 1.0, "1: it is red")
    yield Entry("signal_amber", 0.0, 1.0, "1: it is amber")
    yield Entry("foe_stop_line_m", -FAR, FAR, "distance to where to wait for a vehicle with priority")
    yield Entry("foe_distance_m", -FAR, FAR, "distance of that vehicle from the conflict")
    yield Entry("foe_speed_mps", 0.0, FASTEST, "of that vehicle")
    for name in NEIGHBOURS:
        yield Entry(f"{name}_gap_m", -FAR, FAR, f"to the vehicle {name.replace('_', ' ')}; {FAR:g}: none")
        yield Entry(f"{name}_speed_mps", 0.0, FASTEST, "of that vehicle; of the ego if there is none")
    for number in range(1, pedestrians + 1):
        yield Entry(f"pedestrian_{number}_present", 0.0, 1.0, "0: the other numbers of this one are 0")
        yield Entry(f"pedestrian_{number}_along_m", -FAR, FAR, "distance along the route")
        yield Entry(f"pedestrian_{number}_across_m", -FAR, FAR, "offset from the lane, left positive")
        yield Entry(f"pedestrian_{number}_along_speed_mps", -15.0, 15.0, "velocity along the route")
        yield Entry(f"pedestrian_{number}_across_speed_mps", -15.0, 15.0, "velocity to the left")
        yield Entry(f"pedestrian_{number}_crossing", 0.0, 1.0, "1: on a crossing")
        yield Entry(f"pedestrian_{number}_waiting", 0.0, 1.0, "1: about to enter a crossing")


def _ego(perception: Perception) -> Iterator[float]:
    ego = perception.ego
    yield from (ego.speed, ego.acceleration, ego.steering, ego.across, ego.heading_error)


def _road(perception: Perception) -> Iterator[float]:
    road, front, people = perception.road, perception.ego.body.front, perception.pedestrians
    yield float(road.limit[max(int(np.searchsorted(road.limit_along, 0.0, side="right")) - 1, 0)])
    place = round(10.0 / road.curvature_step)
    yield float(road.curvature[place]) if place < len(road.curvature) else 0.0
    yield float(road.lane(road.reference + 1) is not None)
    yield float(road.lane(road.reference - 1) is not None)
    here = road.lane(road.reference)
    yield min(road.route_end, math.inf if here is None else here.follows_route_for) - front
    rear = front - perception.ego.body.length
    ahead = next(((i, one) for i, one in enumerate(road.crossings) if one.exit > rear), None)
    yield from _crossing(None if ahead is None else ahead[1], front)
    if ahead is None or not len(people):
        yield 0.0
    else:
        yield float(np.count_nonzero((people.on_crossing | people.waiting) & (people.crossing == ahead[0])))
    yield from _signal(next((one for one in road.signals if one.stop_line > rear), None), front)
    foes = [one for one in road.foes if one.must_yield]
    yield from _foe(min(foes, key=lambda one: one.entry, default=None), front)


def _crossing(one: Crossing | None, front: float) -> tuple[float, ...]:
    if one is None:
        return FAR, FAR, 0.0, 0.0
    zebra = one.kind is CrossingKind.ZEBRA
    return one.stop_line - front, one.exit - front, float(zebra), float(one.pedestrians_have_green or False)


def _signal(one: Signal | None, front: float) -> tuple[float, ...]:
    if one is None:
        return FAR, 0.0, 0.0
    return one.stop_line - front, float(one.state is SignalState.RED), float(one.state is SignalState.AMBER)


def _foe(one: JunctionFoe | None, front: float) -> tuple[float, ...]:
    return (FAR, FAR, 0.0) if one is None else (one.stop_line - front, one.foe_entry, one.foe_speed)


def _vehicles(perception: Perception) -> Iterator[float]:
    for name in NEIGHBOURS:
        one: Neighbour | None = getattr(perception.gaps, name)
        yield FAR if one is None else one.gap
        yield perception.ego.speed if one is None else one.speed


def _tell_people(perception: Perception, told: Observation) -> None:
    """Write the nearest pedestrians into an array, one a row; rows that are not needed stay 0."""
    people: Pedestrians = perception.pedestrians
    if not len(people) or not len(told):
        return
    along = people.along - perception.ego.body.front
    distance = np.where(people.along > -BEHIND, np.hypot(along, people.across), np.inf)
    near = np.argsort(distance, kind="stable")[: min(len(told), np.count_nonzero(np.isfinite(distance)))]
    columns = (people.across, people.along_speed, people.across_speed, people.on_crossing, people.waiting)
    told[: len(near), 0] = 1.0
    told[: len(near), 1] = along[near]
    for place, values in enumerate(columns, 2):
        told[: len(near), place] = values[near]
