"""A judge of the instants at which a conflict area is entered and left: shapely's swept areas."""

from __future__ import annotations

import numpy as np
import shapely

from analysis.encounters.conflict_area import conflict_areas
from analysis.polylines import arc_lengths
from analysis.recording.fine_grid import Grid
from analysis.recording.tracks import Track
from tests.analysis.judges.agreement import Agreement, Array, agreement
from tests.analysis.judges.uniform_motion import rectangles


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
    return agreement("entry and exit of the conflict area", "shapely, swept areas", count, found, "s", wrong)


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
