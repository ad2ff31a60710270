"""Perceptions to test controllers: parts with sensible defaults, and golden scenes named by situation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from controllers.interface import (
    Body,
    Crossing,
    CrossingKind,
    Drive,
    EgoState,
    JunctionFoe,
    Lane,
    Neighbour,
    NeighbourGaps,
    Pedestrians,
    Perception,
    Plan,
    RoadAhead,
    Signal,
    SignalState,
    Vehicles,
    constant_command,
)
from cosim.step.plant import CAR_DRIVE

LANE_WIDTH = 3.5
VIEW = 150.0
FRONT = Body().front
"""Longitudinal coordinate of the ego's front bumper [m]."""


@dataclass(frozen=True, slots=True)
class Walker:
    """One pedestrian."""

    along: float
    across: float
    along_speed: float = 0.0
    across_speed: float = 0.0
    crossing: int = -1
    on_crossing: bool = False
    waiting: bool = False


@dataclass(frozen=True, slots=True)
class Car:
    """One other vehicle; ``along`` is its front bumper."""

    along: float
    across: float
    along_speed: float = 0.0
    across_speed: float = 0.0
    heading_error: float = 0.0
    acceleration: float = 0.0
    length: float = 4.5
    width: float = 1.8


def ego(
    speed: float = 13.0,
    across: float = 0.0,
    heading_error: float = 0.0,
    plan_interval: float = 0.1,
    time: float = 0.0,
    acceleration: float = 0.0,
    steering: float = 0.0,
    limits: Drive | None = None,
) -> EgoState:
    """Return the state of an ego, by default a car in the middle of its lane."""
    return EgoState(
        "ego", time, 0.0, across, heading_error, across, heading_error, speed, acceleration, steering,
        Body(), limits or CAR_DRIVE, plan_interval,
    )  # fmt: skip


def straight_road(lanes: int = 1, reference: int = 0, limit: float = 13.89) -> RoadAhead:
    """Return a straight road of ``lanes`` lanes; the ego is in the one numbered ``reference``."""
    numbers = [number for number in range(lanes) if abs(number - reference) <= 1]
    return RoadAhead(
        lanes=tuple(
            Lane(number, (number - reference) * LANE_WIDTH, LANE_WIDTH, float("inf")) for number in numbers
        ),
        reference=reference,
        right_edge=(-reference - 0.5) * LANE_WIDTH,
        left_edge=(lanes - reference - 0.5) * LANE_WIDTH,
        curvature=np.zeros(int(VIEW) + 1),
        curvature_step=1.0,
        limit_along=np.array([-100.0]),
        limit=np.array([limit]),
    )


def lanes_that_follow(road: RoadAhead, distances: dict[int, float]) -> RoadAhead:
    """Return the road with lanes that follow the route only for a given distance, by lane number [m]."""
    return replace(
        road,
        lanes=tuple(
            replace(lane, follows_route_for=distances.get(lane.number, lane.follows_route_for))
            for lane in road.lanes
        ),
    )


def bend(road: RoadAhead, begins: float, radius: float, length: float) -> RoadAhead:
    """Return the road with a left-hand bend."""
    places = np.arange(len(road.curvature)) * road.curvature_step
    inside = (places >= begins) & (places <= begins + length)
    return replace(road, curvature=np.where(inside, 1.0 / radius, road.curvature))


def zebra(begins: float, kind: CrossingKind = CrossingKind.ZEBRA, width: float = 4.0) -> Crossing:
    """Return a crossing over a road of three lanes."""
    return Crossing("zebra", kind, begins, begins + width, begins - 1.0, -6.0, 6.0, None)


def keeps(speed: float) -> Plan:
    """Return a plan that keeps a speed in the middle of the lane."""
    horizon = np.linspace(0.2, 5.0, 25)
    still = np.zeros(len(horizon))
    return Plan(
        constant_command(0.0, 0.0), times=horizon, along=speed * horizon, across=still, speed=still + speed
    )


def pedestrians(walkers: Sequence[Walker] = ()) -> Pedestrians:
    """Return pedestrians as arrays, with a radius of 0.25 m."""
    return Pedestrians(
        names=tuple(f"person{i}" for i in range(len(walkers))),
        along=np.array([one.along for one in walkers], dtype=float),
        across=np.array([one.across for one in walkers], dtype=float),
        along_speed=np.array([one.along_speed for one in walkers], dtype=float),
        across_speed=np.array([one.across_speed for one in walkers], dtype=float),
        radius=np.full(len(walkers), 0.25),
        crossing=np.array([one.crossing for one in walkers], dtype=np.int64),
        on_crossing=np.array([one.on_crossing for one in walkers], dtype=bool),
        waiting=np.array([one.waiting for one in walkers], dtype=bool),
    )


def vehicles(cars: Sequence[Car] = ()) -> Vehicles:
    """Return vehicles as arrays."""
    return Vehicles(
        names=tuple(f"car{i}" for i in range(len(cars))),
        along=np.array([one.along for one in cars], dtype=float),
        across=np.array([one.across for one in cars], dtype=float),
        along_speed=np.array([one.along_speed for one in cars], dtype=float),
        across_speed=np.array([one.across_speed for one in cars], dtype=float),
        acceleration=np.array([one.acceleration for one in cars], dtype=float),
        heading_error=np.array([one.heading_error for one in cars], dtype=float),
        length=np.array([one.length for one in cars], dtype=float),
        width=np.array([one.width for one in cars], dtype=float),
    )


