"""The way out for an ego that is kept from starting: at walking pace, round those who stay.

People gather round a standing car, and people who wait for it to leave their crossing stand in its way; so do
vehicles that wait for it. After a while the ego looks for a way round them. Once on such a way, it follows it
until it is back in its lane.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

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
from controllers.safety.vehicle_boxes import DRIVEN_FOR, driving_vehicles, standing_vehicles

PATIENCE, A_CYCLE = 4.0, 60.0
"""Time for which an ego that is kept from starting waits; and that for vehicles in a junction with traffic
lights, because they may wait for the lights and not for the ego [s]."""
LAST_RESORT, BEYOND = 20.0, 1.5
"""After it has been kept from starting for this long altogether, a way may end on a crossing, and lead this
much farther beside the lane, where SUMO has no place for an ego [s, m]."""
BRUSHING, BRUSHED, WITHIN = 60.0, 0.05, 0.05
"""After it has been kept from starting for this long altogether, the ego may inch past people who stand at
its corners though its body reaches this far into their discs; nearer ones stand there [s, m, m]."""
LET_GO = 1.0
"""The waiting time starts anew after this long without anybody who keeps the ego from starting [s]."""
SPEED, ACCELERATION, BRAKING = 0.8, 0.5, 1.5
"""Speed, acceleration and deceleration on the way out [m/s, m/s^2]."""
PAST, CLOSE = 0.35, 0.55
"""Speed past people nearer than this distance, so that who steps out meets a standing car [m/s, m]."""
INCHING, APART = 0.09, 0.01
"""Speed while somebody leans on the car, so low that it counts as standing; people nearer than this distance
lean on it [m/s, m]."""
TO_PEOPLE = (0.1, 0.02)
"""Distance kept to people who stand, and the smaller one used if there is no way with the first [m]."""
TO_WALKERS, TO_VEHICLES, TO_DRIVING = 0.5, 0.1, 0.5
"""Distance kept to people who walk, to vehicles that stand and to those that drive [m]."""
TO_WALKERS_INCHING = 0.2
"""Distance kept to people who walk by an ego that inches away from others [m]."""
LEAST_TO_PEOPLE, LEAST_TO_VEHICLES = 0.005, 0.03
"""Least distances to people and to vehicles while a way is driven, however inexactly [m]."""
INSTANTS = 10
"""One in this many instants of a rollout is considered [-]."""
NEARER = 0.002
"""People and vehicles that are too near already may stay so, but come nearer by no more than this [m]."""
SOUGHT_EVERY = 0.5
"""Least time between two searches for a way [s]."""
BEGINNING = 1.0
"""At the beginning of a way, up to this far, the ego is still in its lane, not back in it [m]."""
BESIDE = 1.0
"""A way is driven on while people stand nearer than this to the car [m]."""
AHEAD = 0.1
"""The wheels take the angle that the way demands this far ahead [m]."""
IN_LANE, ALONG_LANE = 0.4, 0.15
"""The ego is back in its lane when it is this near to its centre line and direction [m, rad]."""
TURNED = 0.15
"""If the wheels are farther than this from the wanted angle, the ego turns them before it moves [rad]."""
CHECKED, CHECKED_WALKERS = 8, 20
"""Number of instants at the beginning of the rollout that are checked for contact, with all people and with
those who walk [-]."""


class Reach(NamedTuple):
    """What the plan of a slow ego says of how far it may go."""

    stuck: bool = False
    """Whether only road users who stay where they are keep it from going anywhere within ``room``."""
    room: float = np.inf
    """How far the front bumper may go until it waits for a light or for a road user who will go on [m]."""
    to_stop: float = np.inf
    """The same, until it waits for a light or for a vehicle [m]."""
    to_people: float = np.inf
    """How far it may go for the people who are let pass first [m]."""


FREE = Reach()
"""Nothing keeps the ego where it is."""


class _Vehicles(NamedTuple):
    """Vehicles that stand, and those that drive wherever they will be: v boxes."""

    boxes: Boxes
    kept: FloatArray
    """Distance kept to each, shape (v,) [m]."""
    until: FloatArray
    """See :class:`controllers.safety.free_way.Obstacles` [m]."""


class _Try(NamedTuple):
    """A search for a way; see :func:`controllers.safety.free_way.find`."""

    near: Obstacles
    shortest: float
    beyond: float = 0.0
    off: Obstacles | None = None
    regardless: bool = False
    """Whether people who have walked into the car are left out of ``near``."""


@dataclass(slots=True)
class WayOut:
    """The ways out of one ego."""

    held_since: float | None = None
    """Time since when the ego has been kept from starting [s]."""
    _held_at: float = -np.inf
    """Last time when it was kept from starting [s]."""
    _held_for: float = 0.0
    """For how long it has been kept from starting since it was last under way [s]."""
    taken: bool = False
    """Whether the ego is on a way out."""
    _way: FloatArray | None = None
    """Steering angles of the arcs of the way, shape (k,) [rad]."""
    _driven: float = 0.0
    """Length of the way that has been driven [m]."""
    _beyond: float = 0.0
    """How much farther beside the lane the present way may lead [m]."""
    _regardless: bool = False
    """Whether the present way disregards people who have walked into the car."""
    _sought: float = -np.inf
    _last: float = 0.0
    # Times of the last search for a way and of the last call of ``command`` [s].

    def reset(self) -> None:
        """Forget everything: the ego is under way."""
        self.held_since, self.taken, self._way, self._sought = None, False, None, -np.inf
        self._held_for = 0.0

    def waited(self, time: float) -> float:
        """Return how long the ego has been kept from starting; 0 if it is not [s]."""
        return 0.0 if self.held_since is None else time - self.held_since

    def command(
        self,
        perception: Perception,
        people: Discs,
        walks: NDArray[np.bool_],
        times: FloatArray,
        reach: Reach,
        held: bool,
        somebody_near: bool,
        patience: float = PATIENCE,
    ) -> Command | None:
        """Return the command that leads out; ``None`` if there is no way, if it is too early, or afterwards.

        Parameters
        ----------
        perception
            What the ego is told.
        people
            Where n pedestrians will be.
        walks
            Which of them walk, shape (n,).
        times
            Instants of ``people``, from now, shape (K,) [s].
        reach
            How far the ego may go according to its plan.
        held
            Whether somebody keeps the ego from following its plan.
        somebody_near
            Whether somebody would keep the ego from starting if it had only just stopped.
        patience
            How long the ego waits before it looks for a way [s].
        """
        ego = perception.ego
        in_lane = abs(ego.across) < IN_LANE and abs(ego.heading_error) < ALONG_LANE
        self._driven += ego.speed * (ego.time - self._last)
        if somebody_near:
            self._held_at = ego.time
            self._held_for += min(ego.time - self._last, LET_GO)
        elif ego.time - self._held_at > LET_GO:
            self.held_since = None
        self._last = ego.time
        # While somebody still keeps the ego from starting, a plan that seems free only creeps up to them.
        begins = self.held_since is not None and self._driven < BEGINNING
        stays_on = self.taken and (begins or not in_lane)
        if not (held or stays_on or self._leads_past(perception, people, walks, reach)):
            self.taken, self._way = False, None
            return None
        if self.held_since is None:
            self.held_since = ego.time
        if not self.taken and ego.time - self.held_since <= patience:
            return None
        now = _distances(perception, people)
        # Whoever waits for the ego to leave may stand where no way leads past them without touching.
        brushed = ~walks & (now < WITHIN) & (self._held_for > BRUSHING)
        leant_on = leans(now) or bool(brushed.any())
        # An ego that inches is no danger to those who walk past ahead of it. It waits only for those who come
        # near, or it would stay while people cross, and others would gather at its side.
        to_walkers = -np.inf if leant_on else TO_WALKERS
        wide, kept = (np.where(walks, to_walkers, np.minimum(now - NEARER, gap)) for gap in TO_PEOPLE)
        wide, kept = (np.where(brushed, np.minimum(gap, -BRUSHED), gap) for gap in (wide, kept))
        under = now < -people.radius[:, 0]
        farthest = reach.to_stop if leant_on else reach.room
        self._look(perception, people, wide, kept, farthest, leant_on, under)
        self.taken = self._way is not None
        if self._way is None:
            return None
        speed = INCHING if leant_on else PAST if (now < CLOSE).any() else SPEED
        kept = self._counted(np.where(walks & leant_on, TO_WALKERS_INCHING, kept), under)
        # On a way that leads out from over somebody, the body may reach farther over them at first.
        kept = _disregarded(kept, under & ~walks)
        arc = min(int((self._driven + AHEAD) / free_way.ARC), len(self._way) - 1)
        return _towards(perception, people, walks, kept, times, float(self._way[arc]), speed)

    def _leads_past(
        self, perception: Perception, people: Discs, walks: NDArray[np.bool_], reach: Reach
    ) -> bool:
        """Return whether the present way leads farther than a plan that seems free.

        Such a plan may end before the way does, often on a crossing over which the way leads. It looks only
        some seconds ahead, and may turn back to the lane through those who stand beside the ego.
        """
        left = 0.0 if self._way is None else len(self._way) * free_way.ARC - self._driven
        if left <= 0.0:
            return False
        beside = self._driven > AHEAD and (_distances(perception, people)[~walks] < BESIDE).any()
        return reach.to_people < left or bool(beside)

    def _look(
        self,
        perception: Perception,
        people: Discs,
        wide: FloatArray,
        kept: FloatArray,
        farthest: float,
        leant_on: bool,
        under: NDArray[np.bool_],
    ) -> None:
        """Keep the way as long as it is free, else look for another, with the wider distances first.

        If somebody leans on the ego, a way that only leads away from them is enough. An ego that stands
        before a crossing first waits for a way that leads over it: on it, more people would wait for it.
        SUMO's people walk into a standing car, and where they wait for it to leave, it cannot get away from
        all of them. If there is no way otherwise, those under the body count no longer.
        """
        vehicles, time = _vehicles(perception, leant_on), perception.ego.time
        way, done, self._way = self._way, self._driven, None
        if way is not None and done < (len(way) - 1) * free_way.ARC:
            drifted = _drifted(people, self._counted(kept, under), vehicles)
            if free_way.leads_on(perception, drifted, way, done, self._beyond):
                self._way = way
                return
        if time - self._sought < SOUGHT_EVERY - 1e-9:
            return
        self._driven, self._sought = 0.0, time
        waited_long = self._held_for > LAST_RESORT
        over = not waited_long and _before_a_crossing(perception)
        least, beside = free_way.REACH if over else free_way.SHORTEST, BEYOND if waited_long else 0.0
        near = _obstacles(people, kept, vehicles)
        tries = [_Try(_obstacles(people, wide, vehicles), least), _Try(near, least)]
        if waited_long:
            tries.append(_Try(near, least, beside))
        if leant_on:
            apart = _obstacles(people, np.full(len(kept), TO_PEOPLE[1]), vehicles)
            tries.append(_Try(near, free_way.SHORTEST, beside, apart))
        if under.any():
            without = _obstacles(people, _disregarded(kept, under), vehicles)
            tries.append(_Try(without, least, beside, regardless=True))
        for one in tries:
            self._beyond, self._regardless = one.beyond, one.regardless
            self._way = free_way.find(perception, one.near, farthest, one.beyond, one.off, one.shortest)
            if self._way is not None:
                return

    def _counted(self, kept: FloatArray, under: NDArray[np.bool_]) -> FloatArray:
        """Return the distances kept on the present way, shape (n,) [m]."""
        return _disregarded(kept, under) if self._regardless else kept


def leans(to_people: FloatArray) -> bool:
    """Return whether somebody leans on the car, given its distances to people, shape (n,) [m]."""
    return bool((to_people <= APART).any())


def _disregarded(kept: FloatArray, who: NDArray[np.bool_]) -> FloatArray:
    """Return distances with which some people are never too near, shape (n,) [m]."""
    return np.where(who, -np.inf, kept)


def _before_a_crossing(perception: Perception) -> bool:
    """Return whether the ego stands clear of all crossings, and would come to one on a way out."""
    front, rear = perception.ego.body.front, -perception.ego.body.rear_overhang
    crossings = perception.road.crossings
    on_one = any(one.entry < front and one.exit > rear for one in crossings)
    return not on_one and any(front <= one.entry < front + free_way.REACH for one in crossings)


def _obstacles(people: Discs, kept: FloatArray, vehicles: _Vehicles) -> Obstacles:
    """Return people at all places where they will be within the time looked ahead, and vehicles."""
    x, y, reach = (values[:, ::INSTANTS] for values in people)
    return Obstacles(x.ravel(), y.ravel(), (reach + kept[:, None]).ravel(), *vehicles)


def _drifted(people: Discs, kept: FloatArray, vehicles: _Vehicles) -> Obstacles:
    """Return the same obstacles with the distances kept to them while a way is driven."""
    to_vehicles = free_way.drifted(vehicles.kept, LEAST_TO_VEHICLES)
    still_kept = free_way.drifted(kept, LEAST_TO_PEOPLE)
    return _obstacles(people, still_kept, vehicles._replace(kept=to_vehicles))


def _vehicles(perception: Perception, inches: bool) -> _Vehicles:
    """Return the vehicles, for an ego that inches or not.

    Those that drive count for as far as the ego gets while they do. If they drove straight on, some would hit
    the ego where it stands, though they will turn or brake. An ego that inches therefore keeps no farther
    from where they would be than it is.
    """
    stand, drive = standing_vehicles(perception), driving_vehicles(perception)
    to_standing = np.minimum(_to_boxes(perception, stand) - NEARER, TO_VEHICLES)
    to_driving = np.full(len(drive.x), TO_DRIVING)
    if inches:
        to_driving = np.minimum(_to_boxes(perception, drive) - NEARER, to_driving)
    soon = (INCHING if inches else SPEED) * DRIVEN_FOR[-1]
    return _Vehicles(
        Boxes(*(np.concatenate(both) for both in zip(stand, drive, strict=True))),
        np.append(to_standing, to_driving),
        np.append(np.full(len(stand.x), np.inf), np.full(len(drive.x), soon)),
    )


def _towards(
    perception: Perception,
    people: Discs,
    walks: NDArray[np.bool_],
    kept: FloatArray,
    times: FloatArray,
    angle: float,
    speed: float,
) -> Command:
    """Return the command that follows a steering angle, or waits while somebody is in the way."""
    ego = perception.ego
    x, y, heading = _rolled(perception, angle, speed, times)
    clearance = disc_clearances(x, y, heading, ego.body, people.x, people.y, people.radius)
    meets = (clearance[:CHECKED, 0] < free_way.drifted(kept, LEAST_TO_PEOPLE)).any()
    meets |= (clearance[:CHECKED_WALKERS, 0, walks] < kept[walks]).any()
    turning = abs(ego.steering - angle) > TURNED
    wanted = 0.0 if meets or turning else speed
    if wanted == 0.0 and ego.speed < STANDING:
        return constant_command(-BRAKING, angle)  # the ego holds its brake
    change = (wanted - ego.speed) / max(ego.plan_interval, 0.5)
    return constant_command(float(np.clip(change, -BRAKING, ACCELERATION)), angle)


def _distances(perception: Perception, people: Discs) -> FloatArray:
    """Return how far the body is from people now, shape (n,) [m]."""
    places = (values[:, :1] for values in people)
    return np.asarray(disc_clearances(*_here(perception), perception.ego.body, *places)[0, 0])


def _to_boxes(perception: Perception, boxes: Boxes) -> FloatArray:
    """Return how far the body is from vehicles now, shape (v,) [m]."""
    return np.asarray(box_clearances(*_here(perception), perception.ego.body, boxes)[0, 0])


def _here(perception: Perception) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x, y and heading of the rear axle now, shape (1, 1) each."""
    place = np.zeros((1, 1))
    return place, place + perception.ego.across, place + perception.ego.heading_error


def _rolled(
    perception: Perception, angle: float, speed: float, times: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x, y and heading of the rear axle as the wheels turn to a steering angle, shape (K, 1) each."""
    ego, step = perception.ego, np.diff(times, prepend=0.0)
    rate = ego.drive.max_steering_rate * times
    steering = ego.steering + np.clip(angle - ego.steering, -rate, rate)
    way = step * np.minimum(ego.speed + ACCELERATION * times, max(speed, ego.speed))
    heading = ego.heading_error + np.cumsum(way * np.tan(steering) / ego.body.wheelbase)
    x = np.cumsum(way * np.cos(heading))
    y = ego.across + np.cumsum(way * np.sin(heading))
    return x[:, None], y[:, None], heading[:, None]
