"""The last check of a plan: whether the plan touches anybody when rolled out with the true body.

Every plan that ``vo_mpc`` is to carry out, including fallbacks, is rolled out for three seconds with all four
corners of the body on the true curve of the road. Pedestrians are discs at their true places. Those who may
enter the ego's way keep walking, or walk as the predictor says; the others come to a stop. Standing vehicles
count as well, and some moving ones. A plan that would touch somebody is replaced by the least braking that
does not, as late as possible. If no braking keeps the margin, the ego does what stays farthest away from
pedestrians even if they walk on: this may be the plan itself, or to get past a pedestrian beside the ego and
then brake. The check is a safety net: the more seldom it is needed, the better the plans are.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from controllers.arrays import FloatArray
from controllers.driving.standing import STANDING, WALKING, walking
from controllers.geometry.box_clearances import Boxes, box_clearances
from controllers.geometry.path_clearance import disc_clearances
from controllers.interface import Command, Perception, Plan
from controllers.prediction.forecast import Forecast
from controllers.safety.lights_passed import LightsPassed
from controllers.safety.pedestrian_discs import Discs, discs
from controllers.safety.rollout import (
    LAG,
    PASSING_ACCELERATION,
    SPACING,
    Course,
    Motion,
    braked,
    course,
    passing_first,
    planned,
    poses,
)
from controllers.safety.vehicle_boxes import (
    beside_in_lane,
    crossing_vehicles,
    oncoming_vehicles,
    outside_the_bend,
    standing_vehicles,
)
from controllers.safety.way_out import A_CYCLE, FREE, NEARER, PATIENCE, Reach, WayOut, leans

SHIELDED, WAY_OUT = "shielded", "way_out"
"""Status of a plan that was replaced by braking, and of one replaced by a way out at walking pace."""
LOOKED_AHEAD = 3.0
"""Length of the rollout [s]."""
MARGIN, STARTING_MARGIN, TOUCHING = 0.1, 0.2, 0.01
"""Distances to pedestrians that count as contact: for a moving ego, for one that starts, and always [m]."""
GRAZING = 0.03
"""Pedestrians already nearer than the margin count as touched if the ego comes nearer to them by this [m]."""
WALK_ON = 0.7
"""Walking pedestrians who are not expected to enter the ego's way stop only after this time [s]."""
AROUND = 3.0
"""People no farther away than this may be why the ego is kept from starting [m]."""
STARTING = 0.5
"""An ego that stood counts as starting up to this speed [m/s]."""
WALKERS_MARGIN = 0.3
"""Distance to walking pedestrians that counts as contact, as they may step aside [m]."""
URGENT = (3.5, 4.5, 5.5, 6.5, 8.0)
"""Decelerations that are tried; if ``MILD`` is enough, braking is left to the plan [m/s^2]."""
TIGHT, BENDS_WITHIN = 1.0 / 15.0, 20.0
"""Curvature of a bend in which the body leaves its lane [1/m], and distance within which bends count [m]."""
MILD, SOON = 3.0, 0.6
"""If this deceleration is enough, braking is left to the plan [m/s^2], unless the contact comes before the
next plan or soon after it: a slow ego could stop before it, but its plan would not [s]."""


