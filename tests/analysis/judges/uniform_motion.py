"""Judges of what follows from a rectangle and a disc in uniform motion: shapely, and searches."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from analysis import geometry
from analysis.encounters.prediction import required_deceleration
from tests.analysis.judges.agreement import Agreement, Array, agreement


@dataclass(frozen=True)
class Cases:
    """Random rectangles and discs in world coordinates, in uniform motion."""

    ego: Array
    heading: Array
    ego_velocity: Array
    length: Array
    width: Array
    person: Array
    person_velocity: Array
    radius: Array

    def in_frame(self) -> tuple[Array, Array, Array, Array, Array, Array, Array]:
        """Return position and relative velocity in the rectangle's frame, and the sizes."""
        way, motion = self.person - self.ego, self.person_velocity - self.ego_velocity
        x, y = geometry.to_frame(way[:, 0], way[:, 1], self.heading)
        u, w = geometry.to_frame(motion[:, 0], motion[:, 1], self.heading)
        return x, y, u, w, 0.5 * self.length, 0.5 * self.width, self.radius

    def distance(self, time: Array) -> Array:
        """Return shapely's distance between polygon and disc's centre at a time, minus the radius."""
        return np.asarray(shapely.distance(self._polygons, self._points(time)) - self.radius)

    @cached_property
    def _polygons(self) -> Array:
        return rectangles(self.ego, self.heading, self.length, self.width)

    def _points(self, time: Array) -> Array:
        moved = self.person + (self.person_velocity - self.ego_velocity) * time[:, None]
        return np.asarray(shapely.points(moved))


def rectangles(centre: Array, heading: Array, length: Array, width: Array) -> Array:
    """Return shapely polygons."""
    cos, sin = np.cos(heading), np.sin(heading)
    along = 0.5 * length[:, None] * np.array([1, 1, -1, -1])
    across = 0.5 * width[:, None] * np.array([1, -1, -1, 1])
    x = centre[:, :1] + along * cos[:, None] - across * sin[:, None]
    y = centre[:, 1:] + along * sin[:, None] + across * cos[:, None]
    return np.asarray(shapely.polygons(np.stack([x, y], axis=-1)))


def random_cases(count: int, seed: int) -> Cases:
    """Return cases of which about a third touch."""
    rng = np.random.default_rng(seed)
    ego = rng.uniform(-20, 20, (count, 2))
    heading = rng.uniform(-np.pi, np.pi, count)
    speed = rng.uniform(0, 15, count)
    direction = np.stack([np.cos(heading), np.sin(heading)], axis=1)
    angle = rng.uniform(-np.pi, np.pi, count)
    person = ego + direction * rng.uniform(-5, 25, (count, 1)) + rng.uniform(-6, 6, (count, 2))
    walking = rng.uniform(0, 2.5, count)
    return Cases(
        ego,
        heading,
        direction * speed[:, None],
        rng.uniform(3.5, 12, count),
        rng.uniform(1.6, 2.5, count),
        person,
        np.stack([np.cos(angle), np.sin(angle)], axis=1) * walking[:, None],
        rng.uniform(0.15, 0.5, count),
    )


def _smallest(distance: Callable[[Array], Array], low: Array, high: Array) -> tuple[Array, Array]:
    """Return argument and value of the minimum of convex functions, by golden-section search."""
    ratio = (np.sqrt(5.0) - 1.0) / 2.0
    a, b = low.copy(), high.copy()
    for _ in range(130):
        c, d = b - ratio * (b - a), a + ratio * (b - a)
        left = distance(c) <= distance(d)
        a, b = np.where(left, a, c), np.where(left, d, b)
    best = 0.5 * (a + b)
    ends = np.stack([distance(low), distance(high), distance(best)])
    times = np.stack([low, high, best])
    pick = np.argmin(ends, axis=0)[None]
    return np.take_along_axis(times, pick, 0)[0], np.take_along_axis(ends, pick, 0)[0]


