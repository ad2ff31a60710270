"""Avoidance problems for what an ego sees: people in conflict, room that traffic leaves, and where to end."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from controllers.arrays import FloatArray
from controllers.conflicts import path_conflicts
from controllers.conflicts.expected_behaviour import PedestrianAssumptions, Watch
from controllers.conflicts.path_conflicts import Conflicts
from controllers.driving.following import Following, limit_now
from controllers.driving.lane_keeping import curvature_at
from controllers.interface import EgoState, Lane, Neighbour, Perception
from controllers.prediction.forecast import Forecast, Predictor
from controllers.velocity_obstacle.cones import Cone
from controllers.velocity_obstacle.decision_rules import least_gap
from controllers.velocity_obstacle.paper.cone_margins import People
from controllers.velocity_obstacle.paper.euler_bicycle import SPEED, EulerBicycle
from controllers.velocity_obstacle.paper.problem import AvoidanceProblem, End, InputLimits, Room

FORECAST_SPACING = 0.1
"""Time step of the predictions of pedestrians and of following traffic [s]."""
GAP_OPENS_IN = 4.0
"""Time constant with which a gap that is already too short is opened, instead of by hard braking [s]."""
FOLLOWER_KEEPS = 2.0
"""How long followers are expected to keep their speed before they react to the ego [s]."""
MOST = 32
"""At most this many of the nearest people in conflict count: a program with hundreds takes minutes."""
KERB_CLEARANCE = 0.2
"""Distance kept from the outer edges of the lanes that a lane change uses [m]."""


@dataclass(frozen=True, slots=True)
class SceneSettings:
    """Settings of the problems; see ``problem.AvoidanceProblem``."""

    step: float
    """Length T of a step [s]."""
    steps: int
    radius: float
    """Radius of the disc about the body's centre that pedestrians' centres are kept out of [m]."""
    cone: Cone
    limits: InputLimits
    """Input limits; the speed limit (23) is ``top_speed`` or, where that is ``None``, the road's."""
    steering_weight: float
    top_speed: float | None
    standstill_gap: float
    headway: float
    truncation: float = float("inf")
    """Pedestrians farther away than the ego gets in this time do not count [s]."""
    assume: PedestrianAssumptions = field(default_factory=PedestrianAssumptions)

    @property
    def horizon(self) -> float:
        """Length of the horizon [s]."""
        return self.steps * self.step

    @property
    def grid(self) -> FloatArray:
        """Return the times at the ends of the steps, shape (n,) [s]."""
        return self.step * np.arange(1.0, self.steps + 1.0)


