"""Closed loops of the velocity-obstacle controller on the road without SUMO, and what came of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from controllers import catalog
from controllers.arrays import FloatArray
from controllers.interface import Decision, Perception, Plan
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
        bodies, people = self._egos(), [s.persons for s in self.snapshots]
        whose = np.repeat(np.arange(len(people)), [len(one.x) for one in people])
        x, y, radius = (
            np.concatenate([getattr(one, name) for one in people]) for name in ("x", "y", "radius")
        )
        return float((shapely.distance(bodies[whose], shapely.points(x, y)) - radius).min())

    def distance_to_vehicles(self) -> float:
        """Return the smallest distance between the ego's body and another one [m]; 0 is an overlap."""
        bodies, cars = self._egos(), [s.vehicles for s in self.snapshots]
        whose = np.repeat(np.arange(len(cars)), [len(one.x) for one in cars])
        names = ("x", "y", "heading", "length", "width")
        others = _bodies(*(np.concatenate([getattr(one, name) for one in cars]) for name in names))
        return float(shapely.distance(bodies[whose], others).min())

    def _egos(self) -> NDArray[np.object_]:
        egos = [snapshot.egos[0] for snapshot in self.snapshots]
        x, y, heading = np.array([(one.x, one.y, one.heading) for one in egos]).T
        return _bodies(x, y, heading, np.full(len(egos), 4.5), np.full(len(egos), 1.8))

    def arrival(self, x: float) -> float:
        """Return when the front bumper passes a place; inf if it does not [s]."""
        passed = np.flatnonzero(self.track[0] > x)
        return self.snapshots[passed[0]].time if len(passed) else float("inf")


def _bodies(
    x: FloatArray, y: FloatArray, heading: FloatArray, length: FloatArray, width: FloatArray
) -> NDArray[np.object_]:
    """Return rectangles as polygons; x and y are the middle of the front."""
    ahead = length[:, None] * np.array([-1.0, 0.0, 0.0, -1.0])
    beside = width[:, None] * np.array([-0.5, -0.5, 0.5, 0.5])
    cosine, sine = np.cos(heading)[:, None], np.sin(heading)[:, None]
    corners_x = x[:, None] + cosine * ahead - sine * beside
    corners_y = y[:, None] + sine * ahead + cosine * beside
    return np.asarray(shapely.polygons(np.stack((corners_x, corners_y), axis=-1)))


def ride(
    road: ToyRoad,
    walkers: Sequence[Motion] = (),
    vehicles: Sequence[Motion] = (),
    speed: float = 12.0,
    duration: float = 12.0,
    lane: int = 0,
    parameters: Mapping[str, Any] | None = None,
    controller: str = "vo_mpc",
    step: float = 0.1,
) -> Ride:
    """Drive a controller with those parameters."""
    world = ToyWorld(
        road,
        [ToyPedestrian(f"p{i}", motion) for i, motion in enumerate(walkers)],
        [ToyVehicle(f"v{i}", motion) for i, motion in enumerate(vehicles)],
        speed=speed,
        duration=duration,
        lane=lane,
        step=step,
    )
    record = Ride()
    run(world, {"ego": catalog.build(controller, **(parameters or {}))}, record)
    return record
