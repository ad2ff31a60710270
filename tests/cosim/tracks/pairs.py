"""An independent judge of every pair in real tracks: shapely at every recorded instant, no code of analysis.

``python -m tests.cosim.tracks.pairs FOLDER`` holds the encounters of a judged folder against it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import shapely

FINER = 10
"""Instants between two recorded ones."""
NEAR_M = 45.0


@dataclass(frozen=True)
class Pair:
    """A vehicle and a pedestrian who were near each other."""

    vehicle: str
    pedestrian: str
    distance: float
    """Smallest one between the surfaces [m]."""
    time: float
    ttc: float
    """Smallest time to collision at constant velocities while on a crossing and the vehicle moves; inf [s]."""
    pet: float
    """Of one visit of each to the common ground, nan for another number of visits [s]."""


def bodies(rows: pd.DataFrame) -> np.ndarray:
    """Return the rectangles of a vehicle, whose recorded position is the middle of its front."""
    cos, sin = np.cos(rows["heading_rad"].to_numpy()), np.sin(rows["heading_rad"].to_numpy())
    x, y = rows["x_m"].to_numpy(), rows["y_m"].to_numpy()
    length, half = rows["length_m"].to_numpy(), 0.5 * rows["width_m"].to_numpy()
    corners = [(0.0, half), (0.0, -half), (-length, -half), (-length, half)]
    points = [
        np.stack([x + along * cos - across * sin, y + along * sin + across * cos], axis=-1)
        for along, across in corners
    ]
    return np.asarray(shapely.polygons(np.stack(points, axis=1)))


def finer(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the samples with more between them, on straight lines."""
    time = rows["time_s"].to_numpy()
    at = np.linspace(time[0], time[-1], (len(time) - 1) * FINER + 1)
    made = {name: np.interp(at, time, rows[name]) for name in ("x_m", "y_m", "x_speed_mps", "y_speed_mps")}
    made["length_m"] = made["width_m"] = np.full(len(at), 0.0)
    for name in ("length_m", "width_m"):
        made[name] = np.full(len(at), rows[name].iloc[0])
    if rows["heading_rad"].notna().all():
        made["heading_rad"] = np.interp(at, time, np.unwrap(rows["heading_rad"].to_numpy()))
    return pd.DataFrame({"time_s": at, **made})


def pairs(traffic: pd.DataFrame) -> Iterator[Pair]:
    """Yield every pair of a recording that was within 45 m."""
    tracks = list(traffic.groupby(["object_kind", "object_id"], sort=True))
    cars = {str(name): rows for (kind, name), rows in tracks if kind == "vehicle"}
    people = {str(name): rows for (kind, name), rows in tracks if kind == "pedestrian"}
    for person, walk in people.items():
        for vehicle, drive in cars.items():
            both = np.intersect1d(drive["time_s"].round(3), walk["time_s"].round(3))
            if len(both) < 2:
                continue
            own = drive[drive["time_s"].round(3).isin(both)]
            other = walk[walk["time_s"].round(3).isin(both)]
            if (
                np.hypot(
                    own["x_m"].to_numpy() - other["x_m"].to_numpy(),
                    own["y_m"].to_numpy() - other["y_m"].to_numpy(),
                ).min()
                > NEAR_M
            ):
                continue
            yield _judged(vehicle, person, own, other, drive, walk)


def _judged(
    vehicle: str, person: str, own: pd.DataFrame, other: pd.DataFrame, drive: pd.DataFrame, walk: pd.DataFrame
) -> Pair:
    radius = 0.5 * float(walk["width_m"].iloc[0])
    fine, fine_walk = finer(own), finer(other)
    away = shapely.distance(bodies(fine), shapely.points(fine_walk[["x_m", "y_m"]].to_numpy())) - radius
    best = int(np.argmin(away))
    return Pair(
        vehicle,
        person,
        max(float(away[best]), 0.0),
        float(fine["time_s"].iloc[best]),
        _ttc(own, other, radius),
        _pet(drive, walk, radius),
    )


