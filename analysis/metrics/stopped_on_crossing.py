"""Egos that stood with their body over a crossing, and how often they could have known before.

Stretches of at least stopped_on_crossing_s at or below standing_speed_mps within a passage over a
crossing of the map. Foreseeable are those for which somebody stood in the ego's way over the crossing
when it could still have stopped before it with comfort_deceleration_mps2.

Undefined: never; 0 where the map has no crossings.
"""

from __future__ import annotations

from analysis.encounters.case import Case, Values
from analysis.encounters.crossing_stops import count_stops, was_foreseeable
from analysis.encounters.whole_run import WholeRun
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


def collect_rides(case: Case) -> Values:
    """Return for every stop whether it could have been foreseen."""
    limits = case.thresholds
    foreseeable: list[bool] = []
    for passage in (one for passed in case.traversals.values() for one in passed):
        if count := count_stops(passage, case.grid, limits):
            foreseeable += [was_foreseeable(passage, case.bodies, case.crowd.during, limits)] * count
    return {"foreseeable": foreseeable}


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the number of stops, and of those that could have been foreseen."""
    foreseeable = columns["foreseeable"]
    return {
        "n_stopped_on_crossing": len(foreseeable),
        "n_stopped_on_crossing_foreseeable": sum(foreseeable),
    }
