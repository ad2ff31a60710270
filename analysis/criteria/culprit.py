"""The encounter that a failed criterion of a run or of encounters is about: who, when and where."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from analysis.criteria.criterion import Cells
from analysis.encounters.severity_scale import LEVELS
from analysis.metrics import contact_kind, deceleration_to_avoid_collision, modified_deceleration

_TTC = ("min_ttc_s", min, "t_min_ttc_s")
_DISTANCE = ("min_dist_m", min, "t_min_dist_s")
_IMPACT = ("impact_speed_kmh", max, "t_collision_s")
_BY_WORD: tuple[tuple[str, tuple[str, Callable[..., float], str]], ...] = (
    ("collision", _IMPACT),
    ("p_fatal", _IMPACT),
    ("impact", _IMPACT),
    ("contacts_standing", _DISTANCE),
    ("mdrac", ("mdrac_max_mps2", max, "t_min_ttc_s")),
    ("drac", ("drac_max_mps2", max, "t_min_ttc_s")),
    ("ttc", _TTC),
    ("tet_", _TTC),
    ("tit_", _TTC),
    ("pet", ("pet_area_s", min, "t_min_dist_s")),
    ("dist_m", _DISTANCE),
    ("clearance", ("clearance_min_m", min, "t_min_dist_s")),
    ("close_pass", ("close_pass_speed_mps", max, "t_min_dist_s")),
    ("decel", ("ego_max_decel_mps2", max, "t_min_dist_s")),
    ("ped_delay", ("ped_delay_s", max, "t_start_s")),
)
"""Word in a metric's name -> column of encounters.csv, how its worst value is chosen, and column of its time.

The first word that fits counts."""
_SEVERITY = ("conflict", "severity")
_OF_KIND = {
    **contact_kind.COUNTED,
    **{f"n_severity_{level}": ("severity", level) for level in LEVELS},
    "n_contacts_standing": ("contact_standing", "1"),
    "n_hidden_before_conflict": ("hidden_before_conflict", "1"),
}
"""Metric -> column of encounters.csv, and the text there of the encounters that it counts."""
OF_ALL_STEPS = {"max_decel_mps2": "ego_max_decel_mps2"}
"""Metric of all steps of a run -> same metric of an encounter; an encounter is to blame only if the two are
equal."""
_BEYOND = {
    "n_drac_gt_3p4": ("drac_status", deceleration_to_avoid_collision.BEYOND),
    "n_mdrac_gt_3p4": ("mdrac_status", modified_deceleration.BEYOND),
}
"""Metric -> column, and the texts there of the encounters that it counts as worse than any number."""


@dataclass(frozen=True, slots=True)
class Culprit:
    """The encounter that a number is about, with its time and place."""

    encounter_id: int
    ego_id: str
    ped_id: str
    moment_s: float
    place: str


def culprit(metric: str, rows: Sequence[Cells]) -> Culprit | None:
    """Return the worst encounter by the value that a metric of a run counts; ``None`` if none has a value.

    Parameters
    ----------
    metric
        Column of runs.csv or encounters.csv.
    rows
        Rows of encounters.csv.
    """
    if metric in _OF_KIND:
        told_by, text = _OF_KIND[metric]
        rows = [row for row in rows if row[told_by] == text]
    if metric in _BEYOND:
        status, worse = _BEYOND[metric]
        beyond = [row for row in rows if row[status] in worse]
        if beyond:
            return of_row(metric, max(beyond, key=lambda row: worse.index(row[status])))
    if any(word in metric for word in _SEVERITY):
        known = [row for row in rows if LEVELS.index(row["severity"]) > 0]
        worst = max(known, key=lambda row: LEVELS.index(row["severity"]), default=None)
        return None if worst is None else of_row(metric, worst)
    told = _told_by(metric)
    if told is None:
        return None
    column, choose, _ = told
    if "preventable" in metric:
        rows = [row for row in rows if row["preventable_r157"] != "0"]
    known = [row for row in rows if row[column]]
    if not known:
        return None
    value = choose(float(row[column]) for row in known)
    return of_row(metric, next(row for row in known if float(row[column]) == value))


def of_row(metric: str, row: Cells) -> Culprit:
    """Return the encounter of a row of encounters.csv, with the time that a metric is about and the place."""
    told = _told_by(metric) or _TTC
    moments = (row[told[2]], row["t_min_ttc_s"], row["t_min_dist_s"], row["t_start_s"])
    place = f"at crossing {row['crossing_id']}" if row["crossing_id"] else "off any crossing"
    return Culprit(
        int(row["encounter_id"]),
        row["ego_id"],
        row["ped_id"],
        float(next(text for text in moments if text)),
        place,
    )


def _told_by(metric: str) -> tuple[str, Callable[..., float], str] | None:
    return next((told for word, told in _BY_WORD if word in metric), None)
