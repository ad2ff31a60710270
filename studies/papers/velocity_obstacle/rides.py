"""The velocity-obstacle paper's scenes driven by the controllers, with actuators but without SUMO."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from controllers import catalog
from controllers.arrays import FloatArray
from controllers.interface import Decision, Perception, Plan
from cosim.step.loop import ToWorld
from cosim.step.loop import run as run_loop
from cosim.step.toy_road import ToyPedestrian, ToyRoad, walk
from cosim.step.toy_world import ToyWorld
from cosim.step.world import Snapshot
from studies.papers.velocity_obstacle.scenes import LISTED_AT_ONE, START_SPEED, Scene

TOP_SPEED = 15.0


@dataclass(slots=True)
class Track:
    """Positions of the rear axle after every step of a ride."""

    rows: list[tuple[float, float, float, float]] = field(default_factory=list)
    solved: bool = True
    world: ToyWorld | None = None

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Record a fallback."""
        self.solved &= plan.solved

    def stepped(self, snapshot: Snapshot) -> None:
        """Record time, position and speed."""
        if self.world is not None:
            plant = self.world.plant
            self.rows.append((snapshot.time, plant.x, plant.y, plant.speed))

    @property
    def columns(self) -> FloatArray:
        """Time, along, across and speed, shape (4, steps) [s, m, m, m/s]."""
        return np.array(self.rows).T

    def reaches(self, along: float) -> float:
        """Return when the car reaches a position along the road; inf for never [s]."""
        time, x, *_ = self.columns
        return float(np.interp(along, x, time)) if x[-1] >= along else float("inf")


def ride(scene: Scene, controller: str, duration: float = 14.0, **parameters: Any) -> Track:
    """Drive a scene; the speed limit equals the initial speed, so that the car has no reason to accelerate.

    Parameters
    ----------
    scene : scene to drive; the pedestrian's first sample is at 1 s
    controller, parameters : controller of the catalogue, and its parameters
    duration : duration of the ride [s]
    """
    begun = -6.0 - LISTED_AT_ONE
    person = ToyPedestrian("pedestrian", walk(scene.first_y - LISTED_AT_ONE, begun, 1.0, 1.0))
    road = ToyRoad(lanes=1, speed_limit=START_SPEED)
    world = ToyWorld(road, [person], speed=START_SPEED, duration=duration)
    track = Track(world=world)
    run_loop(world, {"ego": catalog.build(controller, **parameters)}, track)
    return track