def _ttc(own: pd.DataFrame, other: pd.DataFrame, radius: float) -> float:
    """Return the smallest TTC, by looking ahead in steps of a hundredth of a second."""
    on = (other["phase"] == "crossing").to_numpy()
    moving = np.hypot(own["x_speed_mps"].to_numpy(), own["y_speed_mps"].to_numpy()) > 0.1
    least = np.inf
    shapes = bodies(own)
    ahead = np.arange(0.0, 8.0, 0.01)
    start = other[["x_m", "y_m"]].to_numpy()
    relative = (
        other[["x_speed_mps", "y_speed_mps"]].to_numpy() - own[["x_speed_mps", "y_speed_mps"]].to_numpy()
    )
    near = (
        np.hypot(
            own["x_m"].to_numpy() - other["x_m"].to_numpy(), own["y_m"].to_numpy() - other["y_m"].to_numpy()
        )
        < NEAR_M
    )
    for at in np.flatnonzero(on & moving & near):
        motion = relative[at]
        if not _may_meet(start[at] - own[["x_m", "y_m"]].to_numpy()[at], motion):
            continue
        hit = shapely.distance(shapes[at], shapely.points(start[at] + ahead[:, None] * motion)) <= radius
        if hit.any():
            least = min(least, float(ahead[int(np.argmax(hit))]))
    return least


def _may_meet(way: np.ndarray, motion: np.ndarray) -> bool:
    """Return whether a pedestrian comes within 10 m of a vehicle's front in the next 8 s."""
    speed = float(motion @ motion)
    when = min(max(-float(way @ motion) / speed, 0.0), 8.0) if speed > 0.0 else 0.0
    return bool(np.hypot(*(way + when * motion)) < 10.0)


def _pet(drive: pd.DataFrame, walk: pd.DataFrame, radius: float) -> float:
    """Return the time between one leaving the common ground and the other entering it."""
    fine, fine_walk = finer(drive), finer(walk)
    shapes = bodies(fine)
    way = shapely.LineString(fine_walk[["x_m", "y_m"]].to_numpy())
    shapely.prepare(way)
    touching = np.asarray(shapely.dwithin(way, shapes, radius))
    if not touching.any():
        return np.nan
    # Only bodies near the walk can share ground with it.
    swept = shapely.union_all(shapes[shapely.dwithin(way, shapes, radius + 1.0)])
    shapely.prepare(swept)
    instants = []
    for inside, time in (
        (touching, fine["time_s"].to_numpy()),
        (
            np.asarray(
                shapely.distance(swept, shapely.points(fine_walk[["x_m", "y_m"]].to_numpy())) <= radius
            ),
            fine_walk["time_s"].to_numpy(),
        ),
    ):
        edges = np.flatnonzero(np.diff(inside.astype(int)))
        if len(edges) != 2 or inside[0]:
            return np.nan
        instants.append((time[edges[0] + 1], time[edges[1]]))
    (enter, leave), (person_enter, person_leave) = instants
    return float(max(person_enter - leave, enter - person_leave))


def main() -> None:
    """Print how far the encounters of a folder are from the judge."""
    folder = Path(sys.argv[1])
    traffic = pd.read_parquet(folder / "traffic.parquet")
    listed = pd.read_csv(folder / "traffic_encounters.csv", dtype={"vehicle_id": str, "ped_id": str})
    judged = list(pairs(traffic))
    print(f"{len(judged)} pairs within {NEAR_M:g} m of each other, {len(listed)} encounters listed")
    known = dict(list(listed.groupby(["vehicle_id", "ped_id"])))
    gaps, ttcs, pets, unlisted = [], [], [], []
    for pair in judged:
        rows = known.get((pair.vehicle, pair.pedestrian))
        if rows is None:
            if pair.distance < 1.0:
                unlisted.append(pair)
            continue
        inside = rows[(rows["t_start_s"] <= pair.time) & (pair.time <= rows["t_end_s"])]
        if len(inside):
            gaps.append(abs(inside["min_dist_m"].min() - pair.distance))
        if np.isfinite(pair.ttc) and rows["min_ttc_s"].notna().any():
            ttcs.append(abs(rows["min_ttc_s"].min() - pair.ttc))
        if np.isfinite(pair.pet) and len(rows) == 1 and rows["pet_status"].iloc[0] == "ok":
            pets.append(abs(rows["pet_area_s"].iloc[0] - pair.pet))
    for name, values, unit in (("smallest distance", gaps, "m"), ("TTC", ttcs, "s"), ("PET", pets, "s")):
        worst = max(values, default=np.nan)
        print(f"{name}: {len(values)} compared, largest difference {worst:.4f} {unit}")
    print(f"{len(unlisted)} pairs nearer than 1 m that are no encounter")
    for pair in unlisted:
        print(f"  {pair}")


if __name__ == "__main__":
    main()
