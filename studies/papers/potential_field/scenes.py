"""The four scenes of the potential-field paper, planned as paths and driven on the road without SUMO.

In the paper's frame, x is along the road from where the car's middle starts, and y to the left of the line
between the two lanes. The car is in the left lane.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np

from analysis.geometry import signed_distance, to_frame
from controllers import catalog
from controllers.arrays import FloatArray
from controllers.interface import Decision, Perception, Plan
from controllers.potential_field.field import (
    Field,
    Gains,
    curvature,
    descend,
    distance_to_shift,
    meeting_time,
    needed_shift,
    side_distance,
    standing,
)
from controllers.prediction.direction_choice import WALKING_SPEED, velocity
from cosim.step.loop import ToWorld, run
from cosim.step.plant import body_of
from cosim.step.toy_road import ToyPedestrian, ToyRoad, walk
from cosim.step.toy_world import ToyWorld
from cosim.step.world import Snapshot

GRAVITY = 9.80665
SPEED = 25.0
LANE_WIDTH = 4.0
EDGE = 4.0
CENTRE = 2.0
PEDESTRIAN_RADIUS = 0.3
CAR_LENGTH = 4.6
CAR_WIDTH = 1.86
MARGIN = 0.6
LATERAL_ACCELERATION: Final = 0.3 * GRAVITY
FIXED_AXIS = 15.0
SAFE: Final = side_distance(PEDESTRIAN_RADIUS, CAR_WIDTH, MARGIN)
PATH_STEP = 0.25
PATH_STEPS = 480
AVOIDING = 0.1
"""The car has begun to avoid when it is farther than this from its lane's centre line [m]."""
DURATION = 4.5
CONTROLLER = "potential_field"


