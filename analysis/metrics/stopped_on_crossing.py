"""Egos that stood with their body over a crossing.

Stretches of at least stopped_on_crossing_s at or below standing_speed_mps within a passage over a
crossing of the map.

Undefined: never; 0 where the map has no crossings.
"""

from __future__ import annotations

from analysis.encounters.case import Case, Values
from analysis.stretches import stretches
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
RUN_COLUMNS = (column.count("n_stopped_on_crossing", "stops with the body over a crossing", required=True),)


def compute(case: Case) -> Values:
    """Return the number of stretches."""
    limits = case.thresholds
    count = 0
    for passages in case.traversals.values():
        for passage in passages:
            first, last = passage.visit.first, passage.visit.last
            speed = passage.track.speed[first : last + 1]
            time = case.grid.time[passage.track.first + first : passage.track.first + last + 1]
            for start, end in stretches(speed <= limits.standing_speed_mps):
                count += bool(time[end] - time[start] >= limits.stopped_on_crossing_s)
    return {"n_stopped_on_crossing": count}
