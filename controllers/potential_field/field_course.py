"""Which lane's field an ego can drive down without meeting anybody or leaving its road."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import BoolArray, FloatArray
from controllers.driving import lane_keeping
from controllers.driving.following import limit_now
from controllers.driving.lanes.gap_acceptance import blocker
from controllers.geometry.path_clearance import beyond_edges, disc_clearances, vehicles_met
from controllers.interface import Decision, Pedestrians, Perception
from controllers.potential_field.field import Field
from controllers.potential_field.field_guidance import Drives, Guidance, drive
from controllers.potential_field.road_field import (
    FORECAST_TIMES,
    LONG_BEHIND,
    SLOWEST,
    FieldSettings,
    Meetings,
    field_of,
    meetings,
    obstacles_on,
)
from controllers.prediction.forecast import Forecast, Predictor

WALKING = 0.2
"""A slower pedestrian stands [m/s]."""
STEP = 0.1
"""Of the simulated drives [s]."""
SHORTEST = 1.5
"""So far the simulated drives go at least [s] …"""
LONGEST = 4.5
"""… and at most [s]."""
NEAR = 3.0
"""Vehicles are expected to keep their velocities for so long [s]."""
STRAIGHT = 0.02
"""In a tighter bend the field, which knows straight roads, does not steer [1/m]."""
TOLERANCE = 0.05
"""How much more than now the body may jut out beyond an edge, or near a pedestrian who is too near [m]."""
GAINS_FOR = 1.0
"""An ego that speeds up is expected to do so for this time [s]."""
BESIDE = 8.0
"""Pedestrians who never come so near to the ego's lane in the time looked at do not matter [m]."""
WIDE = 0.5
"""More than the clearance wanted that a straight drive has to leave for no other to be simulated [m]."""
STOP_GAP = 1.0
"""Distance that a stopping ego leaves to the place of the pedestrian [m]."""


@dataclass(frozen=True, slots=True)
class CourseSettings:
    """When a path is free."""

    clearance: float | None
    """What has to be left beside a pedestrian on a simulated drive; ``None``: whoever is met [m]."""
    road: FieldSettings = field(default_factory=FieldSettings)
    guidance: Guidance = field(default_factory=Guidance)
    unsure: float = 0.15
    """What is added to that for who walks, for every second until then [m/s]."""
    strengths: tuple[float, ...] = (1.0, 2.0)
    """What the gain of obstacles is multiplied by, one after the other, until a way is free."""
    vehicle_clearance: float = 0.3
    """What has to be left beside a vehicle [m]."""


@dataclass(frozen=True, slots=True)
class Course:
    """What was found out about the ways past the pedestrians ahead."""

    drives: Drives
    """The one without obstacles first, then one for each lane tried."""
    shape: Field
    """The fields, a row for each drive."""
    chosen: int
    """Row of the first drive down a field that is free; 0 if none is."""
    stop_within: float | None
    """How far the ego may drive if it stops for the pedestrians met on the drive without obstacles; inf if
    stopping would not help them, ``None`` if nobody is met there [m]."""
    because: str
    """The pedestrian who matters most."""
    passing: str
    """Who is passed on which side."""
    pushed: bool
    """Whether anybody has to be gone round: where the ego will be level with them, they are in its path."""
    met: Meetings
    ellipses: FloatArray
    """Outlines of the obstacles' ellipses at one half-axis, shape (k, 2) [m]."""

    @property
    def free(self) -> bool:
        """Whether there is a free way."""
        return self.chosen > 0