@dataclass(frozen=True, slots=True)
class Scene:
    """A pedestrian's start and direction of walking.

    Parameters
    ----------
    name : number in the paper
    x, y : start, in the paper's frame [m]
    angle : angle between the directions of car and pedestrian [rad]; ``None`` if the pedestrian stands
    """

    name: str
    x: float
    y: float
    angle: float | None

    @property
    def velocity(self) -> tuple[float, float]:
        """Velocity of the pedestrian, who starts on the left [m/s]."""
        if self.angle is None:
            return 0.0, 0.0
        return velocity(self.angle, WALKING_SPEED, from_left=True)

    @property
    def meeting(self) -> float:
        """Time at which the car is level with the pedestrian [s]."""
        return float(meeting_time(np.array([self.x]), np.array([self.velocity[0]]), 0.0, SPEED)[0])

    @property
    def conflict(self) -> tuple[float, float]:
        """Position of the pedestrian at that time, in the paper's frame [m]."""
        return self.x + self.velocity[0] * self.meeting, self.y + self.velocity[1] * self.meeting

    @property
    def long_axis(self) -> float:
        """The ellipse's variable half-axis σ_x [m]."""
        shift = needed_shift(np.array([self.conflict[1]]), CENTRE, SAFE)
        return float(distance_to_shift(SPEED, shift, LATERAL_ACCELERATION)[0])

    def places(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the pedestrian's positions at given times [m]."""
        return self.x + self.velocity[0] * times, self.y + self.velocity[1] * times


SCENES: Final = (
    Scene("1", 50.0, 3.0, None),
    Scene("2", 50.0, 4.0, math.radians(30.0)),
    Scene("3", 50.0, 3.0, math.radians(90.0)),
    Scene("4", 50.0, 4.0, math.radians(150.0)),
)
"""Starts that fit the paper's text on each scene, since the table of starts is lost."""


@dataclass(frozen=True)
class Track:
    """Positions of the car's middle in a scene at K instants, in the paper's frame."""

    scene: Scene
    times: FloatArray
    x: FloatArray
    y: FloatArray
    heading: FloatArray
    bends: FloatArray
    """Curvature of the path [1/m]."""

    @cached_property
    def highest_curvature(self) -> float:
        """Largest curvature to either side [1/m]."""
        return float(np.abs(self.bends).max())

    @property
    def lateral_acceleration(self) -> float:
        """Lateral acceleration at the largest curvature and the scenes' speed [m/s²]."""
        return self.highest_curvature * SPEED**2

    @cached_property
    def distances(self) -> FloatArray:
        """Distances between the bodies of car and pedestrian [m]; negative where they overlap."""
        px, py = self.scene.places(self.times)
        ahead, beside = to_frame(px - self.x, py - self.y, self.heading)
        return signed_distance(ahead, beside, 0.5 * CAR_LENGTH, 0.5 * CAR_WIDTH) - PEDESTRIAN_RADIUS

    @property
    def clearance(self) -> float:
        """Smallest distance between the bodies [m]."""
        return float(self.distances.min())

    @property
    def begins(self) -> float:
        """Position at which the car begins to avoid [m]; inf if it does not."""
        off = np.flatnonzero(np.abs(self.y - CENTRE) > AVOIDING)
        return float(self.x[off[0]]) if len(off) else math.inf

    @property
    def side(self) -> str:
        """Side on which the car passes the pedestrian."""
        level = float(np.interp(self.scene.conflict[0], self.x, self.y))
        return "left" if level > CENTRE else "right"

    @property
    def beyond_edge(self) -> float:
        """Largest distance by which the body extends beyond the road; negative if it stays on it [m]."""
        half = 0.5 * (CAR_LENGTH * np.abs(np.sin(self.heading)) + CAR_WIDTH * np.cos(self.heading))
        return float((np.abs(self.y) + half).max() - EDGE)

    def falls_then_rises(self) -> bool:
        """Return whether the distance between the centres has one minimum, at the fifth of nine instants.

        The instants are evenly spaced; at the fifth, a car that keeps its lane is level with the pedestrian.
        The paper shows nine instants without their times.
        """
        instants = np.linspace(0.0, 2.0 * self.scene.meeting, 9)
        px, py = self.scene.places(instants)
        own_x, own_y = (np.interp(instants, self.times, values) for values in (self.x, self.y))
        apart = np.hypot(px - own_x, py - own_y)
        return bool((np.diff(apart[:5]) < 0.0).all() and (np.diff(apart[4:]) > 0.0).all())


def field_of(scene: Scene, long_axis: float, gains: Gains, *, moving: bool = False) -> Field:
    """Return the field of a scene.

    Parameters
    ----------
    scene, gains : scene and gains of the field
    long_axis : σ_x [m]
    moving : whether the obstacle moves with the pedestrian; otherwise it stays at the conflict point
    """
    place = (scene.x, scene.y) if moving else scene.conflict
    obstacle = standing(*(np.array([value]) for value in (*place, long_axis, SAFE)))
    if moving:
        along, across = scene.velocity
        obstacle = replace(obstacle, along_speed=np.array([along]), across_speed=np.array([across]))
    return Field(-EDGE, EDGE, CENTRE, np.zeros(1), obstacle, gains)


def planned(scene: Scene, long_axis: float, gains: Gains | None = None, *, moving: bool = False) -> Track:
    """Return the path that descends the field of a scene, followed by a point at constant speed."""
    return tracks(scene, field_of(scene, long_axis, gains or Gains(), moving=moving), 1)[0]


def tracks(scene: Scene, shape: Field, count: int) -> list[Track]:
    """Return the paths that descend several fields of a scene."""
    start = np.zeros(count), np.full(count, CENTRE)
    x, y = descend(shape, *start, SPEED, PATH_STEP, PATH_STEPS)
    times = np.linspace(0.0, PATH_STEPS * PATH_STEP / SPEED, PATH_STEPS + 1)
    heading = np.arctan2(np.gradient(y, axis=0), np.gradient(x, axis=0))
    bends = curvature(x, y)
    return [Track(scene, times, x[:, i], y[:, i], heading[:, i], bends[:, i]) for i in range(count)]


@dataclass(slots=True)
class _Record:
    """Record of a run of the loop."""

    snapshots: list[Snapshot] = field(default_factory=list)
    statuses: list[str] = field(default_factory=list)

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        self.statuses.append(plan.status)

    def stepped(self, snapshot: Snapshot) -> None:
        self.snapshots.append(snapshot)


def driven(scene: Scene, axis: str) -> Track:
    """Return the controller's track in a scene; the vehicle has lags and limits, and plans every 0.1 s.

    Parameters
    ----------
    scene : scene to drive
    axis : ``variable`` or ``fixed``

    Raises
    ------
    RuntimeError
        If the controller used a fallback, so that the run does not test the method.
    """
    body = body_of(CAR_LENGTH, CAR_WIDTH)
    middle = body.front - 0.5 * body.length
    # The world's x begins at the rear axle, its y on the right lane's centre line.
    motion = walk(scene.x + middle, scene.y + 0.5 * LANE_WIDTH, *scene.velocity)
    world = ToyWorld(
        ToyRoad(lanes=2, lane_width=LANE_WIDTH, speed_limit=SPEED),
        [ToyPedestrian("pedestrian", motion, PEDESTRIAN_RADIUS)],
        speed=SPEED,
        lane=1,
        duration=DURATION,
        body=body,
    )
    driver = catalog.build(
        CONTROLLER,
        axis=axis,
        fixed_axis_m=FIXED_AXIS,
        side_margin_m=MARGIN,
        braking="none",
    )
    record = _Record()
    run(world, {world.name: driver}, record)
    if set(record.statuses) != {"ok"}:
        raise RuntimeError(f"scene {scene.name}, {axis} axis: plans were {sorted(set(record.statuses))}")
    egos = [snapshot.egos[0] for snapshot in record.snapshots]
    heading = np.array([ego.heading for ego in egos])
    return Track(
        scene,
        np.array([snapshot.time for snapshot in record.snapshots]),
        np.array([ego.x for ego in egos]) - 0.5 * body.length * np.cos(heading) - middle,
        np.array([ego.y for ego in egos]) - 0.5 * body.length * np.sin(heading) - 0.5 * LANE_WIDTH,
        heading,
        np.tan([ego.steering for ego in egos]) / body.wheelbase,
    )
