"""Places of contacts on the map: on a crossing, on the carriageway, or off it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from analysis.polylines import inside
from analysis.recording.fine_grid import Grid
from analysis.recording.reading import Area, RecordedRun
from analysis.recording.tracks import Track

PLACES = ("crossing", "carriageway", "walking_area_or_kerb")
_MARGIN_M = 1e-6


class Areas:
    """Areas of a map with their bounding boxes, which quickly rule out most areas for a point."""

    def __init__(self, areas: Sequence[Area]) -> None:
        self._areas = areas
        half = [np.full(2, 0.5 * one.width_m + _MARGIN_M) for one in areas]
        low = [one.shape.min(axis=0) - by for one, by in zip(areas, half, strict=True)]
        high = [one.shape.max(axis=0) + by for one, by in zip(areas, half, strict=True)]
        self._low, self._high = np.array(low).reshape(-1, 2), np.array(high).reshape(-1, 2)

    def near(self, x: float, y: float) -> Iterator[Area]:
        """Yield the areas whose box, grown by half their width, holds a point."""
        point = (x, y)
        held = ((self._low <= point) & (self._high >= point)).all(axis=1)
        return (self._areas[number] for number in np.flatnonzero(held).tolist())


@dataclass(frozen=True, slots=True)
class Places:
    """The areas of a map, sorted by what they mean for a pedestrian."""

    crossings: Areas
    walking_areas: Areas
    carriageway: Areas
    """Lanes inside junctions, and lanes on which a vehicle was recorded: a map does not say who may use a
    lane."""
    lanes_known: bool


def places_of(run: RecordedRun) -> Places:
    """Return the areas of a run's map."""
    used = {*run.places, *run.egos.texts["lane"].names, *run.neighbours.texts["edge_or_lane"].names}
    lanes = [area for area in run.areas if area.kind == "lane"]
    return Places(
        crossings=Areas(run.crossings()),
        walking_areas=Areas([area for area in run.areas if area.kind == "walkingarea"]),
        carriageway=Areas([area for area in lanes if area.name.startswith(":") or area.name in used]),
        lanes_known=bool(lanes),
    )


def place_of(person: Track, time: float, run: RecordedRun, grid: Grid, places: Places) -> str:
    """Return the kind of place of a pedestrian's centre at an instant [s].

    The centre is on a crossing if the recording says so, or if it is within the width of one; else on a
    walking area if it is within the outline of one; else on the carriageway if it is within the width of a
    lane that vehicles use, or if the map has no lanes at all. Any other place counts as the kerb.
    """
    own = grid.time[person.first : person.last + 1]
    x, y = float(np.interp(time, own, person.x)), float(np.interp(time, own, person.y))
    row = person.rows[[max(0, int(np.searchsorted(own, time + 1e-9)) - 1)]]
    if run.neighbours.texts["phase"].equal("crossing", row)[0]:
        return "crossing"
    if any(_on_ribbon(area, x, y) for area in places.crossings.near(x, y)):
        return "crossing"
    if any(inside(area.shape, np.array([[x, y]])).all() for area in places.walking_areas.near(x, y)):
        return "walking_area_or_kerb"
    if not places.lanes_known or any(_on_ribbon(area, x, y) for area in places.carriageway.near(x, y)):
        return "carriageway"
    return "walking_area_or_kerb"


def _on_ribbon(area: Area, x: float, y: float) -> bool:
    """Return whether a point is beside an area's centre line, within half its width."""
    start, change = area.shape[:-1], np.diff(area.shape, axis=0)
    if len(change) == 0:
        return False
    squared = np.maximum((change**2).sum(axis=1), 1e-12)
    along = ((x - start[:, 0]) * change[:, 0] + (y - start[:, 1]) * change[:, 1]) / squared
    inner = np.clip(along, 0.0, 1.0)
    # The ends are flat; between two pieces the ribbon goes round the corner.
    inner[0] = min(along[0], inner[0])
    inner[-1] = max(along[-1], inner[-1])
    away = np.hypot(x - start[:, 0] - inner * change[:, 0], y - start[:, 1] - inner * change[:, 1])
    beside = away <= 0.5 * area.width_m
    beside[0] &= along[0] >= 0.0
    beside[-1] &= along[-1] <= 1.0
    return bool(beside.any())
