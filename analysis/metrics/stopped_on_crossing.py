"""Egos that stood with their body over a crossing, and how often they could have known before.

Stretches of at least stopped_on_crossing_s at or below standing_speed_mps within a passage over a
crossing of the map. Foreseeable are those for which somebody stood in the ego's way over the crossing
when it could still have stopped before it with comfort_deceleration_mps2.

Undefined: never; 0 where the map has no crossings.
"""

from __future__ import annotations

from analysis.encounters.case import Case, Values
from analysis.encounters.crossing_stops import count_stops, was_foreseeable
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition"
RUN_COLUMNS = (
    column.count("n_stopped_on_crossing", "stops with the body over a crossing", required=True),
    column.count(
        "n_stopped_on_crossing_foreseeable",
        "those for which somebody stood in the way when the ego could still stop before the crossing",
    ),
)


def compute(case: Case) -> Values:
    """Return the number of stops, and of those that could have been foreseen."""
    limits, vehicles = case.thresholds, [*case.vehicles, *case.egos]
    stops = foreseeable = 0
    for passage in (one for passed in case.traversals.values() for one in passed):
        count = count_stops(passage, case.grid, limits)
        stops += count
        if count and was_foreseeable(passage, vehicles, case.persons, limits):
            foreseeable += count
    return {"n_stopped_on_crossing": stops, "n_stopped_on_crossing_foreseeable": foreseeable}