class CourseFinder:
    """Finds the ways past pedestrians; one per ego, because a predictor may remember."""

    def __init__(self, predictor: Predictor, settings: CourseSettings) -> None:
        self._predictor = predictor
        self.settings = settings

    def find(self, perception: Perception, decision: Decision, acceleration: float) -> Course | None:
        """Return the course past the pedestrians in the way; ``None`` where there are none, or in a bend.

        Tried in this order, each with the gain of obstacles as it is and a stronger one: the field of the
        target lane, of the lane the ego is in, and of the lanes beside it that are free. Free is a way on
        which, at a speed that changes by ``acceleration``, nobody is met: no pedestrians, neither where the
        predictor expects them nor where their present velocity takes them, and no vehicle that would not be
        met without pedestrians too.
        """
        forecast = self._predictor.predict(perception, FORECAST_TIMES)
        near = _near(perception, forecast)
        if len(near) == 0 or _bends(perception):
            return None
        perception, forecast = with_only(perception, near), forecast.only(near)
        settings, count = self.settings, len(near)
        met = meetings(perception, forecast)
        centres = _centres(perception, decision)
        lanes = np.array([*centres, *_lanes_beside(perception, centres)])
        strengths = np.concatenate([[0.0], np.tile(settings.strengths, len(lanes))])
        centres = np.concatenate([lanes[:1], np.repeat(lanes, len(settings.strengths))])
        obstacles = obstacles_on(perception, met, centres, settings.road)
        pushes = obstacles.share[1, :count] * obstacles.long_axis[1, :count]
        speeds = _speeds(perception, acceleration, _instants(perception))
        if not pushes.any() and self._wide_of_all(perception, forecast, speeds, centres[0]):
            return None
        obstacles = replace(obstacles, share=obstacles.share * strengths[:, None])
        shape = field_of(perception, centres, obstacles, settings.road)
        drives = drive(
            shape,
            len(centres),
            perception.ego,
            perception.road,
            speeds,
            STEP,
            settings.guidance,
        )
        hits, stoppers = self._hits(perception, forecast, drives)
        if not pushes.any() and not hits[:, 0].any():
            return None
        free = np.flatnonzero(~hits[:, 1:].any(axis=(0, 2)) & self._on_road(perception, drives)[1:])
        chosen = 1 + int(free[0]) if len(free) and pushes.any() else 0
        stop_within, first = _stop(perception, forecast.at(drives.times), stoppers)
        return Course(
            drives,
            shape,
            chosen,
            stop_within,
            perception.pedestrians.names[int(np.argmax(pushes)) if pushes.any() else first],
            _sides(perception, met, drives, max(chosen, 1), pushes > 0.0),
            bool(pushes.any()),
            met,
            _ellipses(shape, max(chosen, 1), count),
        )

    def _wide_of_all(
        self, perception: Perception, forecast: Forecast, speeds: FloatArray, centre: float
    ) -> bool:
        """Say whether nobody comes near an ego that drives straight on, here or on a centre line.

        Saves the simulated drives where they would say nothing else.
        """
        along = np.concatenate([[0.0], np.cumsum(0.5 * STEP * (speeds[:-1] + speeds[1:]))])
        shape = (len(speeds), 2)
        straight = Drives(
            STEP * np.arange(len(speeds), dtype=np.float64),
            np.broadcast_to(along[:, None], shape),
            np.broadcast_to(np.array([perception.ego.across, centre]), shape),
            np.zeros(shape),
            speeds,
            np.zeros((len(speeds) - 1, 2)),
        )
        return not self._hits(perception, forecast, straight, WIDE)[0].any()

    def _hits(
        self, perception: Perception, forecast: Forecast, drives: Drives, more: float = 0.0
    ) -> tuple[BoolArray, BoolArray]:
        """Say when on which drive whom it comes too near to, shape (K, m, n), and whom to stop for, (K, n).

        The ego does not stop for pedestrians standing beside the way, wherever the predictor expects them to
        go: at a crossing where pedestrians have to wait, they and the ego would wait for each other.
        """
        body, people, times = perception.ego.body, perception.pedestrians, drives.times
        if self.settings.clearance is None:
            return np.zeros((*drives.along.shape, len(people)), bool), np.zeros(
                (len(times), len(people)), bool
            )
        path = drives.along, drives.across, drives.heading
        then = forecast.at(times)
        straight_on = people.along[:, None] + np.outer(people.along_speed, times)
        straight_over = people.across[:, None] + np.outer(people.across_speed, times)
        alone = np.broadcast_to(people.radius[:, None], straight_on.shape)
        expected = disc_clearances(*path, body, then.along, then.across, people.radius[:, None] + then.reach)
        straight = disc_clearances(*path, body, straight_on, straight_over, alone)
        walks = np.hypot(people.along_speed, people.across_speed) >= WALKING
        wanted = self.settings.clearance + more + self.settings.unsure * times[:, None, None] * walks
        # Who is too near already only must not come nearer.
        wanted = np.minimum(wanted, np.minimum(expected, straight)[0] - TOLERANCE)
        ahead, now = expected < wanted, straight < wanted
        return ahead | now, (ahead[:, 0] & walks) | now[:, 0]

    def _on_road(self, perception: Perception, drives: Drives) -> NDArray[np.bool_]:
        """Say which of the drives leave neither the road nor the vehicles on it alone, shape (m,)."""
        body, road = perception.ego.body, perception.road
        out = beyond_edges(drives.across, drives.heading, body, road.right_edge, road.left_edge)
        leaves = (out > np.maximum(out[0], 0.0) + TOLERANCE).any(axis=0)
        soon = drives.times <= NEAR
        vehicles = vehicles_met(
            drives.times[soon],
            drives.along[soon],
            drives.across[soon],
            drives.heading[soon],
            body,
            perception.vehicles,
            self.settings.vehicle_clearance,
        )
        # Whom the ego would meet without any pedestrian is followed, or braked for.
        return np.asarray(~leaves & ~(vehicles & ~vehicles[0]).any(axis=1))


def follow(
    course: Course, perception: Perception, acceleration: FloatArray, guidance: Guidance
) -> FloatArray:
    """Return the front-wheel angles down the chosen field, at ``lane_keeping.instants(ego)`` [rad]."""
    ego = perception.ego
    speeds = [max(ego.speed, 0.0)]
    for asked in acceleration:
        speeds.append(max(speeds[-1] + lane_keeping.STEP * float(asked), 0.0))
    shape = course.shape.row(course.chosen)
    driven = drive(shape, 1, ego, perception.road, np.array(speeds), lane_keeping.STEP, guidance)
    return driven.angle[:, 0]


