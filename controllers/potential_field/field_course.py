"""Finds the lane whose field an ego can drive down without meeting anybody or leaving its road."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import BoolArray, FloatArray
from controllers.driving import lane_keeping
from controllers.geometry.path_clearance import beyond_edges, disc_clearances, vehicles_met
from controllers.interface import Decision, Perception
from controllers.perception import only
from controllers.potential_field.field import Field
from controllers.potential_field.field_guidance import Drives, Guidance, drive
from controllers.potential_field.road_field import (
    FORECAST_TIMES,
    SLOWEST,
    FieldSettings,
    Meetings,
    field_of,
    meetings,
    obstacles_on,
)
from controllers.potential_field.surroundings import (
    STEP,
    bends,
    centre_lines,
    centre_lines_beside,
    expected_speeds,
    instants,
    near_the_way,
)
from controllers.prediction.forecast import Forecast, Predictor

WALKING = 0.2
"""Below this speed, a pedestrian counts as standing [m/s]."""
NEAR = 3.0
"""Vehicles are expected to keep their velocities for this long [s]."""
KEPT = 0.1
"""Once the ego has begun to brake for a way, the way may leave this much less than the clearance [m]."""
TOLERANCE = 0.05
"""The body may get this much further over an edge, or nearer to a pedestrian already too near [m]."""
WIDE = 0.5
"""If a straight drive leaves this much more than the clearance, no other drive is simulated [m]."""
STOP_GAP = 1.0
"""Distance that a stopping ego leaves to the pedestrian's place [m]."""


@dataclass(frozen=True, slots=True)
class CourseSettings:
    """Conditions for a path to be free."""

    clearance: float | None
    """Clearance to keep to pedestrians on a simulated drive; ``None``: they never block a drive [m]."""
    road: FieldSettings = field(default_factory=FieldSettings)
    guidance: Guidance = field(default_factory=Guidance)
    unsure: float = 0.15
    """Added to ``clearance`` for pedestrians who walk, for every second ahead [m/s]."""
    strengths: tuple[float, ...] = (1.0, 2.0)
    """Factors on the gain of obstacles, tried one after the other until a way is free."""
    vehicle_clearance: float = 0.3
    """Clearance to keep to vehicles [m]."""
    brakings: tuple[float, ...] = ()
    """Steady decelerations with which the drives are repeated, one after the other, if no way is free at the
    speed that traffic allows [m/s^2]."""


@dataclass(frozen=True, slots=True)
class Course:
    """What is known of the ways past the pedestrians ahead."""

    drives: Drives
    """First the drive without obstacles, then one for each lane and strength tried."""
    shape: Field
    """The fields, one row for each drive."""
    chosen: int
    """Row of the first free drive; 0 if none is free."""
    stop_within: float | None
    """How far the ego may drive if it stops for the pedestrians met on the drive without obstacles; inf if
    stopping would not help them, ``None`` if nobody is met there [m]."""
    because: str
    """Name of the pedestrian who matters most."""
    passing: str
    """On which side the ego passes whom, for example ``left=a|b right=c``."""
    pushed: bool
    """Whether the ego has to go round anybody who will be in its path when it is level with them."""
    met: Meetings
    ellipses: FloatArray
    """Outlines of the obstacles' ellipses at one half-axis, shape (k, 2) [m]."""
    braking: float = 0.0
    """Deceleration with which the chosen way is free; 0 if it is free at the speed that traffic allows
    [m/s^2]."""

    @property
    def free(self) -> bool:
        """Whether there is a free way."""
        return self.chosen > 0


