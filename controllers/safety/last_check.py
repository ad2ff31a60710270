"""The last check of a plan: rolled out with the true body, does it touch anybody?

Every plan that is to be carried out, fallbacks included, is rolled out for three seconds with all four
corners of the body on the true curve of the road. Pedestrians are discs at their true places; those who may
enter the ego's way keep their velocities, the others stay where they are. A plan that would touch somebody is
replaced by the least braking that does not, as late as that is possible. It is a safety net: how seldom it is
needed says how good the plans are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from controllers.driving.path_clearance import disc_clearances
from controllers.driving.plane import people_in_plane
from controllers.interface import Command, FloatArray, Perception, Plan
from controllers.safety.rollout import SPACING, Course, Motion, braked, course, planned, poses

SHIELDED = "shielded"
"""Status of a plan that was replaced."""
LOOKED_AHEAD = 3.0
"""[s]"""
MARGIN, STARTING_MARGIN = 0.1, 0.2
"""Distance to somebody that counts as touching him, of a moving ego and of one that starts [m]."""
GRAZING = 0.03
"""Somebody who is nearer than the margin already counts as touched where he gets nearer by this [m]."""
STANDING, STARTING = 0.05, 0.5
"""A slower ego stands, and a slower one starts [m/s]."""
URGENT = (3.5, 4.5, 5.5, 6.5, 8.0)
"""Brakings that are tried; as long as one less than the first would do, the plan may see to it [m/s^2]."""
MILD = 3.0
PATIENCE = 4.0
"""For so long an ego that starts keeps the larger margin to somebody beside it who does not move [s]."""


@dataclass(slots=True)
class LastCheck:
    """Checks the plans of one ego; remembers since when it has been kept from starting."""

    held_since: float | None = None

    def checked(self, perception: Perception, plan: Plan, may_enter: NDArray[np.bool_]) -> Plan:
        """Return the plan, or one that brakes where it would touch somebody.

        Parameters
        ----------
        perception
            What the ego is told.
        plan
            To be checked.
        may_enter
            Who of the pedestrians keeps his velocity; the others stand, shape (n,).
        """
        near = _near(perception)
        if not len(near):
            self.held_since = None
            return plan
        people = _People(perception, near, may_enter)
        times = np.arange(0.0, LOOKED_AHEAD + 0.5 * SPACING, SPACING)
        path = course(perception, plan)
        starts = perception.ego.speed < STARTING
        margin = self._margins(perception, people, path, times, starts)
        if not starts:
            self.held_since = None
        if not _touches(perception, people, path, planned(perception, plan, times), times, margin)[0]:
            return plan
        tried = np.array((MILD, *URGENT))
        touches = _touches(perception, people, path, braked(perception, tried, times), times, margin)
        if not touches[0] and not starts:
            return plan
        if starts and self.held_since is None:
            self.held_since = perception.ego.time
        enough = tried[int(np.argmin(touches))] if not touches.all() else tried[-1]
        limit = perception.ego.drive.max_deceleration
        return _braking(plan, min(float(enough), limit))

    def _margins(
        self, perception: Perception, people: _People, path: Course, times: FloatArray, starts: bool
    ) -> FloatArray:
        """Return the distance to each that counts as touching, shape (n,) [m]."""
        still = Motion(np.zeros((1, 1)), np.zeros((1, 1)))
        now = _clearances(perception, people, path, still, times[:1])[0, 0]
        grazing: FloatArray = np.minimum(MARGIN, now - GRAZING)
        if not starts:
            return grazing
        waited = 0.0 if self.held_since is None else perception.ego.time - self.held_since
        beside = (now > 0.0) & (waited > PATIENCE)
        return np.asarray(np.where(beside, grazing, STARTING_MARGIN))


class _People:
    """The pedestrians that are checked, in the plane of the route frame."""

    def __init__(self, perception: Perception, near: NDArray[np.intp], may_enter: NDArray[np.bool_]) -> None:
        places, velocities = people_in_plane(perception.ego, perception.road, perception.pedestrians)
        self.places = places[near]
        self.velocities = np.where(may_enter[near, None], velocities[near], 0.0)
        self.radius = perception.pedestrians.radius[near]


def _near(perception: Perception) -> NDArray[np.intp]:
    """Return who the body could reach within the time looked ahead."""
    ego, people = perception.ego, perception.pedestrians
    reach = ego.body.length + (ego.speed + 3.0) * LOOKED_AHEAD
    if len(people.position) == len(people):
        x, y = people.position[:, 0] - ego.x, people.position[:, 1] - ego.y
    else:
        x, y = people.along, people.across - ego.across
    return np.flatnonzero(np.hypot(x, y) < reach)


def _clearances(
    perception: Perception, people: _People, path: Course, motion: Motion, times: FloatArray
) -> FloatArray:
    """Return the distances to the people, shape (K, m, n) [m]."""
    x, y, heading = poses(perception, path, motion)
    moved = people.places[:, None, :] + people.velocities[:, None, :] * times[None, :, None]
    radius = np.broadcast_to(people.radius[:, None], moved.shape[:2])
    return disc_clearances(x, y, heading, perception.ego.body, moved[..., 0], moved[..., 1], radius)


def _touches(
    perception: Perception,
    people: _People,
    path: Course,
    motion: Motion,
    times: FloatArray,
    margin: FloatArray,
) -> NDArray[np.bool_]:
    """Return which variants of a motion touch somebody while they move, shape (m,)."""
    near = (_clearances(perception, people, path, motion, times) < margin).any(axis=2)
    return np.asarray((near & (motion.speed > STANDING)).any(axis=0))


def _braking(plan: Plan, braking: float) -> Plan:
    """Return the plan with its accelerations replaced by a braking that goes on."""
    command = plan.command
    slower = np.minimum(command.acceleration, -braking)
    return replace(plan, command=Command(command.times, slower, command.steering), status=SHIELDED)
