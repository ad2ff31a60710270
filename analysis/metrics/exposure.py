"""How much was driven and met: the denominators of all rates.

Egos, their way and time, pedestrians in some encounter, encounters, those in which the pedestrian was on
the crossing or in the ego's path (n_entered: the others only waited), and passages (an ego over a
crossing with at least one encounter).

Undefined: never.
"""

from __future__ import annotations

from analysis.encounters.case import Values
from analysis.encounters.whole_run import WholeRun
from analysis.tables import column

UNIT = "1"
WORSE = "neither"
SOURCE = "own definition"
RUN_COLUMNS = (
    column.count("ego_count", "egos", required=True),
    column.at_least_0("ego_dist_km", "km", "way of all egos", required=True),
    column.at_least_0("ego_time_h", "h", "time of all egos", required=True),
    column.count("ped_count", "pedestrians in some encounter", required=True),
    column.count("n_encounters", "encounters", required=True),
    column.count("n_entered", "encounters in which the pedestrian entered", required=True),
    column.count("n_passages", "passages of an ego over a crossing with an encounter", required=True),
)


def summarise(whole: WholeRun, columns: Values) -> Values:
    """Return the denominators."""
    met = whole.encounters
    return {
        "ego_count": len(whole.egos),
        "ego_dist_km": float(whole.steps.distance.sum()) / 1000.0,
        "ego_time_h": float(whole.steps.duration.sum()) / 3600.0,
        "ped_count": len({one.person_id for one in met}),
        "n_encounters": len(met),
        "n_entered": sum(one.entered for one in met),
        "n_passages": len({one.passage_id for one in met if one.passage_id}),
    }
