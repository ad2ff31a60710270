"""The rows of comparisons.csv: an alternative compared with a base on the same seeds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np

from analysis.results.measures import Measure, run_measures
from analysis.results.origin import SCHEMA_VERSION
from analysis.statistics.paired import Comparison, compare_values, compare_yes_no, holm
from analysis.statistics.ratios import contributions
from analysis.statistics.replications import replications_needed
from analysis.study.configuration_rows import describe, parts
from analysis.study.design import Condition, Study
from analysis.study.runs import StudyRun
from analysis.tables.cells import Row

SIGNIFICANT = 0.05
ALL = "all"
"""The condition_id for all conditions of a scenario together."""


@dataclass(frozen=True, slots=True)
class Pairs:
    """Runs of a base and an alternative: for each seed, one run of each per condition."""

    base: tuple[tuple[StudyRun, ...], ...]
    alt: tuple[tuple[StudyRun, ...], ...]
    unpaired: int
    """Number of seeds with a run on one side only, or not under every condition."""
    invalid: int
    """Number of seeds lost because a run was not valid."""


def pair_runs(study: Study, conditions: Sequence[Condition], base: str, alt: str) -> Pairs:
    """Pair the valid runs of two labels by seed, over one condition or several.

    Under several conditions, a seed counts once with all its runs, because its results under different
    conditions are not independent.
    """
    if not conditions:
        return Pairs((), (), 0, 0)
    sides = [[study.seeds(label, one) for one in conditions] for label in (base, alt)]
    everywhere = [set.intersection(*(set(runs) for runs in side)) for side in sides]
    anywhere = [set.union(*(set(runs) for runs in side)) for side in sides]
    common = sorted(everywhere[0] & everywhere[1])
    rows = [tuple(tuple(runs[seed] for runs in side) for side in sides) for seed in common]
    kept = [row for row in rows if all(run.valid for side in row for run in side)]
    return Pairs(
        base=tuple(row[0] for row in kept),
        alt=tuple(row[1] for row in kept),
        unpaired=len((anywhere[0] | anywhere[1]) - set(common)),
        invalid=len(rows) - len(kept),
    )


def comparison_rows(study: Study, baseline: str | None) -> Iterator[Row]:
    """Return one row per condition, pair of labels and measure, in a fixed order.

    For a scenario with several conditions, the rows over all of them come last. The tests of one condition
    over all measures and alternatives are corrected together: the key measures as one family, and all other
    measures as another.
    """
    labels = study.pairs_of_labels(baseline)
    for _, group in groupby(study.conditions, key=lambda one: one.scenario_id):
        conditions = list(group)
        for scope in [[one] for one in conditions] + [conditions] * (len(conditions) > 1):
            rows = [
                row
                for base, alt in labels
                if len(scope) == 1 or len(shared_conditions(study, scope, base, alt)) > 1
                for row in compare_labels(study, scope, base, alt, run_measures())
            ]
            for family in ("key", "other"):
                correct([row for row in rows if row["key"] == (family == "key")], family)
            yield from rows


def shared_conditions(study: Study, conditions: Sequence[Condition], base: str, alt: str) -> list[Condition]:
    """Return the conditions under which both labels were run."""
    return [one for one in conditions if study.seeds(base, one) and study.seeds(alt, one)]


def compare_labels(
    study: Study, conditions: Sequence[Condition], base: str, alt: str, measures: Sequence[Measure]
) -> list[dict[str, Any]]:
    """Return the rows of an alternative compared with a base, without correction and verdict.

    The conditions belong to one scenario. Conditions under which one of the two was never run are left out;
    if none remain, there are no rows.
    """
    shared = shared_conditions(study, conditions, base, alt)
    if not shared:
        return []
    pairs = pair_runs(study, shared, base, alt)
    several = len(shared) > 1
    where = {
        "schema_version": SCHEMA_VERSION,
        "scenario_id": shared[0].scenario_id,
        "condition_id": ALL if several else shared[0].condition_id,
        "condition": (f"all {len(shared)} conditions" if several else shared[0].text) or None,
        "base": base,
        "alt": alt,
    }
    return [{**where, **describe(one), **_compared(one, pairs)} for one in measures]


def correct(rows: Sequence[dict[str, Any]], family: str) -> None:
    """Correct the p values of a family of rows together, and set the verdict of each."""
    corrected = holm([row["p_value"] for row in rows])
    number = sum(p is not None for p in corrected)
    for row, p in zip(rows, corrected, strict=True):
        row["p_holm"] = p
        row["family"], row["n_family"] = family, number
        row["significant_05"] = None if p is None else p < SIGNIFICANT
        row["verdict"] = _verdict(row)


def _compared(measure: Measure, pairs: Pairs) -> dict[str, Any]:
    found = [
        (one, other)
        for base, alt in zip(pairs.base, pairs.alt, strict=True)
        if (one := parts(measure, base)) is not None and (other := parts(measure, alt)) is not None
    ]
    result = _tested(measure, found, several=bool(pairs.base) and len(pairs.base[0]) > 1)
    interval, base_mean, difference = result.interval, result.base_mean, result.difference
    return {
        "n_pairs": result.pairs,
        "n_unpaired": pairs.unpaired,
        "n_invalid": pairs.invalid,
        "n_undefined": len(pairs.base) - result.pairs,
        "base_mean": base_mean,
        "alt_mean": result.alt_mean,
        "diff_mean": difference,
        "diff_pct": None if difference is None or not base_mean else 100.0 * difference / abs(base_mean),
        "sd_diff": result.deviation,
        "n_required_d10pct": _seeds_needed(base_mean, result.deviation),
        "ci95_lo": None if interval is None else interval.low,
        "ci95_hi": None if interval is None else interval.high,
        "ci_method": "none" if interval is None else interval.method,
        "pair_corr": result.correlation,
        "test": result.test,
        "statistic": result.statistic,
        "p_value": result.p_value,
        "effect_size": result.effect_size,
        "effect": result.effect or None,
        "status": result.status,
    }


def _tested(
    measure: Measure, found: Sequence[tuple[tuple[float, float], tuple[float, float]]], several: bool
) -> Comparison:
    if not found:
        return Comparison(0, status="no_pairs")
    base, alt = (contributions(*np.array([pair[side] for pair in found]).T) for side in (0, 1))
    # Over several conditions, a seed has a share of runs with a yes instead of a yes or no.
    if measure.kind == "yes_no" and not several:
        return compare_yes_no(base, alt)
    return compare_values(base, alt)


def _seeds_needed(base_mean: float | None, deviation: float | None) -> int | None:
    """Return how many seeds give the difference to 10 % of the base's mean; ``None`` if it is not known."""
    if base_mean is None or not deviation:
        return None
    return replications_needed(base_mean, deviation)


def moved(row: Row) -> str:
    """Return whether a mean got ``higher`` or ``lower``; empty if it did not, or if the interval holds 0.

    Ranks may move the other way than the mean, so a small p is not enough.
    """
    difference, low, high = row["diff_mean"], row["ci95_lo"], row["ci95_hi"]
    if not difference or (low is not None and low <= 0.0 <= high):
        return ""
    return "higher" if difference > 0.0 else "lower"


def _verdict(row: Row) -> str:
    """Return the verdict; a difference needs a corrected p below 0.05, and an interval that agrees."""
    direction = moved(row)
    if not row["significant_05"] or not direction:
        return "no_difference_shown"
    if row["worse"] == "neither":
        return direction
    return "worse" if direction == row["worse"] else "better"
