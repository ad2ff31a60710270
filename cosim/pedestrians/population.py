"""Creates the pedestrians that the tables of a scenario describe; the seed decides all that is random."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np

from cosim.arrays import FloatArray
from cosim.pedestrians.behaviour import Behaviour, Leg
from cosim.pedestrians.crossing_direction import CrossingDirection
from cosim.pedestrians.hesitating import Hesitating
from cosim.pedestrians.jaywalking import Roadside, Wish, jaywalk_line
from cosim.pedestrians.line import Line
from cosim.pedestrians.manner import Manner, Pace
from cosim.pedestrians.recorded import Recorded
from cosim.pedestrians.running import Running
from cosim.pedestrians.start import AtTime, EgoNear, Impact, Start, WhenClear, WhileSignal
from cosim.pedestrians.steady import Steady
from cosim.pedestrians.swerving import Swerving
from cosim.pedestrians.turning_back import TurningBack
from cosim.pedestrians.walker import Walker
from sumo_scenarios.distribution import Distribution
from sumo_scenarios.pedestrian_tables import (
    CrossingTable,
    JaywalkTable,
    LineTable,
    MannerTable,
    PedestrianTable,
    StartTable,
    TrajectoryTable,
    WalkerTable,
)
from sumo_scenarios.trajectories import read_trajectories

ON_THE_ROAD = 2.0
"""Largest gap that a pedestrian who is already on the road needs [s]."""


class Places(Protocol):
    """Finds the positions in the world of the places that a scenario names."""

    def on_lane(self, lane: str, along: float, across: float) -> tuple[float, float]:
        """Return the point at a distance along and across a lane [m]."""
        ...

    def roadside(self, edge: str, opposite: str, along: float) -> Roadside:
        """Return the cross-section of the road at a distance along an edge [m]."""
        ...

    def crossing(self, name: str) -> Line:
        """Return the axis of a crossing from kerb to kerb."""
        ...

    def check_inside(self, points: FloatArray) -> int | None:
        """Return the index of the first point (n, 2) too far from the network; ``None`` if none is."""
        ...


@dataclass(frozen=True, slots=True)
class Scripted:
    """One pedestrian and their behaviour."""

    name: str
    kind: str
    """Kind of the scenario table that describes the pedestrian."""
    behaviour: Behaviour


class Population:
    """All scripted pedestrians of a run.

    Parameters
    ----------
    tables : tables of the scenario
    places : finds the positions that the tables name
    seed : seed of the run
    begin, end : simulated time of the end of the warm-up and of the run [s]

    Raises
    ------
    ValueError
        If a place does not exist or a trajectory leaves the network. The message is one line.
    """

    def __init__(
        self, tables: Sequence[PedestrianTable], places: Places, seed: int, begin: float, end: float
    ) -> None:
        self._places = places
        self._seed = seed
        self._begin = begin
        self._tables = [table for table in tables if isinstance(table, WalkerTable)]
        fixed: list[Scripted] = []
        for table in tables:
            if isinstance(table, TrajectoryTable):
                fixed += self._recorded(table)
            elif isinstance(table, WalkerTable):
                # Create them once as a trial, so that impossible tables are found before the run begins.
                self._walkers(table, "try", begin, "")
                if not table.start.by_ego:
                    for number, time in enumerate(self._times(table, end)):
                        fixed += self._walkers(table, str(number), time, "")
        self.fixed: tuple[Scripted, ...] = tuple(fixed)
        """Pedestrians who appear independently of the egos."""
        self.signals = frozenset(
            table.crossing
            for table in self._tables
            if isinstance(table, CrossingTable) and table.start.signal
        )
        """Crossings whose signals pedestrians wait for."""

    def for_ego(self, ego: str) -> tuple[Scripted, ...]:
        """Return the pedestrians who wait for an ego; the same ones for the same seed and name."""
        return tuple(
            one
            for table in self._tables
            if table.start.by_ego
            for one in self._walkers(table, ego, self._begin, ego)
        )

    def _recorded(self, table: TrajectoryTable) -> list[Scripted]:
        found = []
        for person, points in read_trajectories(Path(table.file)).items():
            outside = self._places.check_inside(points[:, 1:])
            if outside is not None:
                time, x, y = points[outside].tolist()
                who = f"person '{person}'" if person else "the person"
                raise ValueError(f"{table.file}: {who} leaves the network at {time:g} s, at ({x:g}, {y:g})")
            name = f"{table.name}#{person}" if person else table.name
            found.append(Scripted(name, table.kind, Recorded(points, self._begin + table.start_s)))
        return found

    def _times(self, table: WalkerTable, end: float) -> list[float]:
        if table.start.time_s is not None:
            return [self._begin + table.start.time_s]
        rate = (table.start.per_hour or 0.0) / 3600.0
        if rate <= 0.0:
            return []
        generator = self._stream(table, "", "arrivals")
        times: list[float] = []
        time = self._begin + float(generator.exponential(1.0 / rate))
        while time < end:
            times.append(time)
            time += float(generator.exponential(1.0 / rate))
        return times

    def _walkers(self, table: WalkerTable, instance: str, time: float, ego: str) -> list[Scripted]:
        """Return one pedestrian, or all members of one group."""

        def draw(what: str, distribution: Distribution | None) -> float | None:
            return None if distribution is None else distribution.draw(self._stream(table, instance, what))

        def given(what: str, distribution: Distribution) -> float:
            return distribution.draw(self._stream(table, instance, what))

        line = self._line(table, instance)
        stop = draw("stop_after_m", table.stop_after_m)
        length = line.length if stop is None else min(stop, line.length)
        pace = Pace(given("speed_mps", table.speed_mps), table.acceleration_distance_m)
        chosen = Distribution(
            "choice",
            tuple(float(number) for number in range(len(table.manners))),
            tuple(manner.weight for manner in table.manners),
        )
        which = table.manners[int(given("manner", chosen))]
        manner = _manner(which, draw)
        start = _start(table.start, draw, line, manner.legs(pace, length), time, ego)
        gap = draw("accepted_gap_s", table.start.accepted_gap_s)
        start = self._conditions(start, table, line, pace, gap)
        looks = self._stream(table, instance, "looks").random() < given("watchful", table.start.watchful)
        watches = min(gap, ON_THE_ROAD) if gap is not None and looks else None
        appears = time if table.start.per_hour is not None else self._begin
        stay = given("stay_s", table.stay_s)
        leader = Walker(line, pace, manner, start, length, stay, appears, ego, watches)
        size = 1 if table.group is None else round(given("size", table.group.size))
        spacing = 0.0 if table.group is None else table.group.spacing_m
        walkers = [
            replace(leader, line=line.shifted(0.0, _beside(member, spacing))) for member in range(size)
        ]
        behaviours: list[Behaviour] = list(walkers)
        if which.kind == "social_force":
            seeds = self._stream(table, instance, "unevenness").integers(2**31, size=size).tolist()
            behaviours = [Swerving(walker, seed) for walker, seed in zip(walkers, seeds, strict=True)]
        name = table.name if table.start.time_s is not None else f"{table.name}#{instance}"
        names = [name] if size == 1 else [f"{name}.{member}" for member in range(size)]
        return [Scripted(name, table.kind, one) for name, one in zip(names, behaviours, strict=True)]

    def _line(self, table: WalkerTable, instance: str) -> Line:
        generator = self._stream(table, instance, "line")
        if isinstance(table, LineTable):
            (x, y), (end_x, end_y) = (self._place(table, place) for place in (table.from_m, table.to_m))
            return Line(x, y, end_x, end_y)
        if isinstance(table, CrossingTable):
            axis = self._places.crossing(table.crossing)
            turned = table.side == "last" or (table.side == "both" and generator.random() < 0.5)
            if turned:
                axis = Line(axis.end_x, axis.end_y, axis.x, axis.y)
            (x, y), (end_x, end_y) = axis.point(-table.setback_m), axis.point(axis.length + table.setback_m)
            return Line(x, y, end_x, end_y)
        assert isinstance(table, JaywalkTable)
        low, high = table.section_m
        road = self._places.roadside(
            table.edge, table.opposite, low + (high - low) * float(generator.random())
        )
        from_left = table.side == "left" or (table.side == "both" and bool(generator.random() < 0.5))
        goal = table.goal_along_m.draw(self._stream(table, instance, "goal_along_m"))
        wish = Wish(from_left, table.setback_m, goal, table.goal_beyond_m)
        model = CrossingDirection(scale=table.choice_scale)
        return jaywalk_line(road, wish, model, self._stream(table, instance, "direction"))

    def _place(self, table: LineTable, place: Sequence[float]) -> tuple[float, float]:
        x, y = place[0] + table.shift_m[0], place[1] + table.shift_m[1]
        return self._places.on_lane(table.lane, x, y) if table.lane else (x, y)

    @staticmethod
    def _conditions(start: Start, table: WalkerTable, line: Line, pace: Pace, gap: float | None) -> Start:
        if gap is not None:
            start = WhenClear(start, line, gap, pace.speed)
        if table.start.signal and isinstance(table, CrossingTable):
            start = WhileSignal(start, table.crossing, table.start.signal == "green")
        return start

    def _stream(self, table: PedestrianTable, instance: str, what: str) -> np.random.Generator:
        """Return a generator for one purpose, whose numbers do not depend on what else is drawn."""
        digest = hashlib.sha256(f"{self._seed}|{table.name}|{instance}|{what}".encode()).digest()
        return np.random.default_rng(int.from_bytes(digest[:16], "big"))


Draw = Callable[[str, Distribution | None], float | None]


def _start(table: StartTable, draw: Draw, line: Line, legs: tuple[Leg, ...], time: float, ego: str) -> Start:
    """Return the start without the conditions on gaps and signals."""
    distance = draw("ego_distance_m", table.ego_distance_m)
    arrival = draw("ego_arrival_s", table.ego_arrival_s)
    overlap = draw("overlap", table.overlap)
    if distance is not None:
        return EgoNear(line, distance=distance, ego=ego)
    if arrival is not None:
        return EgoNear(line, arrival=arrival, ego=ego)
    if overlap is not None:
        return Impact(line, overlap, legs, table.ego_speed_mps, ego)
    return AtTime(time)


def _manner(table: MannerTable, draw: Draw) -> Manner:
    after = draw("after_m", table.after_m)
    pause = draw("pause_s", table.pause_s) or 0.0
    speed = draw("manner_speed_mps", table.speed_mps)
    within = draw("ego_within_s", table.ego_within_s) or 0.0
    if table.kind == "hesitating":
        return Hesitating(math.inf if after is None else after, pause)
    if table.kind == "running" and speed is not None:
        return Running(speed, math.inf if after is None else after, within)
    if table.kind == "turning_back":
        return TurningBack(math.inf if after is None else after, pause, speed, within)
    return Steady()


def _beside(member: int, spacing: float) -> float:
    """Return how far to the left of the first a group member walks: 0, 1, −1, 2, −2 … spacings [m]."""
    return spacing * ((member + 1) // 2) * (1 if member % 2 else -1)