def gaps_between(road: RoadAhead, cars: Sequence[Car], name: str = "car") -> NeighbourGaps:
    """Return which of the cars are the ego's neighbours on this road."""
    found: dict[str, Neighbour] = {}
    for lane in road.lanes:
        side = {-1: "right_", 0: "", 1: "left_"}[lane.number - road.reference]
        for i, car in enumerate(cars):
            if abs(car.across - lane.offset) > 0.5 * lane.width:
                continue
            ahead = car.along - 0.5 * car.length > FRONT - 0.5 * Body().length
            gap = car.along - car.length - FRONT if ahead else FRONT - Body().length - car.along
            key = side + ("ahead" if ahead else "behind")
            if key not in found or gap < found[key].gap:
                found[key] = Neighbour(f"{name}{i}", gap, car.along_speed, car.acceleration, car.length)
    return NeighbourGaps(**found)


def perception(
    ego_state: EgoState | None = None,
    road: RoadAhead | None = None,
    walkers: Sequence[Walker] = (),
    cars: Sequence[Car] = (),
    crossings: Sequence[Crossing] = (),
    signals: Sequence[Signal] = (),
    foes: Sequence[JunctionFoe] = (),
) -> Perception:
    """Return a perception; the neighbours are derived from the cars."""
    road = replace(
        road or straight_road(), crossings=tuple(crossings), signals=tuple(signals), foes=tuple(foes)
    )
    return Perception(
        ego_state or ego(), pedestrians(walkers), vehicles(cars), gaps_between(road, cars), road
    )


def _crowd(count: int) -> list[Walker]:
    drawn = np.random.default_rng(7)
    return [
        Walker(float(a), float(c), 0.0, float(v), 0, True)
        for a, c, v in zip(
            drawn.uniform(28.0, 32.0, count),
            drawn.uniform(-6.0, 6.0, count),
            drawn.choice([-1.3, 1.3], count),
            strict=True,
        )
    ]


def golden() -> dict[str, Perception]:
    """Return one perception for each situation that every controller must survive."""
    wide = straight_road(3, 1)
    ending = lanes_that_follow(straight_road(2, 0), {0: 45.0})
    bare = replace(
        straight_road(),
        curvature=np.zeros(0),
        limit_along=np.array([0.0]),
        lanes=(Lane(0, 0.0, LANE_WIDTH, float("inf")),),
    )
    walker = Walker(30.0, -3.0, 0.0, 1.3, 0, True)
    return {
        "empty road": perception(),
        "three lanes": perception(road=wide),
        "no view of the road": perception(road=bare),
        "standing": perception(ego(speed=0.0)),
        "beside the lane and turned": perception(ego(speed=8.0, across=1.4, heading_error=-0.2), wide),
        "pedestrian crosses": perception(road=wide, walkers=[walker], crossings=[zebra(28.0)]),
        "pedestrian crosses an unmarked crossing": perception(
            road=wide, walkers=[walker], crossings=[zebra(28.0, CrossingKind.UNMARKED)]
        ),
        "pedestrian waits at the kerb": perception(
            walkers=[Walker(30.0, -6.5, crossing=0, waiting=True)], crossings=[zebra(28.0)]
        ),
        "pedestrian stands in the path": perception(walkers=[Walker(25.0, 0.2)]),
        "pedestrian at the bumper of a standing car": perception(
            ego(speed=0.0), walkers=[Walker(FRONT + 0.4, 0.0, 0.0, 1.2)]
        ),
        "pedestrian inside the body": perception(ego(speed=5.0), walkers=[Walker(1.0, 0.0, 0.0, 1.0)]),
        "five hundred pedestrians": perception(
            road=wide, walkers=_crowd(500), crossings=[zebra(28.0)]
        ),
        "leader brakes": perception(cars=[Car(30.0, 0.0, 6.0, acceleration=-3.0)]),
        "vehicle overlaps along the lane": perception(road=wide, cars=[Car(4.0, 0.0, 10.0)]),
        "boxed in": perception(
            road=wide,
            cars=[Car(a, c, 11.0) for a in (-6.0, 5.0, 16.0) for c in (-3.5, 3.5)] + [Car(18.0, 0.0, 5.0)],
        ),
        "slow leader and free lanes": perception(road=wide, cars=[Car(35.0, 0.0, 3.0)]),
        "red signal": perception(signals=[Signal("tl", 40.0, SignalState.RED)]),
        "amber signal too near to stop": perception(signals=[Signal("tl", 15.0, SignalState.AMBER)]),
        "lane ends": perception(road=ending),
        "lane ends and the next is taken": perception(road=ending, cars=[Car(3.0, LANE_WIDTH, 13.0)]),
        "tight bend": perception(ego(speed=7.0), bend(straight_road(limit=8.33), 6.0, 8.0, 12.0)),
        "oncoming car in the bend": perception(
            ego(speed=7.0),
            bend(straight_road(), 6.0, 8.0, 12.0),
            cars=[Car(30.0, 4.0, -12.0, heading_error=3.1)],
        ),
        "foe with priority": perception(
            ego(speed=6.0), foes=[JunctionFoe("foe", 25.0, 30.0, 20.0, 18.0, 23.0, 10.0, True)]
        ),
        "foe stands in the conflict": perception(
            ego(speed=6.0), foes=[JunctionFoe("foe", 12.0, 16.0, 8.0, -1.0, 3.0, 0.0, True)]
        ),
        "route ends": perception(road=replace(straight_road(), route_end=12.0)),
        "fast and one plan a second": perception(
            ego(speed=25.0, plan_interval=1.0, across=0.4), straight_road(2, 0, 25.0)
        ),
        "slow lane limit ahead": perception(
            road=replace(
                straight_road(), limit_along=np.array([-5.0, 40.0]), limit=np.array([13.89, 8.33])
            )
        ),
    }  # fmt: skip
