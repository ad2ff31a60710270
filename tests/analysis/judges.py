"""Independent judges of the geometry: shapely and brute-force searches, sharing no code with analysis.

``python -m tests.analysis.judges`` prints the agreement table of docs/judges.md.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import shapely

from analysis import geometry
from analysis.encounters.case import prepare
from analysis.encounters.conflict_area import conflict_areas
from analysis.encounters.prediction import required_deceleration
from analysis.markdown import table_of
from analysis.polylines import arc_lengths
from analysis.recording.reading import read_run
from analysis.recording.tracks import Grid, Track
from tests.analysis.recorded import Ego, Person, line, write_run

Array = np.ndarray


@dataclass(frozen=True)
class Agreement:
    """How far a measure is from its judge over all cases."""

    measure: str
    judge: str
    cases: int
    defined: int
    largest: float
    mean: float
    unit: str
    disagreements: int = 0
    """Cases in which one says defined and the other does not."""


Judge = Callable[[int], Agreement]


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
    return _agreement("TTC, rectangle and disc", "shapely, bisection", count, difference, "s", wrong)


def predicted_distance(count: int = 4000, seed: int = 2) -> Agreement:
    """Judge DCE by golden-section search on shapely's distance."""
    cases = random_cases(count, seed)
    own, _ = geometry.closest_approach(*cases.in_frame(), 100.0)
    _, least = _smallest(cases.distance, np.zeros(count), np.full(count, 100.0))
    difference = np.abs(own - np.maximum(least, 0.0))
    return _agreement("DCE", "shapely, golden section", count, difference, "m")


def distance_between_samples(count: int = 4000, seed: int = 3) -> Agreement:
    """Judge the smallest distance within one step, by golden-section search on shapely's distance."""
    cases = random_cases(count, seed)
    step = np.random.default_rng(seed).uniform(0.02, 1.0, count)
    x, y, u, w, a, b, r = cases.in_frame()
    own, _ = geometry.closest_approach(x, y, u * step, w * step, a, b, r, 1.0)
    _, least = _smallest(cases.distance, np.zeros(count), step)
    difference = np.abs(own - np.maximum(least, 0.0))
    return _agreement("smallest distance in a step", "shapely, golden section", count, difference, "m")


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
    return _agreement("overlap of rectangles", "shapely, intersection", count, np.zeros(count), "-", wrong)


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
    return _agreement("DRAC", "search over constant braking", count, np.abs(own - high), "m/s^2")


def conflict_area_instants(count: int = 100, seed: int = 6) -> Agreement:
    """Judge the four instants of PET on straight paths by shapely's swept areas."""
    rng = np.random.default_rng(seed)
    grid = Grid(1, np.arange(0.0, 20.0 + 1e-9, 0.05))
    differences, wrong = [], 0
    for _ in range(count):
        ego, person, swept = _crossing_paths(rng, grid)
        areas = conflict_areas(ego, person, grid, 60.0)
        judged = _judged_instants(*swept)
        if len(areas) != 1 or judged is None:
            wrong += (len(areas) == 1) != (judged is not None)
            continue
        visits = areas[0].ego, areas[0].person
        own = np.array([instant for visit in visits for instant in (visit.enter, visit.leave)])
        differences.append(np.abs(own - judged).max())
    found = np.array(differences)
    return _agreement("entry and exit of the conflict area", "shapely, swept areas", count, found, "s", wrong)


def _crossing_paths(
    rng: np.random.Generator, grid: Grid
) -> tuple[Track, Track, tuple[Array, Array, float, Array, Array, float]]:
    heading = float(rng.uniform(-np.pi, np.pi))
    angle = heading + float(rng.choice([-1, 1]) * rng.uniform(0.6, np.pi - 0.6))
    speed, walking = float(rng.uniform(3, 15)), float(rng.uniform(0.8, 2.5))
    meet = rng.uniform(-10, 10, 2)
    ego_at, person_at = rng.uniform(6, 14, 2)
    ego_velocity = speed * np.array([np.cos(heading), np.sin(heading)])
    person_velocity = walking * np.array([np.cos(angle), np.sin(angle)])
    ego_start, person_start = meet - ego_velocity * ego_at, meet - person_velocity * person_at
    ego = _track(ego_start, ego_velocity, heading, 4.5, 1.8, grid)
    person = _track(person_start, person_velocity, np.nan, 0.5, 0.5, grid)
    return (
        ego,
        person,
        (ego_start, ego_velocity, heading, person_start, person_velocity, float(grid.time[-1])),
    )


def _track(start: Array, velocity: Array, heading: float, length: float, width: float, grid: Grid) -> Track:
    position = start + velocity * grid.time[:, None]
    ones = np.ones(len(grid.time))
    return Track(
        name="a",
        kind="",
        first=0,
        rows=np.zeros(len(ones), dtype=np.int64),
        x=position[:, 0],
        y=position[:, 1],
        heading=heading * ones,
        x_speed=velocity[0] * ones,
        y_speed=velocity[1] * ones,
        speed=np.hypot(*velocity) * ones,
        acceleration=0.0 * ones,
        path=arc_lengths(position),
        level=np.zeros(len(ones), dtype=np.int64),
        length=length,
        width=width,
    )


