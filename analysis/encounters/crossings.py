"""Times at which each ego's body was over each crossing of the map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from analysis.encounters.conflict_area import Visit, dense, reach, stays_on_line
from analysis.recording.reading import RecordedRun
from analysis.recording.tracks import Grid, Track


@dataclass(frozen=True, slots=True)
class Traversal:
    """One ego over one crossing."""

    ego_id: str
    crossing_id: str
    number: int
    """1 for the first time in the run."""
    visit: Visit
    track: Track


def traversals(
    egos: Sequence[Track], run: RecordedRun, grid: Grid
) -> Mapping[tuple[str, str], Sequence[Traversal]]:
    """Return (ego, crossing) -> traversals in the order of time."""
    found: dict[tuple[str, str], list[Traversal]] = {}
    lines = [crossing for crossing in run.crossings() if len(crossing.shape) >= 2]
    points = [dense(one.shape) for one in lines]
    # A town has thousands of crossings, and a vehicle passes a few: boxes tell most of them apart at once.
    low = np.array([one.shape.min(axis=0) - 0.5 * one.width_m for one in lines]).reshape(-1, 2)
    high = np.array([one.shape.max(axis=0) + 0.5 * one.width_m for one in lines]).reshape(-1, 2)
    levels = run.levels
    for track in egos:
        margin, places = reach(track), np.column_stack((track.x, track.y))
        near = (low <= places.max(axis=0) + margin) & (high >= places.min(axis=0) - margin)
        for number in np.flatnonzero(near.all(axis=1)).tolist():
            crossing = lines[number]
            for visit in stays_on_line(track, grid, points[number], 0.5 * crossing.width_m):
                if levels.apart[track.level[visit.first], levels.of(crossing.name)]:
                    continue
                listed = found.setdefault((track.name, crossing.name), [])
                listed.append(Traversal(track.name, crossing.name, len(listed) + 1, visit, track))
    return found
