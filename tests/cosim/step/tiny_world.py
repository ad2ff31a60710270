"""A straight road with one pedestrian beside it: just enough world for the step."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from controllers.interface import (
    Body,
    Command,
    Decision,
    EgoState,
    Lane,
    Manoeuvre,
    Neighbour,
    NeighbourGaps,
    Pedestrians,
    Perception,
    Plan,
    RoadAhead,
    Vehicles,
    constant_command,
)
from controllers.velocity_obstacle.decision_rules import Rule
from cosim.arrays import FloatArray
from cosim.errors import SimulationError
from cosim.step.plant import CAR_DRIVE
from cosim.step.world import EgoTruth, MapArea, PersonsTruth, Snapshot, VehiclesTruth

NONE = np.zeros(0)
BODY = Body()


class TinyWorld:
    """Egos that roll along the x axis; plans every other step; may break on purpose."""

    def __init__(
        self, egos: tuple[str, ...] = ("ego",), steps: int = 10, step: float = 0.05, breaks_at: int = -1
    ):
        self.step = step
        self.names = egos
        self.steps = steps
        self.breaks_at = breaks_at
        self.done = 0
        self.speed = dict.fromkeys(egos, 10.0)
        self.x = dict.fromkeys(egos, 0.0)
        self.command = {name: constant_command(0.0, 0.0) for name in egos}
        self.closed = False

    @property
    def time(self) -> float:
        return self.done * self.step

    def sense(self) -> Sequence[Perception] | None:
        if self.done >= self.steps:
            return None
        return [self.perception(name) for name in self.names] if self.done % 2 == 0 else []

    def perception(self, name: str) -> Perception:
        ego = EgoState(
            name,
            self.time,
            self.x[name],
            0.0,
            0.0,
            0.0,
            0.0,
            self.speed[name],
            0.0,
            0.0,
            BODY,
            CAR_DRIVE,
            0.1,
        )
        persons = Pedestrians(
            ("ped",),
            np.array([30.0]),
            np.array([-5.0]),
            np.array([0.0]),
            np.array([1.3]),
            np.array([0.25]),
            np.array([-1]),
            np.array([False]),
            np.array([False]),
        )
        road = RoadAhead(
            (Lane(0, 0.0, 3.2, float("inf")),), 0, -1.6, 1.6, NONE, 1.0, np.zeros(1), np.array([13.9])
        )
        return Perception(
            ego,
            persons,
            Vehicles((), NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE),
            NeighbourGaps(ahead=Neighbour("leader", 12.5, 9.0, 0.0, 4.5)),
            road,
        )

    def act(self, name: str, command: Command) -> None:
        self.command[name] = command

    def advance(self) -> None:
        if self.done == self.breaks_at:
            raise SimulationError("the road broke")
        for name in self.names:
            self.speed[name] += self.step * float(self.command[name].acceleration[0])
            self.x[name] += self.step * self.speed[name]
        self.done += 1

    def snapshot(self) -> Snapshot:
        persons = PersonsTruth(
            names=("ped",),
            x=np.array([30.0]),
            y=np.array([-5.0 + 1.3 * self.time]),
            x_speed=np.array([0.0]),
            y_speed=np.array([1.3]),
            radius=np.array([0.25]),
            place=("walk",),
            crossing=(None,),
            phase=("walking",),
            kind=("adult",),
        )
        vehicles = VehiclesTruth(
            names=("leader",),
            x=np.array([40.0]),
            y=np.array([0.0]),
            heading=np.array([0.0]),
            speed=np.array([9.0]),
            length=np.array([4.5]),
            width=np.array([1.8]),
            place=("e_0",),
            kind=("car",),
        )
        return Snapshot(self.time, tuple(self.truth(name) for name in self.names), persons, vehicles)

    def truth(self, name: str) -> EgoTruth:
        front = self.x[name] + BODY.front
        speed = self.speed[name]
        return EgoTruth(
            name=name,
            body=BODY,
            x=front,
            y=0.0,
            heading=0.0,
            speed=speed,
            acceleration=0.0,
            steering=0.0,
            edge="e",
            lane="e_0",
            route_position=self.x[name],
            speed_limit=13.9,
            commanded_acceleration=0.0,
            commanded_steering=0.0,
            executed_x=front,
            executed_y=0.0,
            executed_speed=speed,
        )

    def to_world(self, name: str, along: FloatArray, across: FloatArray) -> FloatArray:
        return np.column_stack([self.x[name] + along, across])

    def map_areas(self) -> Sequence[MapArea]:
        return [MapArea("e_0", "lane", 3.2, np.array([[0.0, 0.0], [1000.0, 0.0]]))]

    def close(self) -> None:
        self.closed = True


class SteadyDriver:
    """Commands one acceleration and draws a short plan."""

    def __init__(self, acceleration: float = 1.0) -> None:
        self.acceleration = acceleration

    def decide(self, perception: Perception) -> Decision:
        return Decision(Manoeuvre.KEEP, perception.road.reference, Rule.STRAIGHT, "leader")

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        times = np.array([0.1, 0.2])
        return Plan(
            constant_command(self.acceleration, 0.0),
            times=times,
            along=10.0 * times,
            across=0.0 * times,
            speed=10.0 + times,
            overlay={"cone": np.array([[0.0, 1.0], [np.inf, 2.0]])},
        )


def without_planning(world: TinyWorld) -> Snapshot:
    """Return a snapshot of a road without egos, persons and vehicles."""
    snapshot = world.snapshot()
    persons = PersonsTruth(
        names=(),
        x=NONE,
        y=NONE,
        x_speed=NONE,
        y_speed=NONE,
        radius=NONE,
        place=(),
        crossing=(),
        phase=(),
        kind=(),
    )
    vehicles = VehiclesTruth(
        names=(), x=NONE, y=NONE, heading=NONE, speed=NONE, length=NONE, width=NONE, place=(), kind=()
    )
    return dataclasses.replace(snapshot, egos=(), persons=persons, vehicles=vehicles)