def with_only(perception: Perception, chosen: NDArray[np.int64]) -> Perception:
    """Return the perception with some of its pedestrians, by index."""
    people = perception.pedestrians
    some = Pedestrians(
        tuple(people.names[i] for i in chosen),
        people.along[chosen],
        people.across[chosen],
        people.along_speed[chosen],
        people.across_speed[chosen],
        people.radius[chosen],
        people.crossing[chosen],
        people.on_crossing[chosen],
        people.waiting[chosen],
        people.uncertainty[chosen],
        people.position[chosen],
        people.velocity[chosen],
    )
    return replace(perception, pedestrians=some)


def _near(perception: Perception, forecast: Forecast) -> NDArray[np.int64]:
    """Return who may come near the lanes that the ego drives on within the time looked at, by index."""
    people, ego = perception.pedestrians, perception.ego
    speed = max(ego.speed, SLOWEST)
    furthest = ego.body.front + speed * LONGEST + BESIDE
    along = (people.along > -ego.body.length - speed * LONG_BEHIND) & (people.along < furthest)
    across = np.abs(forecast.across - ego.across).min(axis=1) < BESIDE
    return np.flatnonzero(along & across)


def _instants(perception: Perception) -> FloatArray:
    """Return the instants to look at, until the ego is past everybody [s]."""
    ego = perception.ego
    furthest = float(perception.pedestrians.along.max()) + ego.body.length
    needed = min(max(furthest / max(ego.speed, SLOWEST), SHORTEST), LONGEST)
    return STEP * np.arange(round(needed / STEP) + 1, dtype=np.float64)


def _bends(perception: Perception) -> bool:
    """Say whether the road that matters is a bend."""
    road, ego = perception.road, perception.ego
    places = np.arange(len(road.curvature)) * road.curvature_step
    near = places < max(2.0 * ego.speed, 10.0)
    return bool((np.abs(road.curvature[near]) > STRAIGHT).any())


def _centres(perception: Perception, decision: Decision) -> FloatArray:
    """Return the centre lines of the target lane and, if it is another one, of the ego's lane."""
    road = perception.road
    lanes = [road.lane(decision.target_lane), road.lane(road.reference)]
    offsets = [lane.offset for lane in lanes if lane is not None] or [0.0]
    return np.array(offsets if offsets[0] != offsets[-1] else offsets[:1])


def _lanes_beside(perception: Perception, centres: FloatArray) -> list[float]:
    """Return the centre lines of further lanes beside the ego's that it could go to."""
    road = perception.road
    return [
        lane.offset
        for lane in road.lanes
        if abs(lane.number - road.reference) == 1
        and lane.offset not in centres
        and blocker(perception, lane.number) is None
    ]


def _speeds(perception: Perception, acceleration: float, instants: FloatArray) -> FloatArray:
    """Return the expected speeds [m/s]."""
    ego = perception.ego
    speed = max(ego.speed, 0.0)
    lasting = np.minimum(instants, GAINS_FOR) if acceleration > 0.0 else instants
    highest = max(speed, limit_now(perception.road, ego.body.front))
    return np.clip(speed + acceleration * lasting, 0.0, highest)


def _stop(perception: Perception, forecast: Forecast, hits: BoolArray) -> tuple[float | None, int]:
    """Return how far the ego may drive to stop before whom it meets first, and who that is.

    Parameters
    ----------
    perception : for the pedestrians
    forecast : of them, K times
    hits : when the ego would come too near to whom, shape (K, n)
    """
    if not hits.any():
        return None, 0
    instant = int(np.argmax(hits.any(axis=1)))
    them = np.flatnonzero(hits[instant])
    places = forecast.along[them, instant] - perception.pedestrians.radius[them]
    first = int(np.argmin(places))
    room = float(places[first]) - perception.ego.body.front
    # Stopping does not help pedestrians who meet the flank: the ego would stand in their way.
    return (max(room - STOP_GAP, 0.0) if room > 0.0 else float("inf")), int(them[first])


def _sides(
    perception: Perception, met: Meetings, drives: Drives, row: int, concerned: NDArray[np.bool_]
) -> str:
    """Return on which side of the ego's path each pedestrian in the way is left behind."""
    people, body = perception.pedestrians, perception.ego.body
    level = met.along - body.front + 0.5 * body.length
    own = np.interp(level, drives.along[:, row], drives.across[:, row])
    left = own > met.across
    parts = []
    for name, side in (("left", left), ("right", ~left)):
        those = [people.names[i] for i in np.flatnonzero(side & concerned)]
        parts += [f"{name}={'|'.join(those)}"] if those else []
    return " ".join(parts)


def _ellipses(shape: Field, row: int, people: int) -> FloatArray:
    """Return the outlines of the obstacles of one row."""
    found = shape.obstacles
    turn = np.linspace(0.0, 2.0 * np.pi, 17)
    outlines = [
        np.column_stack(
            (
                found.along[row, i] + found.long_axis[row, i] * np.cos(turn),
                found.across[row, i] + found.side_axis[row, i] * np.sin(turn),
            )
        )
        for i in np.flatnonzero(found.share[row, :people] > 0.0)
    ]
    return np.vstack(outlines) if outlines else np.zeros((0, 2))