def time_to_contact(count: int = 4000, seed: int = 1) -> Agreement:
    """Judge TTC by bisection on shapely's distance, left of its minimum."""
    cases = random_cases(count, seed)
    own = geometry.time_to_contact(*cases.in_frame())
    low, high = np.zeros(count), np.full(count, 60.0)
    when, least = _smallest(cases.distance, low, high)
    clear = np.abs(least) > 1e-7
    hits = least < 0.0
    a, b = low.copy(), when.copy()
    for _ in range(70):
        middle = 0.5 * (a + b)
        inside = cases.distance(middle) <= 0.0
        a, b = np.where(inside, a, middle), np.where(inside, middle, b)
    judged = np.where(cases.distance(low) <= 0.0, 0.0, np.where(hits, b, np.inf))
    own_hits = own <= 60.0
    both = clear & hits & own_hits
    wrong = int((clear & (hits != own_hits)).sum())
    difference = np.abs(own[both] - judged[both])
    return agreement("TTC, rectangle and disc", "shapely, bisection", count, difference, "s", wrong)


def predicted_distance(count: int = 4000, seed: int = 2) -> Agreement:
    """Judge DCE by golden-section search on shapely's distance."""
    cases = random_cases(count, seed)
    own, _ = geometry.closest_approach(*cases.in_frame(), 100.0)
    _, least = _smallest(cases.distance, np.zeros(count), np.full(count, 100.0))
    difference = np.abs(own - np.maximum(least, 0.0))
    return agreement("DCE", "shapely, golden section", count, difference, "m")


def distance_between_samples(count: int = 4000, seed: int = 3) -> Agreement:
    """Judge the smallest distance within one step, by golden-section search on shapely's distance."""
    cases = random_cases(count, seed)
    step = np.random.default_rng(seed).uniform(0.02, 1.0, count)
    x, y, u, w, a, b, r = cases.in_frame()
    own, _ = geometry.closest_approach(x, y, u * step, w * step, a, b, r, 1.0)
    _, least = _smallest(cases.distance, np.zeros(count), step)
    difference = np.abs(own - np.maximum(least, 0.0))
    return agreement("smallest distance in a step", "shapely, golden section", count, difference, "m")


def rectangle_overlap(count: int = 4000, seed: int = 4) -> Agreement:
    """Judge vehicle overlaps by shapely's area of the intersection."""
    rng = np.random.default_rng(seed)
    one, two = rng.uniform(-4, 4, (2, count, 2))
    headings = rng.uniform(-np.pi, np.pi, (2, count))
    lengths, widths = rng.uniform(3.5, 12, (2, count)), rng.uniform(1.6, 2.5, (2, count))
    gap, _ = geometry.rectangle_separation(
        one[:, 0],
        one[:, 1],
        headings[0],
        lengths[0],
        widths[0],
        two[:, 0],
        two[:, 1],
        headings[1],
        lengths[1],
        widths[1],
    )
    area = shapely.area(
        shapely.intersection(
            rectangles(one, headings[0], lengths[0], widths[0]),
            rectangles(two, headings[1], lengths[1], widths[1]),
        )
    )
    wrong = int(((gap < -1e-9) != (area > 1e-12)).sum())
    return agreement("overlap of rectangles", "shapely, intersection", count, np.zeros(count), "-", wrong)


def braking(count: int = 4000, seed: int = 5) -> Agreement:
    """Judge DRAC by searching the smallest braking that keeps the front out of the area until T."""
    rng = np.random.default_rng(seed)
    v, d, t = rng.uniform(0.5, 20, count), rng.uniform(0.5, 60, count), rng.uniform(0.2, 12, count)
    own = required_deceleration(v, d, t)
    low, high = np.zeros(count), np.full(count, 1e4)
    for _ in range(90):
        middle = 0.5 * (low + high)
        moving = np.minimum(t, v / np.maximum(middle, 1e-300))
        enough = v * moving - 0.5 * middle * moving**2 <= d
        low, high = np.where(enough, low, middle), np.where(enough, middle, high)
    return agreement("DRAC", "search over constant braking", count, np.abs(own - high), "m/s^2")
