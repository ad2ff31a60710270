"""Measures that are summarised and compared over many runs.

This file defines the shares and rates, with their numerators and denominators. All other measures follow
from the metrics: every number that a metric writes into runs.csv, and the first number of every encounter
metric. Wall-clock columns are left out, so that the tables of a study have the same bytes for the same
inputs.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from analysis.results.metric_catalog import Metric, find_metrics
from analysis.tables.column import Column


@dataclass(frozen=True, slots=True)
class Measure:
    """One number that describes the runs of a configuration, and how it is computed."""

    name: str
    unit: str
    kind: str
    """``mean`` or ``count``: one value for each run. ``yes_no``: whether the run had one. ``share``: events
    over trials, ``rate``: events over exposure, both summed over runs. ``encounter``: one value for each
    encounter."""
    text: str
    numerator: str
    """Column of runs.csv or tally of encounters; for an encounter measure, column of encounters.csv."""
    denominator: str = ""
    """Column or tally below the fraction line of a share or rate."""
    denominator_unit: str = "run"
    per: float = 1.0
    """The rate is per this many units of the denominator."""
    group: str = "other"
    """``safety``, ``comfort``, ``pedestrians``, ``efficiency`` or ``other``."""
    key: bool = False
    """Whether it is one of the few measures that a claim may rest on, chosen before any comparison."""
    worse: str = "higher"
    """``higher``, ``lower`` or ``neither``."""
    lowest: float | None = 0.0
    """Lower bound of the quantity; ``None`` if there is none."""
    highest: float | None = None
    """Upper bound of the quantity; ``None`` if there is none."""


ENTERED = "entered encounter"
"""Default denominator of a share: the pedestrian was on the crossing or in the ego's path."""

TALLIES = (
    "met",
    "met_collision",
    "met_preventable",
    "met_ttc_lt_1p5",
    "met_pet_lt_1p5",
    "met_drac_gt_3p4",
    "met_conflict",
)
"""Counts of entered encounters: *met* counts all of them, the others those in which something happened."""


def _share(name: str, text: str, numerator: str, key: bool = False) -> Measure:
    return Measure(
        name,
        "1",
        "share",
        text,
        numerator,
        "met",
        ENTERED,
        group="safety",
        key=key,
        worse="higher",
        highest=1.0,
    )


def _rate(
    name: str, unit: str, text: str, numerator: str, group: str = "safety", key: bool = False
) -> Measure:
    denominator, denominator_unit = {"1/km": ("ego_dist_km", "km"), "1/h": ("ego_time_h", "h")}[unit]
    return Measure(name, unit, "rate", text, numerator, denominator, denominator_unit, group=group, key=key)


POOLED = (
    Measure(
        "runs_with_collision",
        "1",
        "yes_no",
        "runs with a collision",
        "n_collisions",
        group="safety",
        key=True,
    ),
    _share("collision_share", "entered encounters with a collision", "met_collision", key=True),
    _share("ttc_lt_1p5_share", "entered encounters with TTC < 1.5 s", "met_ttc_lt_1p5", key=True),
    _share("pet_lt_1p5_share", "entered encounters with PET < 1.5 s", "met_pet_lt_1p5", key=True),
    _share(
        "drac_gt_3p4_share",
        "entered encounters with DRAC > 3.4 m/s², or with a collision",
        "met_drac_gt_3p4",
        key=True,
    ),
    _share("conflict_share", "entered encounters of severity serious or worse", "met_conflict"),
    _rate("conflicts_per_veh_km", "1/km", "conflicts per km", "n_conflicts", key=True),
    _rate("conflicts_per_veh_h", "1/h", "conflicts per hour of driving", "n_conflicts"),
    Measure(
        "conflicts_per_1000_ped",
        "1",
        "rate",
        "conflicts per 1000 pedestrians met",
        "n_conflicts",
        "ped_count",
        "1000 pedestrians",
        1000.0,
        "safety",
    ),
    _rate("collisions_per_veh_km", "1/km", "collisions per km", "n_collisions"),
    _rate("collisions_per_veh_h", "1/h", "collisions per hour of driving", "n_collisions"),
    _rate(
        "vehicle_overlaps_per_veh_km",
        "1/km",
        "overlaps with vehicles, closed by the ego, per km",
        "n_vehicle_overlaps_ego_closed",
        key=True,
    ),
    _rate("hard_brakes_per_veh_km", "1/km", "hard braking per km", "n_hard_brake", "comfort", key=True),
    Measure(
        "yield_rate",
        "1",
        "share",
        "pedestrians let go first where the ego could",
        "yields",
        "yieldable",
        "yieldable encounter",
        group="pedestrians",
        key=True,
        worse="lower",
        highest=1.0,
    ),
)
"""Shares and rates. If runs.csv has a column of the same name, this is its equivalent over all runs."""

_PLACES = {
    "p95_abs_jerk_mps3": ("comfort", True, "jerk, 95th percentile"),
    "max_decel_mps2": ("comfort", False, "largest deceleration"),
    "ped_delay_mean_s": ("pedestrians", True, "mean delay of pedestrians"),
    "ego_delay_mean_s": ("efficiency", True, "mean delay of an ego"),
}
"""Group, key and text of measures that follow from a metric."""
DELAY = "ego_delay_mean_s"
"""The measure that defines *slower*."""


@cache
def run_measures() -> tuple[Measure, ...]:
    """Return the measures with a number for each run: first those defined here, then all others by name."""
    named = {measure.name for measure in POOLED}
    found = []
    for metric in find_metrics():
        for column in metric.run_columns:
            name = column.name
            if name in named or column.kind not in ("integer", "number") or is_wall_clock(name):
                continue
            group, key, text = _PLACES.get(name, ("other", False, column.description))
            kind = "count" if column.kind == "integer" else "mean"
            worse = _worse(metric, column)
            found.append(
                Measure(
                    name,
                    column.unit,
                    kind,
                    text,
                    name,
                    group=group,
                    key=key,
                    worse=worse,
                    lowest=column.minimum,
                    highest=column.maximum,
                )
            )
    return (*POOLED, *sorted(found, key=lambda measure: measure.name))


@cache
def encounter_measures() -> tuple[Measure, ...]:
    """Return the measures with a value for each encounter: the first number of each encounter metric."""
    found = []
    for metric in find_metrics():
        if metric.scope != "encounter" or metric.worse == "neither":
            continue
        column = metric.columns[0]
        if column.kind == "number" and column.unit == metric.unit:
            found.append(
                Measure(
                    column.name,
                    column.unit,
                    "encounter",
                    column.description,
                    column.name,
                    denominator_unit="encounter",
                    worse=metric.worse,
                    lowest=column.minimum,
                    highest=column.maximum,
                )
            )
    return tuple(sorted(found, key=lambda measure: measure.name))


def is_wall_clock(column: str) -> bool:
    """Return whether a column's values differ between two runs of the same inputs."""
    return column.startswith(("wall_", "compute_"))


def _worse(metric: Metric, column: Column) -> str:
    """Return which direction of a run column is worse; for a count of a metric's events it is higher."""
    if column.worse:
        return column.worse
    if column.name.endswith("_defined"):
        return "neither"
    if metric.worse == "lower" and column.unit != metric.unit:
        return "higher"
    return metric.worse
