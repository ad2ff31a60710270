"""crossings.csv: one row for each crossing of a network, the worst first."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from analysis.arrays import FloatArray
from analysis.encounters.hcm import level_of_service
from analysis.screening.counts import Counts
from analysis.screening.ranking import BY_CONFLICTS, BY_RISK, RANK_BY, Ranking
from analysis.screening.reasons import reasons
from analysis.tables.cells import Row, plain
from analysis.tables.column import Table, at_least_0, count, flag, number, text

WORSE_BELOW = 0.05
"""A crossing counts as worse than the others if its adjusted p is below this."""
VALUES = {BY_RISK: "risk_per_1000_ped", BY_CONFLICTS: "expected_conflicts_per_1000_ped"}
"""The column that each kind of rank follows."""
_HOUR = 3600.0

CROSSINGS = Table(
    "crossings",
    "One row for each crossing of a network, over all seeds; the worst first, those that are not ranked last",
    (
        text("crossing_id", "crossing", required=True),
        number(
            "rank",
            "1",
            "1 for the worst by ranked_by; empty for too few pedestrians",
        ),
        number("rank_lo", "1", "95 % interval of the rank by resampling runs; empty with a single run"),
        number("rank_hi", "1", "upper end"),
        flag("worse", "worse than the other ranked crossings, p_worse below 0.05; empty where not tested"),
        at_least_0("p_worse", "1", "t-test over runs, one-sided, adjusted for false discoveries"),
        text(
            "ranked_by",
            "what rank, its interval and worse follow: risk_per_1000_ped or expected_conflicts_per_1000_ped",
            *RANK_BY,
            required=True,
        ),
        number("rank_by_risk", "1", "rank by risk_per_1000_ped"),
        number("rank_by_conflicts", "1", "rank by expected_conflicts_per_1000_ped"),
        text("reasons", "what is unusual about it, in words"),
        text("crossing_type", "kind", "zebra", "unmarked", "signal"),
        count("lanes", "lanes for cars that it crosses"),
        flag("refuge", "it ends on an island between lanes"),
        at_least_0("length_m", "m", "from kerb to kerb", required=True),
        at_least_0("speed_limit_mps", "m/s", "highest of those lanes"),
        number("x_m", "m", "middle, world frame", required=True),
        number("y_m", "m", "middle, world frame", required=True),
        number("longitude_deg", "deg", "middle, WGS 84; empty without a projection"),
        number("latitude_deg", "deg", "the same"),
        at_least_0("observed_h", "h", "simulated time of all valid runs", required=True),
        at_least_0("pedestrians_per_h", "1/h", "walks over it"),
        at_least_0("vehicles_per_h", "1/h", "motor vehicles over it"),
        at_least_0("cyclists_per_h", "1/h", "bicycles over it"),
        at_least_0("encounters_per_h", "1/h", "encounters of motor vehicles and pedestrians"),
        at_least_0("entered_per_h", "1/h", "of them those in which the pedestrian did more than wait"),
        count("n_conflicts", "encounters of severity serious or worse", required=True),
        count("n_severe", "of them severe or a collision", required=True),
        count("n_collisions", "of them collisions", required=True),
        at_least_0("conflicts_per_h", "1/h", "conflicts"),
        at_least_0("conflicts_per_1000_ped", "1", "conflicts; empty without pedestrians"),
        at_least_0("expected_conflicts_per_1000_ped", "1", "the same by empirical Bayes"),
        at_least_0(
            "risk_per_1000_ped",
            "1",
            "expected conflicts times p_fatal_expected; empty where no speed is known at any crossing",
        ),
        at_least_0(
            "p_fatal_expected",
            "1",
            "mean of p_fatal_mean of this crossing and of all, by the credibility of its encounters",
        ),
        at_least_0(
            "p_fatal_mean",
            "1",
            "mean probability of death at the conflicting speeds of encounters that were entered, by "
            "[RosenSander2009]",
        ),
        at_least_0("ttc_p05_s", "s", "5th percentile of the smallest TTC of encounters that were entered"),
        at_least_0("ttc_median_s", "s", "median of it"),
        at_least_0("pet_p05_s", "s", "5th percentile of their PET"),
        at_least_0("pet_median_s", "s", "median of it"),
        at_least_0("vehicle_speed_mean_mps", "m/s", "mean speed of motor vehicles there"),
        at_least_0("vehicle_speed_p85_mps", "m/s", "85th percentile of it, mean over runs"),
        at_least_0("yield_rate", "1", "of the vehicles that could yield"),
        at_least_0("late_entry_share", "1", "entries inside the vehicle's comfortable stopping distance"),
        at_least_0("red_light_share", "1", "pedestrians who began on red"),
        at_least_0(
            "hidden_share", "1", "conflicts before which another vehicle hid the pedestrian from the driver"
        ),
        at_least_0("ped_delay_mean_s", "s", "mean delay of pedestrians"),
        text("ped_los_hcm2010", "level of service by mean delay", "A", "B", "C", "D", "E", "F"),
        count("n_cyclist_encounters", "encounters of bicycles and pedestrians, counted nowhere else"),
        count("n_cyclist_conflicts", "of them conflicts"),
    ),
    ("crossing_id",),
)
_FACTS: Mapping[str, Callable[[str], Any]] = {
    "lanes": int,
    "refuge": lambda cell: cell == "1",
    **dict.fromkeys(("length_m", "speed_limit_mps", "x_m", "y_m", "longitude_deg", "latitude_deg"), float),
}


def value_column(rows: Sequence[Row]) -> str:
    """Return the column that ranks follow; conflicts if no speed is known at any crossing."""
    named = {VALUES[row["ranked_by"]] for row in rows} - {VALUES[BY_CONFLICTS]}
    known = [name for name in named if any(row[name] is not None for row in rows)]
    return known[0] if known else VALUES[BY_CONFLICTS]


def crossing_rows(counts: Counts, ranking: Ranking) -> list[Row]:
    """Return the rows of crossings.csv."""
    hours = counts.total("observed_s") / _HOUR
    pedestrians, conflicts = counts.total("n_pedestrians"), counts.total("conflicts")
    delay = _ratio(counts.total("ped_delay_sum_s"), counts.total("n_ped_delay_defined"))
    measured: dict[str, FloatArray] = {
        "rank": ranking.rank,
        "rank_lo": ranking.rank_low,
        "rank_hi": ranking.rank_high,
        "p_worse": ranking.p_worse,
        **{f"rank_by_{name}": ranking.ranks[name] for name in RANK_BY},
        "observed_h": hours,
        "pedestrians_per_h": _ratio(pedestrians, hours),
        "vehicles_per_h": _ratio(counts.total("n_vehicles"), hours),
        "cyclists_per_h": _ratio(counts.total("n_cyclists"), hours),
        "encounters_per_h": _ratio(counts.total("encounters"), hours),
        "entered_per_h": _ratio(counts.total("entered"), hours),
        "n_conflicts": conflicts,
        "n_severe": counts.total("severe"),
        "n_collisions": counts.total("collisions"),
        "conflicts_per_h": _ratio(conflicts, hours),
        "conflicts_per_1000_ped": 1000.0 * _ratio(conflicts, pedestrians),
        "expected_conflicts_per_1000_ped": 1000.0 * ranking.rate,
        "risk_per_1000_ped": 1000.0 * ranking.rate * ranking.p_fatal,
        "p_fatal_expected": ranking.p_fatal,
        "p_fatal_mean": _ratio(counts.total("p_fatal_sum"), counts.total("n_p_fatal_defined")),
        "ttc_p05_s": _percentiles(counts.ttc, 5.0),
        "ttc_median_s": _percentiles(counts.ttc, 50.0),
        "pet_p05_s": _percentiles(counts.pet, 5.0),
        "pet_median_s": _percentiles(counts.pet, 50.0),
        **counts.speeds,
        "yield_rate": _ratio(counts.total("yields"), counts.total("yieldable")),
        "late_entry_share": _ratio(counts.total("late"), counts.total("late_defined")),
        "red_light_share": _ratio(counts.total("n_red_light_walkers"), pedestrians),
        "hidden_share": _ratio(counts.total("hidden"), conflicts),
        "ped_delay_mean_s": delay,
        "n_cyclist_encounters": counts.total("cyclist_encounters"),
        "n_cyclist_conflicts": counts.total("cyclist_conflicts"),
    }
    told = reasons(_compared(counts, measured), np.flatnonzero(np.isfinite(ranking.rank)).tolist())
    rows = []
    for i, known in enumerate(counts.crossings):
        own = {name: values[i] for name, values in measured.items()}
        verdict = {
            "ranked_by": ranking.by,
            "reasons": told[i],
            **_verdict(float(ranking.p_worse[i]), float(delay[i])),
        }
        rows.append(plain(CROSSINGS, {**_facts(known), **own, **verdict}))
    return sorted(rows, key=lambda row: (row["rank"] is None, row["rank"] or 0.0, row["crossing_id"]))


def _compared(counts: Counts, measured: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    return {
        "speed": measured["vehicle_speed_p85_mps"],
        "vehicles": measured["vehicles_per_h"],
        "pedestrians": measured["pedestrians_per_h"],
        "yields": measured["yield_rate"],
        "late": measured["late_entry_share"],
        "red": measured["red_light_share"],
        "hidden": measured["hidden_share"],
        "length": np.array([float(cells["length_m"]) for cells in counts.crossings]),
    }


def _verdict(p: float, delay: float) -> dict[str, Any]:
    return {
        "worse": p < WORSE_BELOW if np.isfinite(p) else None,
        "ped_los_hcm2010": level_of_service(delay) if np.isfinite(delay) else None,
    }


def _facts(cells: Mapping[str, str]) -> dict[str, Any]:
    known = {name: kind(cells[name]) for name, kind in _FACTS.items() if cells[name]}
    return {"crossing_id": cells["crossing_id"], "crossing_type": cells["crossing_type"], **known}


def _ratio(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    """Return the quotient, nan where the denominator is 0."""
    nothing = np.full(len(numerator), np.nan)
    return np.asarray(np.divide(numerator, denominator, out=nothing, where=denominator > 0.0))


def _percentiles(values: Sequence[FloatArray], share: float) -> FloatArray:
    return np.array([np.percentile(some, share) if len(some) else np.nan for some in values])