def _judged_instants(
    ego_start: Array,
    ego_velocity: Array,
    heading: float,
    person_start: Array,
    person_velocity: Array,
    end: float,
) -> Array | None:
    def body(t: float) -> shapely.Polygon:
        centre = (ego_start + ego_velocity * t)[None]
        body: shapely.Polygon = rectangles(centre, np.array([heading]), np.array([4.5]), np.array([1.8]))[0]
        return body

    def centre(t: float) -> shapely.Point:
        return shapely.Point(person_start + person_velocity * t)

    body_path = shapely.union_all([body(0.0), body(end)]).convex_hull
    walk = shapely.LineString([person_start, person_start + person_velocity * end])
    instants = []

    def body_to_walk(t: float) -> float:
        return float(body(t).distance(walk))

    def centre_to_path(t: float) -> float:
        return float(body_path.distance(centre(t)))

    for distance in (body_to_walk, centre_to_path):
        inside = [t for t in np.arange(0.0, end, 0.04) if distance(t) <= 0.25]
        if not inside or inside[0] == 0.0:
            return None
        for out, within in ((inside[0] - 0.04, inside[0]), (inside[-1] + 0.04, inside[-1])):
            a, b = out, within
            for _ in range(50):
                middle = 0.5 * (a + b)
                a, b = (a, middle) if distance(middle) <= 0.25 else (middle, b)
            instants.append(b)
    return np.array(instants)


def curved_rides(step: float, count: int = 40, seed: int = 7) -> Agreement:
    """Judge the smallest distance of recorded curved and braking rides by shapely at every millisecond."""
    rng = np.random.default_rng(seed)
    differences = []
    with tempfile.TemporaryDirectory() as name:
        for number in range(count):
            bend, speed, braking = rng.uniform(-0.08, 0.08), rng.uniform(5, 9), rng.uniform(0.0, 1.0)
            ride = _Ride(bend, speed, braking)
            # Aims at where the ego is after 3 to 5 s, so that most pass close by.
            place = np.array(ride.centre(rng.uniform(3, 5))) + rng.uniform(-3, 3, 2)
            walk = rng.uniform(-1.5, 1.5, 2)
            start = place - 4.0 * walk
            folder = write_run(
                Path(name) / str(number),
                [ride.ego()],
                [Person(line(*start, *walk), crossing="zebra")],
                step=step,
                duration=7.0,
                areas=(),
            )
            case = prepare(read_run(folder))
            time = np.arange(0.0, 7.0, 0.001)
            centres = np.array([ride.centre(t) for t in time])
            headings = np.array([ride.heading(t) for t in time])
            bodies = rectangles(centres, headings, np.full(len(time), 4.5), np.full(len(time), 1.8))
            persons = shapely.points(start + walk * time[:, None])
            least = max(float((shapely.distance(bodies, persons) - 0.25).min()), 0.0)
            (own,) = case.approach.distance
            differences.append(abs(own - least))
    title = f"smallest distance of a curved, braking ride, step {step:g} s"
    return _agreement(title, "shapely, every 1 ms", count, np.array(differences), "m")


@dataclass(frozen=True)
class _Ride:
    """A rear axle on a circle, braking steadily."""

    bend: float
    speed: float
    braking: float

    def way(self, t: float) -> float:
        return self.speed * t - 0.5 * self.braking * t * t

    def heading(self, t: float) -> float:
        return self.bend * self.way(t)

    def centre(self, t: float, ahead: float = 1.3) -> tuple[float, float]:
        turn = self.heading(t)
        x = np.sin(turn) / self.bend + ahead * np.cos(turn)
        y = (1 - np.cos(turn)) / self.bend + ahead * np.sin(turn)
        return float(x), float(y)

    def ego(self) -> Ego:
        front = 1.3 + 2.25
        return Ego(
            self.centre,
            columns={
                "heading_rad": self.heading,
                "front_x_m": lambda t: self.centre(t, front)[0],
                "front_y_m": lambda t: self.centre(t, front)[1],
                "speed_mps": lambda t: self.speed - self.braking * t,
            },
        )


def _agreement(
    measure: str, judge: str, cases: int, difference: Array, unit: str, disagreements: int = 0
) -> Agreement:
    largest = float(difference.max()) if len(difference) else 0.0
    mean = float(difference.mean()) if len(difference) else 0.0
    return Agreement(measure, judge, cases, len(difference), largest, mean, unit, disagreements)


JUDGES: tuple[Callable[[], Agreement], ...] = (
    time_to_contact,
    predicted_distance,
    distance_between_samples,
    rectangle_overlap,
    braking,
    conflict_area_instants,
    lambda: curved_rides(0.1),
    lambda: curved_rides(1.0),
)


def main() -> None:
    """Print the table."""
    rows = [
        {
            "measure": found.measure,
            "judge": found.judge,
            "cases": found.cases,
            "compared": found.defined,
            "largest difference": f"{found.largest:.2g} {found.unit}",
            "mean difference": f"{found.mean:.2g} {found.unit}",
            "disagreements": found.disagreements,
        }
        for found in (judge() for judge in JUDGES)
    ]
    print(table_of(rows))


if __name__ == "__main__":
    main()