class CourseFinder:
    """Finds the ways past pedestrians; each ego needs its own, because a predictor may have a memory."""

    def __init__(self, predictor: Predictor, settings: CourseSettings) -> None:
        self._predictor = predictor
        self.settings = settings
        self._braking = 0.0

    def find(self, perception: Perception, decision: Decision, acceleration: float) -> Course | None:
        """Return the course past the pedestrians in the way; ``None`` if there are none, or in a bend.

        The fields of these lanes are tried in order: the target lane, the ego's lane, and free lanes beside
        it. Each is tried with the gain of obstacles as it is, and then with a stronger one. The ego's speed
        changes by ``acceleration``. A way is free if the ego meets no pedestrian on it, neither where the
        predictor expects them nor where their present velocity takes them, and no vehicle that it would not
        also meet without pedestrians.
        """
        forecast = self._predictor.predict(perception, FORECAST_TIMES)
        near = near_the_way(perception, forecast)
        if len(near) == 0 or bends(perception):
            return None
        perception = replace(perception, pedestrians=only(perception.pedestrians, near))
        forecast = forecast.only(near)
        course = self._past(perception, decision, forecast, acceleration)
        if course is not None and not course.free:
            course = self._braked(perception, decision, forecast, acceleration, course)
        self._braking = course.braking if course is not None else 0.0
        return course

    def _braked(
        self,
        perception: Perception,
        decision: Decision,
        forecast: Forecast,
        acceleration: float,
        course: Course,
    ) -> Course:
        """Return the ways past with the first steady braking that makes one free, or else ``course``."""
        for braking in self.settings.brakings if perception.ego.speed > SLOWEST else ():
            slower = self._past(perception, decision, forecast, min(acceleration, -braking), braking)
            if slower is not None and slower.free:
                told = course.because, course.stop_within, course.pushed
                return replace(slower, because=told[0], stop_within=told[1], pushed=told[2])
        return course

    def _past(
        self,
        perception: Perception,
        decision: Decision,
        forecast: Forecast,
        acceleration: float,
        braking: float = 0.0,
    ) -> Course | None:
        """Return the ways past the pedestrians at a speed that changes by an acceleration.

        If the ego brakes, it may be that it need not go round anybody any more.
        """
        settings, count = self.settings, len(perception.pedestrians)
        met = meetings(perception, forecast, braking)
        centres = centre_lines(perception, decision)
        lanes = np.array([*centres, *centre_lines_beside(perception, centres)])
        strengths = np.concatenate([[0.0], np.tile(settings.strengths, len(lanes))])
        centres = np.concatenate([lanes[:1], np.repeat(lanes, len(settings.strengths))])
        obstacles = obstacles_on(perception, met, centres, settings.road)
        pushes = obstacles.share[1, :count] * obstacles.long_axis[1, :count]
        speeds = expected_speeds(perception, acceleration, instants(perception, braking), braking)
        if not braking and not pushes.any() and self._wide_of_all(perception, forecast, speeds, centres[0]):
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
        kept = KEPT if 0.0 < braking <= self._braking else 0.0
        hits, stoppers = self._hits(perception, forecast, drives, -kept)
        if not braking and not pushes.any() and not hits[:, 0].any():
            return None
        free = ~hits[:, 1:].any(axis=(0, 2)) & self._on_road(perception, drives)[1:]
        if braking:
            free &= self._settled(perception, forecast, drives)[1:]
        chosen = 1 + int(np.argmax(free)) if free.any() and (braking or pushes.any()) else 0
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
            braking,
        )

    def _settled(self, perception: Perception, forecast: Forecast, drives: Drives) -> NDArray[np.bool_]:
        """Say on which drives nobody ahead is in the way any more at the end, shape (m,).

        Without this condition, braking would count as a way past pedestrians whom the ego only meets later.
        """
        people, body, end = perception.pedestrians, perception.ego.body, drives.times[-1:]
        then = forecast.at(end)
        wanted = 0.5 * body.width + people.radius + (self.settings.clearance or 0.0)
        apart = np.abs(then.across[:, 0] - drives.across[-1][:, None])
        passed = then.along[:, 0] < drives.along[-1][:, None] + body.front
        return np.asarray((passed | (apart >= wanted)).all(axis=1))

    def _wide_of_all(
        self, perception: Perception, forecast: Forecast, speeds: FloatArray, centre: float
    ) -> bool:
        """Say whether nobody comes near an ego that drives straight on, where it is now or on a centre line.

        In that case the drives need not be simulated: their result would be the same.
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
        """Say where the ego comes too near to whom, shape (K, m, n), and for whom to stop, shape (K, n).

        The axes are instants, drives and pedestrians. The ego does not stop for pedestrians who stand beside
        the way, wherever the predictor expects them to go: at a crossing where pedestrians have to wait, they
        and the ego would wait for each other.
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
        # Pedestrians who are too near already must only not come nearer.
        wanted = np.minimum(wanted, np.minimum(expected, straight)[0] - TOLERANCE)
        ahead, now = expected < wanted, straight < wanted
        return ahead | now, (ahead[:, 0] & walks) | now[:, 0]

    def _on_road(self, perception: Perception, drives: Drives) -> NDArray[np.bool_]:
        """Say which drives neither leave the road nor meet additional vehicles, shape (m,)."""
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
        # Vehicles that the ego would also meet without pedestrians do not count: it follows them or brakes.
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


def _stop(perception: Perception, forecast: Forecast, hits: BoolArray) -> tuple[float | None, int]:
    """Return how far the ego may drive to stop before the pedestrian it meets first, and their index.

    Parameters
    ----------
    perception : what the ego knows
    forecast : where the pedestrians will be, at K times
    hits : when the ego would come too near to whom, shape (K, n)
    """
    if not hits.any():
        return None, 0
    instant = int(np.argmax(hits.any(axis=1)))
    them = np.flatnonzero(hits[instant])
    places = forecast.along[them, instant] - perception.pedestrians.radius[them]
    first = int(np.argmin(places))
    room = float(places[first]) - perception.ego.body.front
    # Stopping does not help pedestrians who walk into the ego's side: it would stand in their way.
    return (max(room - STOP_GAP, 0.0) if room > 0.0 else float("inf")), int(them[first])


def _sides(
    perception: Perception, met: Meetings, drives: Drives, row: int, concerned: NDArray[np.bool_]
) -> str:
    """Return on which side the ego passes each pedestrian in the way: left if its path is left of them."""
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