@dataclass(slots=True)
class LastCheck:
    """Checks the plans of one ego; remembers since when it has been kept from starting."""

    _out: WayOut = field(default_factory=WayOut)
    _lights: LightsPassed = field(default_factory=LightsPassed)
    _stood: bool = False
    """Whether the ego has stood and has not been under way since."""

    def checked(
        self,
        perception: Perception,
        plan: Plan,
        may_enter: NDArray[np.bool_],
        forecast: Forecast | None = None,
        reach: Reach = FREE,
        comes: FloatArray | None = None,
    ) -> Plan:
        """Return the plan, or a replacement if it would touch somebody.

        Parameters
        ----------
        perception
            What the ego is told.
        plan
            Plan to be checked.
        may_enter
            Which pedestrians walk on; the others come to a stop, shape (n,).
        forecast
            Where those who walk on are going; ``None``: they keep their velocities.
        reach
            How far the ego may go according to its plan.
        comes
            Speed across of those who walk to a waiting place in the lane, or will walk on across a crossing,
            shape (n,); nan for others; ``None`` if there are no such pedestrians [m/s].
        """
        near, speed = _near(perception), perception.ego.speed
        at_lights = self._lights.look(perception)
        self._stood = speed < STANDING or (self._stood and speed < STARTING)
        times = np.arange(0.0, LOOKED_AHEAD + 0.5 * SPACING, SPACING)
        # An ego that only creeps past somebody does not start: it would stop beside them and stay there.
        starts = self._stood or self._out.taken
        cars = [boxes for boxes in _vehicles(perception, times, starts) if boxes.x.size]
        if not len(near) and not cars:
            self._out.reset()
            return plan
        people = _people(perception, near, may_enter, forecast, times, comes, starts)
        motion = planned(perception, plan, times)
        path = course(perception, plan, motion, times)
        clearance = _clearances(perception, people, cars, path, motion)
        walk = walking(perception.pedestrians)[near]
        waited = self._out.waited(perception.ego.time)
        margin = _margins(clearance[0, 0], walk, starts, waited > PATIENCE)
        touched = bool(_touches(clearance, motion, margin)[0])
        if not starts:
            self._out.reset()
        else:
            held = touched or reach.stuck or leans(clearance[0, 0, : len(near)])
            # Pedestrians for whom it would wait, had it not waited so long, still keep it from starting.
            near_it = held or (waited > PATIENCE and _keeps(clearance, motion, walk))
            patience = _patience(at_lights, clearance[0, 0, : len(near)])
            out = self._out.command(perception, people, walk, times, reach, held, near_it, patience)
            if out is not None:
                return replace(plan, command=out, status=WAY_OUT)
        if not touched:
            return plan
        limit = perception.ego.drive.max_deceleration
        tried = np.minimum((MILD, *URGENT), limit)
        slower = braked(perception, tried, times)
        touches = _touches(_clearances(perception, people, cars, path, slower), slower, margin)
        # The plan does not brake for people beside the body, so braking for them is not left to it.
        latest = np.full(len(margin), SOON + perception.ego.plan_interval)
        latest[: len(near)][_beside(perception)[near]] += speed / MILD
        if not (touches[0] or starts or _touches_before(latest, times, clearance, motion, margin)):
            return plan
        if starts or not touches.all():
            return _braking(plan, float(tried[-1] if touches.all() else tried[int(np.argmin(touches))]))
        chosen = _farthest_away(perception, near, people, cars, path, times, motion, slower)
        brakings = (_braking(plan, float(one)) for one in tried)
        return (plan, _passing_first(plan), *brakings)[chosen]


def _farthest_away(
    perception: Perception,
    near: NDArray[np.intp],
    people: Discs,
    cars: Sequence[Boxes],
    path: Course,
    times: FloatArray,
    motion: Motion,
    slower: Motion,
) -> int:
    """Return what stays farthest away if no braking keeps the margin.

    The answer is 0 for the plan, 1 for getting past somebody first, and more, or -1 for the hardest, for the
    brakings. Braking is no help if the ego then stops beside somebody who walks on, or if its side is then
    hit by somebody whom it would have passed by driving on.
    """
    people = _and_walking_on(perception, near, people, times)
    all_of_them = zip(motion, passing_first(perception, times), slower, strict=True)
    variants = Motion(*(np.concatenate(each, axis=1) for each in all_of_them))
    least = _least(_clearances(perception, people, cars, path, variants), variants)
    best = least.max()
    return int(np.flatnonzero(least >= best - GRAZING)[-1]) if best >= MARGIN else -1


def _people(
    perception: Perception,
    near: NDArray[np.intp],
    may_enter: NDArray[np.bool_],
    forecast: Forecast | None,
    times: FloatArray,
    comes: FloatArray | None,
    starts: bool,
) -> Discs:
    """Return where those who are near will be; parameters as for `LastCheck.checked`."""
    told, walk_on = perception.pedestrians, max(WALK_ON, perception.ego.plan_interval + LAG)
    if comes is not None:  # whoever still walks the other way has to turn first
        comes = np.where(np.sign(comes) * told.across_speed < -WALKING, np.nan, comes)
    if comes is not None and not starts:  # the plan then takes care of those who stand on a crossing
        comes = np.where(told.waiting, comes, np.nan)
    return discs(perception, near, may_enter, forecast, times, walk_on, comes)


def _keeps(clearance: FloatArray, motion: Motion, walk: NDArray[np.bool_]) -> bool:
    """Return whether somebody would keep an ego that has just stopped from starting."""
    margin = _margins(clearance[0, 0], walk, starts=True, patience_over=False)
    return bool(_touches(clearance, motion, margin)[0])


def _patience(at_lights: bool, to_people: FloatArray) -> float:
    """Return how long an ego waits before it looks for a way out [s].

    Parameters
    ----------
    at_lights : whether it is in a junction with traffic lights
    to_people : its distances to people, shape (n,) [m]
    """
    return A_CYCLE if at_lights and not (to_people < AROUND).any() else PATIENCE


def _margins(now: FloatArray, walk: NDArray[np.bool_], starts: bool, patience_over: bool) -> FloatArray:
    """Return the distances that count as touching, given the present distances, shape (n,) [m].

    The first entries are people, some of whom walk; the others are vehicles.
    """
    people, most = len(walk), np.full(len(now), MARGIN)
    most[:people][walk] = WALKERS_MARGIN
    grazing: FloatArray = np.clip(now - GRAZING, np.minimum(now - NEARER, TOUCHING), most)
    if not starts:
        return grazing
    beside = (now > 0.0) & patience_over | (np.arange(len(now)) >= people)
    return np.asarray(np.where(beside, grazing, STARTING_MARGIN))


