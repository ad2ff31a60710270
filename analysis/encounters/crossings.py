"""Times at which each ego's body was over each crossing of the map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from analysis.encounters.conflict_area import Visit, stays_on_lines
from analysis.encounters.lines import Lines
from analysis.recording.fine_grid import Grid
from analysis.recording.reading import RecordedRun
from analysis.recording.tracks import Track


@dataclass(frozen=True, slots=True)
class Traversal:
    """One passage of an ego over a crossing."""

    ego_id: str
    crossing_id: str
    number: int
    """1 for the ego's first passage over this crossing in the run."""
    visit: Visit
    track: Track


def traversals(
    egos: Sequence[Track], run: RecordedRun, grid: Grid
) -> Mapping[tuple[str, str], Sequence[Traversal]]:
    """Return (ego, crossing) -> traversals in the order of time."""
    found: dict[tuple[str, str], list[Traversal]] = {}
    crossings = [crossing for crossing in run.crossings() if len(crossing.shape) >= 2]
    half_widths = np.array([0.5 * crossing.width_m for crossing in crossings])
    lines = Lines([crossing.shape for crossing in crossings], half_widths)
    levels = run.levels
    for track in egos:
        for number, visit in stays_on_lines(track, grid, lines):
            name = crossings[number].name
            if levels.apart[track.level[visit.first], levels.of(name)]:
                continue
            listed = found.setdefault((track.name, name), [])
            listed.append(Traversal(track.name, name, len(listed) + 1, visit, track))
    return found
