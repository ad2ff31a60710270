"""Closed loops of the velocity-obstacle controller on the road without SUMO, and what came of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from shapely import affinity
from shapely.geometry import Point, Polygon, box

from controllers import catalog
from controllers.interface import Decision, FloatArray, Perception, Plan
from cosim.step.loop import ToWorld, run
from cosim.step.toy_road import Motion, ToyPedestrian, ToyRoad, ToyVehicle
from cosim.step.toy_world import ToyWorld
from cosim.step.world import Snapshot


@dataclass(slots=True)
class Ride:
    """What was planned and what happened."""

    decisions: list[Decision] = field(default_factory=list)
    plans: list[Plan] = field(default_factory=list)
    snapshots: list[Snapshot] = field(default_factory=list)

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Keep a plan."""
        self.decisions.append(decision)
        self.plans.append(plan)

    def stepped(self, snapshot: Snapshot) -> None:
        """Keep the truth."""
        self.snapshots.append(snapshot)

    @property
    def track(self) -> FloatArray:
        """Front x, front y, speed and acceleration after every step, shape (4, steps)."""
        egos = [snapshot.egos[0] for snapshot in self.snapshots]
        return np.array([(e.x, e.y, e.speed, e.acceleration) for e in egos]).T

    @property
    def commands(self) -> FloatArray:
        """First acceleration and steering of every command."""
        return np.array([(p.command.acceleration[0], p.command.steering[0]) for p in self.plans])

    def clearance(self) -> float:
        """Return the smallest distance between the ego's body and a pedestrian's disc [m]."""
        return min(
            float(_body(s.egos[0].x, s.egos[0].y, s.egos[0].heading, 4.5, 1.8).distance(Point(x, y)) - radius)
            for s in self.snapshots
            for x, y, radius in zip(s.persons.x, s.persons.y, s.persons.radius, strict=True)
        )

    def distance_to_vehicles(self) -> float:
        """Return the smallest distance between the ego's body and another one [m]; 0 is an overlap."""
        return min(
            float(
                _body(s.egos[0].x, s.egos[0].y, s.egos[0].heading, 4.5, 1.8).distance(
                    _body(v.x[i], v.y[i], v.heading[i], v.length[i], v.width[i])
                )
            )
            for s in self.snapshots
            for v in (s.vehicles,)
            for i in range(len(v.x))
        )

    def arrival(self, x: float) -> float:
        """Return when the front bumper passes a place; inf if it does not [s]."""
        passed = np.flatnonzero(self.track[0] > x)
        return self.snapshots[passed[0]].time if len(passed) else float("inf")


def _body(x: float, y: float, heading: float, length: float, width: float) -> Polygon:
    straight = box(-length, -0.5 * width, 0.0, 0.5 * width)
    turned = affinity.rotate(straight, heading, origin=(0.0, 0.0), use_radians=True)
    return affinity.translate(turned, x, y)


def ride(
    road: ToyRoad,
    walkers: Sequence[Motion] = (),
    vehicles: Sequence[Motion] = (),
    speed: float = 12.0,
    duration: float = 12.0,
    lane: int = 0,
    parameters: Mapping[str, Any] | None = None,
    controller: str = "vo_mpc",
) -> Ride:
    """Drive a controller with those parameters."""
    world = ToyWorld(
        road,
        [ToyPedestrian(f"p{i}", motion) for i, motion in enumerate(walkers)],
        [ToyVehicle(f"v{i}", motion) for i, motion in enumerate(vehicles)],
        speed=speed,
        duration=duration,
        lane=lane,
    )
    record = Ride()
    run(world, {"ego": catalog.build(controller, **(parameters or {}))}, record)
    return record
