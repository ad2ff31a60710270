"""Overlaps of an ego's rectangle with other vehicles.

Each is listed in vehicle_overlaps.csv. The ego closed it if, in the step that closed the last gap, its
own motion along the separating axis closed at least as much as the other's, and more than nothing.

Undefined: never. The other vehicle's heading is SUMO's, which leans while it changes lanes almost at a
standstill (by half a radian in a recording of the Braunschweig network): there an overlap may be an
artefact of the heading.
"""

from __future__ import annotations

from analysis.encounters.case import Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "higher"
SOURCE = "own definition; separating-axis theorem"
RUN_COLUMNS = (
    column.count("n_vehicle_overlaps", "overlaps with other vehicles", required=True),
    column.count("n_vehicle_overlaps_ego_closed", "those that the ego closed", required=True),
)


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the number of overlaps, and of those that the ego closed."""
    return {
        "n_vehicle_overlaps": len(whole.overlaps),
        "n_vehicle_overlaps_ego_closed": sum(one.closed_by == "ego" for one in whole.overlaps),
    }