class SceneReader:
    """Turns perceptions into problems. It remembers the pedestrians, so each ego needs its own.

    Parameters
    ----------
    settings
        Settings of the problems.
    following
        Finds the accelerations that traffic requires.
    predictor
        Predicts where pedestrians will be; ``None``: they keep their velocities.
    """

    def __init__(self, settings: SceneSettings, following: Following, predictor: Predictor | None) -> None:
        self.settings = settings
        self._following = following
        self._predictor = predictor
        self._watch = Watch()
        self._forecast: tuple[Perception, Forecast] | None = None

    def conflicts(self, perception: Perception, lane: Lane) -> Conflicts:
        """Return the pedestrians in conflict with the ego on its way into a lane, by time of entry."""
        s, people = self.settings, perception.pedestrians
        across = perception.ego.across if abs(perception.ego.across - lane.offset) > 1.0 else lane.offset
        # The band takes the disc in place of the body; ``find`` adds the pedestrian's own radius.
        reach = s.radius - (float(people.radius.max()) if len(people) else 0.0)
        band = (min(across, lane.offset) - reach, max(across, lane.offset) + reach)
        found = path_conflicts.find(
            perception, self._watch, band, 0.0, s.horizon, s.assume, self._predicted(perception)
        )
        near = found.along - perception.ego.body.front <= s.truncation * max(perception.ego.speed, 1.0)
        if len(found) > MOST:
            distance = np.where(near, np.hypot(found.along, found.across), np.inf)
            near[np.argsort(distance, kind="stable")[MOST:]] = False
        return found if near.all() else found.only(np.flatnonzero(near))

    def straight(self, perception: Perception, lane: Lane, conflicts: Conflicts) -> AvoidanceProblem:
        """Return the problem of driving on in a lane, in which only the speed is free."""
        start = np.array([0.0, lane.offset, 0.0, max(perception.ego.speed, 0.0), 0.0])
        room = self._room(perception, lane, self.settings.steps)
        return replace(self._problem(perception, lane, conflicts, start, room), steers=False)

    def change(
        self,
        perception: Perception,
        lane: Lane,
        conflicts: Conflicts,
        arrival: int,
        turned: tuple[float, float] | None = None,
    ) -> AvoidanceProblem:
        """Return the problem of moving into a lane within ``arrival`` steps.

        Parameters
        ----------
        perception, lane, conflicts
            What the ego perceives, the target lane, and who is in conflict on the way.
        arrival
            Number of steps until the ego is in the lane.
        turned
            Heading and wheel angle to begin with. If a plan is being followed, they are the plan's: the real
            ones are about half a step ahead of those of Euler steps. ``None``: the real ones [rad].
        """
        ego, road = perception.ego, perception.road
        if turned is None:
            # The wheel angle that follows the lane counts as straight ahead.
            followed = float(np.arctan(ego.body.wheelbase * curvature_at(road, 0.0)))
            turned = (ego.heading_error, ego.steering - followed)
        start = np.array([0.0, ego.across, turned[0], max(ego.speed, 0.0), turned[1]])
        room = self._room(perception, lane, 0 if lane.number == road.reference else arrival // 2)
        lanes = [lane, road.lane(road.reference) or lane]
        side = 0.5 * ego.body.width + KERB_CLEARANCE
        right = min(one.offset - 0.5 * one.width for one in lanes) + side
        left = max(one.offset + 0.5 * one.width for one in lanes) - side
        free = np.zeros(self.settings.steps)
        room = replace(room, right=free + min(right, ego.across), left=free + max(left, ego.across))
        end = End(min(arrival, self.settings.steps), across=lane.offset, heading=0.0, steering=0.0)
        return replace(self._problem(perception, lane, conflicts, start, room), end=end)

    def _problem(
        self,
        perception: Perception,
        lane: Lane,
        conflicts: Conflicts,
        start: FloatArray,
        room: Room,
    ) -> AvoidanceProblem:
        s, body = self.settings, perception.ego.body
        top = s.top_speed if s.top_speed is not None else limit_now(perception.road, body.front)
        return AvoidanceProblem(
            bicycle=EulerBicycle(body.wheelbase, s.step),
            start=start,
            people=self._people(conflicts),
            room=room,
            limits=replace(s.limits, speed=min(top, 1e3)),
            cone=s.cone,
            steering_weight=s.steering_weight,
            wanted=self._wanted(perception, lane, float(start[SPEED])),
            reference_point=body.front - 0.5 * body.length,
        )

    def _wanted(self, perception: Perception, lane: Lane, speed: float) -> FloatArray:
        """Return the changes of speed that road and vehicles require, shape (n,) [m/s]."""
        s = self.settings
        times = np.arange(0.0, s.horizon - 1e-9, FORECAST_SPACING)
        asked = self._following.follow(perception, lane.number, times).acceleration
        speeds = [speed]
        for acceleration in asked:
            speeds.append(max(speeds[-1] + FORECAST_SPACING * float(acceleration), 0.0))
        at = np.interp(s.grid, FORECAST_SPACING * np.arange(len(speeds)), speeds)
        return np.asarray(np.diff(at, prepend=speed))

    def _people(self, conflicts: Conflicts) -> People:
        """Return the predicted pedestrians; ``side`` is the one for passing ahead of them."""
        s, c = self.settings, conflicts
        before, after = s.grid - s.step, s.grid
        # For people who stand, passing ahead means passing on the side of the lane's middle.
        walks = np.where(np.abs(c.across_speed) > 0.05, c.across_speed, -c.across)
        side = np.where(walks < 0.0, -1.0, 1.0)
        if c.forecast is None:
            along = c.along[:, None] + c.along_speed[:, None] * after
            across = c.across[:, None] + c.across_speed[:, None] * after
            along_speed = np.broadcast_to(c.along_speed[:, None], along.shape)
            across_speed = np.broadcast_to(c.across_speed[:, None], along.shape)
            return People(along, across, along_speed, across_speed, side, np.full(along.shape, s.radius))
        there, here = c.forecast.at(after), c.forecast.at(before)
        return People(
            there.along,
            there.across,
            (there.along - here.along) / s.step,
            (there.across - here.across) / s.step,
            side,
            s.radius + there.reach,
        )

    def _predicted(self, perception: Perception) -> Forecast | None:
        if self._predictor is None:
            return None
        if self._forecast is None or self._forecast[0] is not perception:
            count = int(np.ceil(self.settings.horizon / FORECAST_SPACING)) + 1
            times = FORECAST_SPACING * np.arange(float(count))
            self._forecast = (perception, self._predictor.predict(perception, times))
        return self._forecast[1]

    def _room(self, perception: Perception, lane: Lane, own_until: int) -> Room:
        """Return the gaps: own lane up to a step, target lane after it, Eqs. (12) to (15)."""
        s, gaps, ego = self.settings, perception.gaps, perception.ego
        side = lane.number - perception.road.reference
        ahead, behind = gaps.ahead, gaps.behind
        then_ahead, then_behind = ahead, behind
        if side:
            then_ahead = gaps.left_ahead if side > 0 else gaps.right_ahead
            then_behind = gaps.left_behind if side > 0 else gaps.right_behind
        own = np.arange(1, s.steps + 1) <= own_until
        free = np.full(s.steps, np.inf)
        return Room(
            ahead=np.where(own, self._ahead(ahead, ego), self._ahead(then_ahead, ego)),
            behind=np.where(own, self._behind(behind), self._behind(then_behind)),
            right=-free,
            left=free,
            headway=s.headway,
        )

    def _ahead(self, neighbour: Neighbour | None, ego: EgoState) -> FloatArray:
        """Return the largest position plus headway times speed behind a leader, shape (n,) [m]."""
        s = self.settings
        if neighbour is None:
            return np.full(s.steps, np.inf)
        short = max(least_gap(max(ego.speed, 0.0), s.standstill_gap, s.headway) - neighbour.gap, 0.0)
        bound = neighbour.gap + self._moved(neighbour) - s.standstill_gap
        return bound + short * np.exp(-s.grid / GAP_OPENS_IN)

    def _behind(self, neighbour: Neighbour | None) -> FloatArray:
        """Return the least position ahead of a follower, shape (n,) [m]."""
        s = self.settings
        if neighbour is None:
            return np.full(s.steps, -np.inf)
        least = least_gap(max(neighbour.speed, 0.0), s.standstill_gap, s.headway)
        bound = self._moved(neighbour) - neighbour.gap + min(least, max(neighbour.gap, 0.0))
        return np.where(s.grid <= FOLLOWER_KEEPS, bound, -np.inf)

    def _moved(self, neighbour: Neighbour) -> FloatArray:
        """Return how far a neighbour moves; braking neighbours go on braking until they stand [m]."""
        speed, braking = max(neighbour.speed, 0.0), max(-neighbour.acceleration, 0.0)
        times = self.settings.grid
        if braking > 0.1:
            times = np.minimum(times, speed / braking)
            return speed * times - 0.5 * braking * times**2
        return speed * times