def _near(perception: Perception) -> NDArray[np.intp]:
    """Return which pedestrians the body could reach within the time looked ahead, by index."""
    ego, people = perception.ego, perception.pedestrians
    reach = ego.body.length + (ego.speed + 3.0) * LOOKED_AHEAD
    x, y = people.position[:, 0] - ego.x, people.position[:, 1] - ego.y
    if np.isnan(x).any():
        x, y = people.along, people.across - ego.across
    return np.asarray((np.hypot(x, y) < reach).nonzero()[0])


def _vehicles(perception: Perception, times: FloatArray, starts: bool) -> Iterator[Boxes]:
    """Yield the vehicles that the body may not touch: those that stand, and some of those under way.

    In a tight bend the body leaves its lane, so that it comes near oncoming vehicles and those that pass on
    the outer side, and it turns across the way of cyclists and others beside it in the lane. So does an ego
    that starts at the side of its lane, as after a way out.
    """
    yield standing_vehicles(perception)
    if starts:
        yield crossing_vehicles(perception, times)
    road = perception.road
    near = road.curvature[: int(BENDS_WITHIN / road.curvature_step)]
    tightest = near[np.abs(near).argmax()] if len(near) else 0.0
    turns = abs(tightest) > TIGHT
    if starts or turns:
        yield beside_in_lane(perception, times)
    if turns:
        yield outside_the_bend(perception, times, -np.sign(tightest))
        if not starts:
            yield oncoming_vehicles(perception, times)


def _joined(some: Discs, others: Discs) -> Discs:
    return Discs(*(np.concatenate(both) for both in zip(some, others, strict=True)))


def _and_walking_on(
    perception: Perception, near: NDArray[np.intp], people: Discs, times: FloatArray
) -> Discs:
    """Return some people, and the same people again if they walk on.

    On a crossing, walking straight across is included too: a first step onto it tells little about the
    direction.
    """
    told = perception.pedestrians
    everybody = np.full(len(told), True)
    straight = np.where(told.on_crossing, told.across_speed, np.nan)
    for across_speed in (None, straight):
        walking_on = discs(perception, near, everybody, None, times, across_speed=across_speed)
        people = _joined(people, walking_on)
    return people


def _clearances(
    perception: Perception, people: Discs, cars: Sequence[Boxes], path: Course, motion: Motion
) -> FloatArray:
    """Return the distances to the people, then to the vehicles, shape (K, m, n) [m]."""
    where, body = poses(perception, path, motion), perception.ego.body
    to_people = disc_clearances(*where, body, people.x, people.y, people.radius)
    to_cars = (box_clearances(*where, body, boxes) for boxes in cars)
    return np.concatenate((to_people, *to_cars), axis=2)


def _touches(clearance: FloatArray, motion: Motion, margin: FloatArray) -> NDArray[np.bool_]:
    """Return which variants of a motion touch somebody while they move, shape (m,).

    Parameters
    ----------
    clearance : distances to people and vehicles, shape (K, m, n) [m]
    motion : the variants
    margin : distances that count as touching, shape (n,) [m]
    """
    near = (clearance < margin).any(axis=2)
    return np.asarray((near & (motion.speed > STANDING)).any(axis=0))


def _touches_before(
    latest: FloatArray, times: FloatArray, clearance: FloatArray, motion: Motion, margin: FloatArray
) -> bool:
    """Return whether a motion with one variant touches somebody before a time for each, shape (n,) [s]."""
    early = np.where((times[:, None] < latest)[:, None], clearance, np.inf)
    return bool(_touches(early, motion, margin)[0])


def _beside(perception: Perception) -> NDArray[np.bool_]:
    """Return which pedestrians the front bumper has passed: the plan leaves them out, shape (n,)."""
    people = perception.pedestrians
    return np.asarray(people.along + people.radius < perception.ego.body.front)


def _least(clearance: FloatArray, motion: Motion) -> FloatArray:
    """Return the least distance to anybody while each variant of a motion moves, shape (m,) [m]."""
    nearest = clearance.min(axis=2, initial=np.inf)
    return np.asarray(np.where(motion.speed > STANDING, nearest, np.inf).min(axis=0))


def _passing_first(plan: Plan) -> Plan:
    """Return the plan with an acceleration instead that gets the ego past a pedestrian beside it."""
    command = plan.command
    onward = np.full(len(command.times), PASSING_ACCELERATION)
    return replace(plan, command=Command(command.times, onward, command.steering), status=SHIELDED)


def _braking(plan: Plan, braking: float) -> Plan:
    """Return the plan with all its accelerations lowered at least to a constant braking [m/s^2]."""
    command = plan.command
    slower = np.minimum(command.acceleration, -braking)
    return replace(plan, command=Command(command.times, slower, command.steering), status=SHIELDED)
