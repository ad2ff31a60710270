"""The ego that a failed criterion is about if no pedestrian is concerned: who, when and where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from analysis.criteria.criterion import Cells
from analysis.metrics.deadlock import first_stand

DEADLOCK = "deadlock"
OVERLAPS, OVERLAPS_CLOSED = "n_vehicle_overlaps", "n_vehicle_overlaps_ego_closed"
ALONE = (DEADLOCK, OVERLAPS, OVERLAPS_CLOSED)
"""Metrics of a run that count what happens to egos without a pedestrian."""


@dataclass(frozen=True, slots=True)
class EgoAlone:
    """The ego that a number is about, the time and the place; the names are those of criteria.csv."""

    ego_id: str
    moment_s: float
    place: str
    note: str | None


def of_ego(metric: str, run: Cells, overlaps: Sequence[Cells]) -> EgoAlone | None:
    """Return the first deadlock, or the deepest overlap with a vehicle; ``None`` if there is none.

    Parameters
    ----------
    metric
        One of :data:`ALONE`.
    run
        Row of runs.csv.
    overlaps
        Rows of vehicle_overlaps.csv.
    """
    if metric == DEADLOCK:
        told = run["deadlock_where"]
        stand = first_stand(told)
        if stand is None:
            return None
        others = told.count("; ego ")
        note = f"stood until {stand.end_s:.1f} s" + (f"; all {others + 1}: {told}" if others else "")
        return EgoAlone(stand.ego_id, stand.start_s, stand.place, note)
    counted = [row for row in overlaps if metric == OVERLAPS or row["closed_by"] == "ego"]
    if not counted:
        return None
    worst = max(counted, key=lambda row: float(row["depth_m"]))
    place = f"{float(worst['depth_m']):.2f} m into vehicle {worst['vehicle_id']}"
    return EgoAlone(worst["ego_id"], float(worst["t_start_s"]), place, None)
