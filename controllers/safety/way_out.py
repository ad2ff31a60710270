"""The way out for an ego that is kept from starting: walking pace, round those who stay.

People gather round a standing car, and those who wait for it to leave their crossing stand where its way
leads; vehicles that wait for it do so too. After a while the ego looks for a way round them, and once on it
goes on until it is back in its lane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.driving.standing import STANDING
from controllers.geometry.box_clearances import Boxes, box_clearances
from controllers.geometry.path_clearance import disc_clearances
from controllers.interface import Command, Perception, constant_command
from controllers.safety import free_way
from controllers.safety.free_way import Obstacles
from controllers.safety.pedestrian_discs import Discs
from controllers.safety.vehicle_boxes import driving_vehicles, standing_vehicles

PATIENCE = 4.0
"""For so long an ego that is kept from starting waits [s]."""
LET_GO = 1.0
"""After so long without anybody who keeps it from starting it waits anew [s]."""
SPEED, ACCELERATION, BRAKING = 0.8, 0.5, 1.5
"""Of the way out [m/s, m/s^2]."""
INCHING, APART = 0.07, 0.01
"""Speed while somebody leans on the car, at which it counts as standing; whoever is nearer leans [m/s, m]."""
TO_PEOPLE = (0.1, 0.02)
"""Distance kept to people who stand, and where there is no way with it [m]."""
TO_WALKERS, TO_VEHICLES, TO_DRIVING = 0.5, 0.1, 0.5
"""Distance kept to people who walk, to vehicles that stand and to those that drive [m]."""
INSTANTS = 10
"""Of the instants of a rollout every so many is looked at [-]."""
NEARER = 0.002
"""Those who are nearer already may stay so, but not come nearer by this [m]."""
SOUGHT_EVERY = 0.5
"""How often a way is looked for at most [s]."""
AHEAD = 0.1
"""The wheels are where the way wants them so far ahead [m]."""
IN_LANE, ALONG_LANE = 0.4, 0.15
"""The ego is back in its lane this near to its centre line and direction [m, rad]."""
TURNED = 0.15
"""Wheels that are farther from where they should be are turned first [rad]."""
CHECKED, CHECKED_WALKERS = 8, 20
"""Instants of the rollout at which its beginning is checked, for those who stand and for those who walk."""


@dataclass(slots=True)
class WayOut:
    """The ways out of one ego."""

    held_since: float | None = None
    """Since when it is kept from starting [s]."""
    _held_at: float = -np.inf
    """When it was so last [s]."""
    taken: bool = False
    """Whether it is on a way out."""
    _way: FloatArray | None = None
    """Steering angles of the arcs of the way, shape (k,) [rad]."""
    _driven: float = 0.0
    """How much of it has been driven [m]."""
    _sought: float = -np.inf
    _last: float = 0.0
    # When a way was sought, and when this was asked [s].

    def reset(self) -> None:
        """Forget everything: the ego is under way."""
        self.held_since, self.taken, self._way, self._sought = None, False, None, -np.inf

    def waited(self, time: float) -> float:
        """Return for how long the ego has been kept from starting; 0 where it is not [s]."""
        return 0.0 if self.held_since is None else time - self.held_since

    def command(
        self,
        perception: Perception,
        people: Discs,
        walks: NDArray[np.bool_],
        times: FloatArray,
        farthest: float,
        held: bool,
        somebody_near: bool,
    ) -> Command | None:
        """Return what leads out; ``None`` where nothing does, where it is too early, or where it has led out.

        Parameters
        ----------
        perception
            What the ego is told.
        people
            Where n pedestrians will be.
        walks
            Who of them walks, shape (n,).
        times
            Of ``people``, from now, shape (K,) [s].
        farthest
            How far the front bumper may go for other reasons [m].
        held
            Whether somebody keeps the ego from following its plan.
        somebody_near
            Whether somebody would keep an ego that has just stopped from it.
        """
        ego = perception.ego
        in_lane = abs(ego.across) < IN_LANE and abs(ego.heading_error) < ALONG_LANE
        self._driven += ego.speed * (ego.time - self._last)
        self._last = ego.time
        if somebody_near:
            self._held_at = ego.time
        elif ego.time - self._held_at > LET_GO:
            self.held_since = None
        if not held and (in_lane or not self.taken):
            self.taken, self._way = False, None
            return None
        if self.held_since is None:
            self.held_since = ego.time
        if not self.taken and ego.time - self.held_since <= PATIENCE:
            return None
        now = _distances(perception, people)
        wide, kept = (np.where(walks, TO_WALKERS, np.minimum(now - NEARER, gap)) for gap in TO_PEOPLE)
        leant_on = bool((now <= APART).any())
        self._look(perception, people, wide, kept, farthest, leant_on)
        self.taken = self._way is not None
        if self._way is None:
            return None
        speed = INCHING if leant_on else SPEED
        arc = min(int((self._driven + AHEAD) / free_way.ARC), len(self._way) - 1)
        return _towards(perception, people, walks, kept, times, float(self._way[arc]), speed)

    def _look(
        self,
        perception: Perception,
        people: Discs,
        wide: FloatArray,
        kept: FloatArray,
        farthest: float,
        leant_on: bool,
    ) -> None:
        """Keep the way as long as it is free, else look for another: the wider distances first.

        An ego on which somebody leans is content with one that leads away from them.
        """
        vehicles, time = _vehicles(perception), perception.ego.time
        near = _obstacles(people, kept, vehicles)
        way, done, self._way = self._way, self._driven, None
        under_way = way is not None and done < (len(way) - 1) * free_way.ARC
        if way is not None and under_way and free_way.leads_on(perception, near, way, done):
            self._way = way
        elif time - self._sought >= SOUGHT_EVERY - 1e-9:
            self._driven, self._sought = 0.0, time
            far = _obstacles(people, wide, vehicles)
            for obstacles in (far, near):
                self._way = free_way.find(perception, obstacles, farthest)
                if self._way is not None:
                    return
            if leant_on:
                apart = _obstacles(people, np.full(len(kept), TO_PEOPLE[1]), vehicles)
                self._way = free_way.find(perception, near, farthest, apart)


def _obstacles(people: Discs, kept: FloatArray, vehicles: tuple[Boxes, FloatArray]) -> Obstacles:
    """Return people, wherever they will be within the time looked ahead, and vehicles."""
    x, y, reach = (values[:, ::INSTANTS] for values in people)
    return Obstacles(x.ravel(), y.ravel(), (reach + kept[:, None]).ravel(), *vehicles)


def _vehicles(perception: Perception) -> tuple[Boxes, FloatArray]:
    """Return vehicles that stand, those that drive wherever they will be, and the distances kept [m]."""
    stand, drive = standing_vehicles(perception), driving_vehicles(perception)
    now = box_clearances(*_here(perception), perception.ego.body, stand)[0, 0]
    kept = np.append(np.minimum(now - NEARER, TO_VEHICLES), np.full(len(drive.x), TO_DRIVING))
    return Boxes(*(np.concatenate(both) for both in zip(stand, drive, strict=True))), kept


def _towards(
    perception: Perception,
    people: Discs,
    walks: NDArray[np.bool_],
    kept: FloatArray,
    times: FloatArray,
    angle: float,
    speed: float,
) -> Command:
    """Return the command that follows an angle, or waits while somebody walks into the way."""
    ego = perception.ego
    x, y, heading = _rolled(perception, angle, times)
    clearance = disc_clearances(x, y, heading, ego.body, people.x, people.y, people.radius)
    meets = (clearance[:CHECKED, 0] < kept - free_way.DRIFT).any()
    meets |= (clearance[:CHECKED_WALKERS, 0, walks] < kept[walks]).any()
    turning = abs(ego.steering - angle) > TURNED
    wanted = 0.0 if meets or turning else speed
    if wanted == 0.0 and ego.speed < STANDING:
        return constant_command(-BRAKING, angle)  # it holds its brake
    change = (wanted - ego.speed) / max(ego.plan_interval, 0.5)
    return constant_command(float(np.clip(change, -BRAKING, ACCELERATION)), angle)


def _distances(perception: Perception, people: Discs) -> FloatArray:
    """Return how far the body is from people now, shape (n,) [m]."""
    places = (values[:, :1] for values in people)
    return np.asarray(disc_clearances(*_here(perception), perception.ego.body, *places)[0, 0])


def _here(perception: Perception) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return where the rear axle is now, x, y and heading of shape (1, 1) each."""
    place = np.zeros((1, 1))
    return place, place + perception.ego.across, place + perception.ego.heading_error


def _rolled(
    perception: Perception, angle: float, times: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x, y and heading of the rear axle as the wheels turn to a steering angle, shape (K, 1) each."""
    ego, step = perception.ego, np.diff(times, prepend=0.0)
    rate = ego.drive.max_steering_rate * times
    steering = ego.steering + np.clip(angle - ego.steering, -rate, rate)
    way = step * np.minimum(ego.speed + ACCELERATION * times, max(SPEED, ego.speed))
    heading = ego.heading_error + np.cumsum(way * np.tan(steering) / ego.body.wheelbase)
    x = np.cumsum(way * np.cos(heading))
    y = ego.across + np.cumsum(way * np.sin(heading))
    return x[:, None], y[:, None], heading[:, None]
