"""Finds a way past pedestrians: describes the scene, searches it, and chooses from the Pareto front."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.conflicts.path_conflicts import Conflicts
from controllers.drivable_area.clearances import Shape
from controllers.drivable_area.conflict import Conflict, boxes, walkers
from controllers.drivable_area.course import Course
from controllers.drivable_area.evaluation import (
    CarLimits,
    Rules,
    Scene,
    Verdict,
    judge,
    smooth_speeds,
)
from controllers.drivable_area.pareto_search import Budget, Front, search
from controllers.drivable_area.quintic_path import PathStart, quintic_paths
from controllers.driving import lane_keeping
from controllers.driving.following import limit_now
from controllers.interface import Perception
from controllers.safety.emergency_braking import GRAVITY

CREEPING = 2.0
"""A car slower than this may speed up to it to get past [m/s]."""
GAINED = 4.0
"""A candidate may be this much faster than the car is now, within the speed limit [m/s]."""
SHORTEST = 5.0
"""Length of the shortest avoidance path [m]."""
FURTHEST = 4.0
"""Largest shift across the road [m]."""
SAMPLED = 8
"""The first this many pedestrians to be on the road walk at random; the others keep their velocities."""


@dataclass(frozen=True, slots=True)
class AvoidanceSettings:
    """How to search for a way past pedestrians."""

    rules: Rules
    budget: Budget
    friction: float


@dataclass(frozen=True, slots=True)
class Found:
    """A way past pedestrians."""

    course: Course
    verdict: Verdict
    """Verdict on all candidates from which this one was chosen."""


def choose(
    scene: Scene,
    rules: Rules,
    budget: Budget,
    lower: FloatArray,
    upper: FloatArray,
    hints: FloatArray,
    seed: int,
) -> tuple[Front, Verdict, int] | None:
    """Return the front, the verdict on it and the index of the chosen candidate; ``None`` if it is empty.

    Parameters
    ----------
    scene, rules, budget : where, how, and how long to search
    lower, upper : bounds of (y_f, v_s) [m, m/s]
    hints : candidates to begin with, shape (h, 2)
    seed : seed of everything random

    Notes
    -----
    NSGA-II finds the front; the weighted sum of Eq. (48) of [Wu2023]_ chooses from it. Of equal candidates,
    the first is chosen.
    """
    used = 4 if rules.weights.progress > 0.0 else 3
    number = min(len(scene.people.x), SAMPLED)
    noise = np.random.default_rng(seed).standard_normal((len(rules.times), number, rules.walks))

    def verdict_of(genes: FloatArray) -> Verdict:
        return judge(scene, rules, genes[:, 0], genes[:, 1], noise)

    def judged(genes: FloatArray) -> tuple[FloatArray, FloatArray]:
        verdict = verdict_of(genes)
        return verdict.costs[:, :used], verdict.violations

    front = search(judged, (used, 4), lower, upper, hints, budget, seed)
    if len(front.genes) == 0:
        return None
    verdict = verdict_of(front.genes)
    chosen = int(np.argmin(rules.weights.total(verdict.costs)))
    return front, verdict, chosen


def plan(
    perception: Perception,
    people: Conflicts,
    conflict: Conflict,
    settings: AvoidanceSettings,
    before: Course | None,
    seed: int,
) -> Found | None:
    """Return the way past the pedestrians on the road; ``None`` if no candidate is feasible.

    Parameters
    ----------
    perception : what the ego knows
    people : the pedestrians on the road or about to enter it
    conflict : the first of them in the way
    settings : how to search
    before : the course driven until now, which is a candidate again
    seed : seed of everything random
    """
    ego, road, rules = perception.ego, perception.road, settings.rules
    scene = scene_of(perception, people, conflict, settings)
    half = 0.5 * ego.body.width + rules.edge_margin
    right = min(max(road.right_edge + half, ego.across - FURTHEST), ego.across)
    left = max(min(road.left_edge - half, ego.across + FURTHEST), ego.across)
    here = road.lane(road.reference)
    centre = min(max(here.offset if here is not None else 0.0, right), left)
    hints = [(ego.across, 0.0), (centre, 0.0), (centre, ego.speed), (right, ego.speed), (left, ego.speed)]
    hints += [(end, 0.5 * ego.speed) for end in (centre, right, left)]
    if before is not None:
        hints.insert(0, (before.end, min(before.final_speed, scene.fastest)))
    lower, upper = np.array([right, 0.0]), np.array([left, scene.fastest])
    found = choose(scene, rules, settings.budget, lower, upper, np.array(hints), seed)
    if found is None:
        return None
    front, verdict, chosen = found
    end, final_speed = front.genes[chosen : chosen + 1].T
    path = quintic_paths(scene.start, scene.length, end)
    course = Course(path, smooth_speeds(scene, rules, final_speed), road.reference)
    return Found(course, verdict)


def scene_of(
    perception: Perception, people: Conflicts, conflict: Conflict, settings: AvoidanceSettings
) -> Scene:
    """Return the scene for the candidates; the avoidance ends where the front is level with the conflict."""
    ego, road, rules = perception.ego, perception.road, settings.rules
    body, drive = ego.body, ego.drive
    slope = math.tan(min(max(ego.heading_error, -1.0), 1.0))
    turning = math.tan(ego.steering) / body.wheelbase - lane_keeping.curvature_at(road, 0.0)
    # Eq. (14) for a car that drives a curve of curvature κ: y″ = κ (1 + y′²)^(3/2).
    bend = turning * (1.0 + slope * slope) ** 1.5
    limits = CarLimits(
        deceleration=min(settings.friction * GRAVITY, drive.max_deceleration),
        acceleration=min(1.5, drive.max_acceleration),
        curvature=math.tan(drive.max_steering) / body.wheelbase,
        friction=settings.friction,
        steering_rate=drive.max_steering_rate,
    )
    vehicles = boxes(perception, rules.times)
    return Scene(
        shape=Shape(body),
        limits=limits,
        start=PathStart(ego.across, slope, bend),
        speed=max(ego.speed, 0.0),
        fastest=max(ego.speed, CREEPING, min(limit_now(road, body.front), ego.speed + GAINED)),
        acceleration=ego.acceleration,
        length=max(conflict.along - body.front, SHORTEST),
        braking_distance=max(conflict.place - body.front, 0.0),
        right=road.right_edge,
        left=road.left_edge,
        people=walkers(people),
        boxes=vehicles if len(vehicles) > 0 else None,
        bend=road.curvature if len(road.curvature) > 0 else np.zeros(1),
        bend_step=road.curvature_step if road.curvature_step > 0.0 else 1.0,
        wheelbase=body.wheelbase,
    )
