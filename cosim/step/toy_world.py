"""A straight road without SUMO: fast tests, and experiments with exact initial conditions.

The ego is the same plant as in SUMO. Perception is exact, unless a sensing model is given.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from controllers.interface import (
    Body,
    Command,
    Crossing,
    Drive,
    EgoState,
    Lane,
    PedestrianPhase,
    Pedestrians,
    Perception,
    RoadAhead,
    Vehicles,
    constant_command,
)
from cosim.arrays import FloatArray
from cosim.sensing.eyesight import eyesight_of
from cosim.sensing.interface import Scene, Sensing, Site
from cosim.sensing.models.perfect import Model as Perfect
from cosim.sensing.senses import Senses
from cosim.step.plant import CAR_DRIVE, Plant
from cosim.step.toy_road import ReactingMotion, ToyCrossing, ToyPedestrian, ToyRoad, ToyVehicle, gaps_among
from cosim.step.world import EgoTruth, MapArea, PersonsTruth, Snapshot, VehiclesTruth


@dataclass(slots=True)
class ToyWorld:
    """One ego on a straight road; see :class:`cosim.step.world.World`.

    Parameters
    ----------
    road, pedestrians, vehicles
        The scene.
    speed
        Speed of the ego at the start [m/s].
    lane
        Index of the lane in which it starts.
    duration
        Duration of the run [s].
    step
        Length of a step [s].
    sensing
        How the ego gets to know of pedestrians.
    seed
        Seed of the draws for sensing.
    """

    road: ToyRoad = field(default_factory=ToyRoad)
    pedestrians: Sequence[ToyPedestrian] = ()
    vehicles: Sequence[ToyVehicle] = ()
    speed: float = 10.0
    lane: int = 0
    duration: float = 20.0
    step: float = 0.1
    body: Body = field(default_factory=Body)
    drive: Drive = CAR_DRIVE
    view: float = 100.0
    name: str = "ego"
    sensing: Sensing = field(default_factory=Perfect)
    seed: int = 1
    time: float = field(init=False, default=0.0)
    plant: Plant = field(init=False)
    _command: Command = field(init=False)
    _reference: int = field(init=False)
    _travelled: float = field(init=False, default=0.0)
    _site: Site = field(init=False)
    _senses: Senses = field(init=False)
    _reacting: Sequence[ReactingMotion] = field(init=False)

    def __post_init__(self) -> None:
        self.plant = Plant(self.body, self.drive, 0.0, self.lane * self.road.lane_width, 0.0, self.speed)
        self._command = constant_command(0.0, 0.0)
        self._reference = self.lane
        self._site = self.road.site()
        self._senses = Senses(self.sensing, self._site, self.seed)
        # Found once: asking for a protocol takes as long as moving a pedestrian.
        self._reacting = [p.motion for p in self.pedestrians if isinstance(p.motion, ReactingMotion)]

    def sense(self) -> Sequence[Perception] | None:
        """Return the ego's perception; ``None`` after ``duration``."""
        if self.time >= self.duration - 1e-9:
            return None
        self._switch_lane()
        self._senses.begin()
        vehicles = self._vehicles()
        return (
            Perception(
                self._ego(),
                self._pedestrians(),
                vehicles,
                gaps_among(vehicles, self.body, self.road.lane_width),
                self._road(),
                eyesight_of(self.sensing, self._site, self.body),
            ),
        )

    def act(self, name: str, command: Command) -> None:
        """Follow a command from now on."""
        self._command = command

    def advance(self) -> None:
        """Move on by one step."""
        before = (self.plant.x, self.plant.y)
        self.plant.follow(self._command, 0.0, self.step)
        self._travelled += float(np.hypot(self.plant.x - before[0], self.plant.y - before[1]))
        self.time = round(self.time + self.step, 9)
        for motion in self._reacting:
            motion.react(self.time, self.plant)

    def snapshot(self) -> Snapshot:
        """Return the truth after the last step."""
        plant = self.plant
        x, y = plant.front
        lane = f"toy_{self._reference}"
        command = self._command
        ego = EgoTruth(
            name=self.name,
            body=self.body,
            x=x,
            y=y,
            heading=plant.heading,
            speed=plant.speed,
            acceleration=plant.acceleration,
            steering=plant.steering,
            edge="toy",
            lane=lane,
            route_position=self._travelled,
            speed_limit=self.road.speed_limit,
            commanded_acceleration=float(command.acceleration[0]),
            commanded_steering=float(command.steering[0]),
            executed_x=x,
            executed_y=y,
            executed_speed=plant.speed,
        )
        people = [p.motion(self.time) for p in self.pedestrians]
        cars = [v.motion(self.time) for v in self.vehicles]
        p, v = _columns(people), _columns(cars)
        crossing = [self.road.crossing_at(x, y) for x, y, *_ in people]
        return Snapshot(
            self.time,
            (ego,),
            PersonsTruth(
                names=tuple(q.name for q in self.pedestrians),
                x=p[0],
                y=p[1],
                x_speed=p[2],
                y_speed=p[3],
                radius=np.array([q.radius for q in self.pedestrians]),
                place=tuple(f"toy_c{c}" if c >= 0 else "toy" for c in crossing),
                crossing=tuple(f"toy_c{c}" if c >= 0 else None for c in crossing),
                phase=tuple(
                    (PedestrianPhase.CROSSING if c >= 0 else PedestrianPhase.WALKING).value for c in crossing
                ),
                kind=("pedestrian",) * len(people),
            ),
            VehiclesTruth(
                names=tuple(q.name for q in self.vehicles),
                x=v[0],
                y=v[1],
                heading=_heading(v),
                speed=np.hypot(v[2], v[3]),
                length=np.array([q.length for q in self.vehicles]),
                width=np.array([q.width for q in self.vehicles]),
                place=("toy",) * len(cars),
                kind=("passenger",) * len(cars),
            ),
            sensed=None if self.sensing.exact else self._senses.now,
        )

    def to_world(self, name: str, along: FloatArray, across: FloatArray) -> FloatArray:
        """Convert route-frame points to world coordinates."""
        return np.column_stack((along + self.plant.x, across + self.road.centre(self._reference)))

    def map_areas(self) -> Sequence[MapArea]:
        """Return lanes and crossings."""
        return self.road.map_areas(self.duration * 30.0)

    def close(self) -> None:
        """Nothing to release."""

    def _switch_lane(self) -> None:
        _, y = self.plant.front
        nearest = round(y / self.road.lane_width)
        off = abs(y - self.road.centre(self._reference))
        if off > 0.5 * self.road.lane_width + 0.1 and 0 <= nearest < self.road.lanes:
            self._reference = nearest

    def _ego(self) -> EgoState:
        p = self.plant
        return EgoState(
            self.name,
            self.time,
            p.x,
            p.y,
            p.heading,
            p.y - self.road.centre(self._reference),
            p.heading,
            p.speed,
            p.acceleration,
            p.steering,
            self.body,
            self.drive,
            self.step,
        )

    def _road(self) -> RoadAhead:
        centre = self.road.centre(self._reference)
        right, left = self.road.edges()
        lanes = tuple(
            Lane(i - self.lane, self.road.centre(i) - centre, self.road.lane_width, np.inf)
            for i in range(max(self._reference - 1, 0), min(self._reference + 2, self.road.lanes))
        )
        return RoadAhead(
            lanes=lanes,
            reference=self._reference - self.lane,
            right_edge=right - centre,
            left_edge=left - centre,
            curvature=np.zeros(int(self.view)),
            curvature_step=1.0,
            limit_along=np.array([-1e3]),
            limit=np.array([self.road.speed_limit]),
            crossings=tuple(
                Crossing(
                    f"toy_c{i}",
                    c.kind,
                    c.x - self.plant.x,
                    c.x + c.width - self.plant.x,
                    c.x - 1.0 - self.plant.x,
                    right - centre,
                    left - centre,
                    None,
                )
                for i, c in self._seen_crossings()
            ),
        )

    def _seen_crossings(self) -> list[tuple[int, ToyCrossing]]:
        behind = self.plant.x - self.body.rear_overhang
        return [
            (i, c)
            for i, c in enumerate(self.road.crossings)
            if c.x + c.width > behind and c.x < self.plant.x + self.view
        ]

    def _pedestrians(self) -> Pedestrians:
        centre = self.road.centre(self._reference)
        near = [
            (p, m)
            for p in self.pedestrians
            if np.hypot((m := p.motion(self.time))[0] - self.plant.x, m[1] - self.plant.y) < self.view
        ]
        c = _columns([m for _, m in near])
        index = {i: at for at, (i, _) in enumerate(self._seen_crossings())}
        on = np.array([index.get(self.road.crossing_at(m[0], m[1]), -1) for _, m in near], dtype=np.int64)
        names, radius = tuple(p.name for p, _ in near), np.array([p.radius for p, _ in near])
        told, uncertainty = np.arange(len(near)), np.zeros(len(near))
        if not self.sensing.exact:
            belief = self._senses.look(self._scene(names, c, radius))
            told, uncertainty = np.flatnonzero(belief.told), belief.uncertainty
            c = np.vstack([belief.position.T, belief.velocity.T])
        return Pedestrians(
            tuple(names[i] for i in told.tolist()),
            c[0, told] - self.plant.x,
            c[1, told] - centre,
            c[2, told],
            c[3, told],
            radius[told],
            on[told],
            on[told] >= 0,
            np.zeros(len(told), dtype=bool),
            uncertainty[told],
            c[:2, told].T,
            c[2:4, told].T,
        )

    def _scene(self, names: tuple[str, ...], motion: FloatArray, radius: FloatArray) -> Scene:
        cars = _columns([v.motion(self.time) for v in self.vehicles])
        return Scene(
            self.name,
            self.time,
            round(self.time / self.step),
            self.plant.x,
            self.plant.y,
            self.plant.heading,
            self.body,
            names,
            motion[:2].T,
            motion[2:].T,
            radius,
            cars[:2].T,
            _heading(cars),
            np.array([v.length for v in self.vehicles]),
            np.array([v.width for v in self.vehicles]),
        )

    def _vehicles(self) -> Vehicles:
        now = _columns([v.motion(self.time) for v in self.vehicles])
        before = _columns([v.motion(self.time - self.step) for v in self.vehicles])
        return Vehicles(
            tuple(v.name for v in self.vehicles),
            now[0] - self.plant.x,
            now[1] - self.road.centre(self._reference),
            now[2],
            now[3],
            (now[2] - before[2]) / self.step,
            _heading(now),
            np.array([v.length for v in self.vehicles]),
            np.array([v.width for v in self.vehicles]),
        )


def _columns(rows: Sequence[tuple[float, float, float, float]]) -> FloatArray:
    return np.array(rows, dtype=np.float64).reshape(len(rows), 4).T


def _heading(motion: FloatArray) -> FloatArray:
    """Return the headings of vehicles [rad]; a standing vehicle heads east."""
    return np.asarray(np.arctan2(motion[3], np.where(np.hypot(motion[2], motion[3]) > 1e-9, motion[2], 1.0)))
