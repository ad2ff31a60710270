"""Times at which each ego's body was over each crossing of the map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from analysis.encounters.conflict_area import Visit, stays_on_line
from analysis.recording.reading import Area
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
    egos: Sequence[Track], crossings: Sequence[Area], grid: Grid
) -> Mapping[tuple[str, str], Sequence[Traversal]]:
    """Return (ego, crossing) -> traversals in the order of time."""
    found: dict[tuple[str, str], list[Traversal]] = {}
    for track in egos:
        for crossing in crossings:
            if len(crossing.shape) < 2:
                continue
            for visit in stays_on_line(track, grid, crossing.shape, 0.5 * crossing.width_m):
                listed = found.setdefault((track.name, crossing.name), [])
                listed.append(Traversal(track.name, crossing.name, len(listed) + 1, visit, track))
    return found
