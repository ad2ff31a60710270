"""Finds what an alternative changes at each crossing and in the whole network, on the same seeds."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import false_discovery_control, ttest_1samp

from analysis.arrays import BoolArray, FloatArray
from analysis.errors import StudyError
from analysis.screening.counts import Counts
from analysis.statistics.intervals import LEVEL
from analysis.statistics.ratios import contributions
from analysis.tables.cells import Row, plain
from analysis.tables.column import Table, at_least_0, count, flag, number, text

TOTAL = "total"
"""The ``crossing_id`` for all crossings together."""
CHANGED_BELOW = 0.05
"""A difference counts as a change if its adjusted p is below this."""


OBSERVED = "observed_s"


@dataclass(frozen=True, slots=True)
class Measure:
    """A ratio of sums over runs."""

    name: str
    unit: str
    numerator: str
    """Name in ``Counts.each``; the denominator likewise."""
    denominator: str
    factor: float = 1.0


MEASURES = (
    Measure("conflicts_per_1000_ped", "1", "conflicts", "n_pedestrians", 1000.0),
    Measure("conflicts_per_h", "1/h", "conflicts", OBSERVED, 3600.0),
    Measure("p_fatal_mean", "1", "p_fatal_sum", "n_p_fatal_defined"),
    Measure("severe_per_h", "1/h", "severe", OBSERVED, 3600.0),
    Measure("pedestrians_per_h", "1/h", "n_pedestrians", OBSERVED, 3600.0),
    Measure("vehicles_per_h", "1/h", "n_vehicles", OBSERVED, 3600.0),
    Measure("vehicle_speed_mean_mps", "m/s", "vehicle_speed_sum_mps", "n_vehicles"),
    Measure("yield_rate", "1", "yields", "yieldable"),
    Measure("ped_delay_mean_s", "s", "ped_delay_sum_s", "n_ped_delay_defined"),
)
EXPOSURE = ("pedestrians_per_h", "vehicles_per_h")
"""Measures of how many road users are there."""

CHANGES = Table(
    "crossing_changes",
    "One row for each crossing and measure: an alternative against the base, paired by seed",
    (
        text("crossing_id", f"crossing; {TOTAL}: all crossings of the network together", required=True),
        text("metric", "measure, as in crossings.csv", *(one.name for one in MEASURES), required=True),
        text("unit", "its unit", required=True),
        number("base_mean", "", "of the base, over the seeds that both have"),
        number("alt_mean", "", "of the alternative, the same"),
        number("diff_mean", "", "alternative minus base"),
        number("diff_pct", "%", "the same in percent of the base"),
        number("ci95_lo", "", "95 % interval of the difference, by Student's t over seeds"),
        number("ci95_hi", "", "upper end"),
        count("n_pairs", "seeds that both have", required=True),
        at_least_0("p_value", "1", "of no difference, two-sided t-test over seeds"),
        at_least_0("p_fdr", "1", "adjusted for false discoveries over the crossings; not for the total"),
        flag("changed", "p_fdr below 0.05, for the total p_value; empty without a test"),
        text(
            "status",
            "why there is no difference, interval or test",
            *("ok", "one_pair", "no_difference", "constant_difference"),
            *("undefined", "only_in_base", "only_in_alt"),
            required=True,
        ),
    ),
    ("crossing_id", "metric"),
)


def change_rows(base: Counts, alt: Counts) -> list[Row]:
    """Return the rows of crossing_changes.csv, the total first.

    Crossings are the same if their ids are. A crossing that only one side has is listed with that side's
    values. Rates are ratios of sums over runs and are compared by each run's contribution to them.

    Raises
    ------
    StudyError
        If they have no seed or no crossing in common.
    """
    seeds = sorted({*base.seeds} & {*alt.seeds})
    if not seeds:
        raise StudyError("base and alternative have no valid seed in common")
    known = [{cells["crossing_id"] for cells in one.crossings} for one in (base, alt)]
    if not known[0] & known[1]:
        few = [", ".join(sorted(names)[:3]) for names in known]
        raise StudyError(f"no crossing in common: {few[0]} in the base, {few[1]} in the alternative")
    names = sorted(known[0] | known[1])
    sides = [_sums(one, seeds, names) for one in (base, alt)]
    status = ["", *(_only_in(name, *known) for name in names)]
    found = [_rows([TOTAL, *names], status, one, *sides) for one in MEASURES]
    return [rows[0] for rows in found] + [row for rows in found for row in rows[1:]]


def _only_in(name: str, base: Collection[str], alt: Collection[str]) -> str:
    if name not in base:
        return "only_in_alt"
    return "" if name in alt else "only_in_base"


def _sums(counts: Counts, seeds: Sequence[int], names: Sequence[str]) -> Mapping[str, FloatArray]:
    """Return the counts of all crossings and of each, shape (1 + crossings, seeds); nan if it is missing."""
    columns = [counts.seeds.index(seed) for seed in seeds]
    row = {cells["crossing_id"]: number for number, cells in enumerate(counts.crossings)}
    here = [number for number, name in enumerate(names, 1) if name in row]
    found = {}
    for kind, values in counts.each.items():
        each = values[:, columns]
        sums = np.full((1 + len(names), len(seeds)), np.nan)
        # All crossings are observed for the same time.
        sums[0] = each.max(axis=0) if kind == OBSERVED else each.sum(axis=0)
        sums[here] = each[[row[names[number - 1]] for number in here]]
        found[kind] = sums
    return found


def _rows(
    names: Sequence[str],
    alone: Sequence[str],
    measure: Measure,
    base: Mapping[str, FloatArray],
    alt: Mapping[str, FloatArray],
) -> list[Row]:
    """Return the rows of one measure; only the crossings, not the total, are tested together."""
    sides = [
        measure.factor * _contributions(one[measure.numerator], one[measure.denominator])
        for one in (base, alt)
    ]
    means = [values.mean(axis=1) for values in sides]
    differences = sides[1] - sides[0]
    pairs, size = differences.shape[1], np.maximum(*np.abs(np.nan_to_num(means)))
    varies = np.ptp(differences, axis=1) > 1e-12 * size
    p, low, high = _tested(differences, varies)
    adjusted = p.copy()
    if (tested := np.isfinite(p[1:])).any():
        adjusted[1:][tested] = false_discovery_control(p[1:][tested])
    rows: list[Row] = []
    for i, name in enumerate(names):
        before, difference = float(means[0][i]), float(differences[i].mean())
        row = {
            "crossing_id": name,
            "metric": measure.name,
            "unit": measure.unit,
            "base_mean": before,
            "alt_mean": means[1][i],
            "diff_mean": difference,
            "diff_pct": 100.0 * difference / before if before else None,
            "ci95_lo": low[i],
            "ci95_hi": high[i],
            "n_pairs": pairs,
            "p_value": p[i],
            "p_fdr": adjusted[i] if name != TOTAL else None,
            "changed": adjusted[i] < CHANGED_BELOW if np.isfinite(adjusted[i]) else None,
            "status": alone[i] or _status(difference, size[i], bool(varies[i]), pairs),
        }
        rows.append(plain(CHANGES, row))
    return rows


def _contributions(numerators: FloatArray, denominators: FloatArray) -> FloatArray:
    """Return what each run contributes to the ratio of each row; nan if the denominator is 0."""
    defined = np.nan_to_num(denominators).sum(axis=1) > 0.0
    found = np.full(numerators.shape, np.nan)
    for i in np.flatnonzero(defined):
        found[i] = contributions(numerators[i], denominators[i])
    return found


def _tested(differences: FloatArray, varies: BoolArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the p of the t-test over runs, and the interval of the mean; nan if there is none."""
    p, low, high = (np.full(len(differences), np.nan) for _ in range(3))
    if differences.shape[1] > 1 and varies.any():
        test = ttest_1samp(differences[varies], 0.0, axis=1)
        p[varies] = test.pvalue
        low[varies], high[varies] = test.confidence_interval(LEVEL)
    return p, low, high


def _status(difference: float, size: float, varies: bool, pairs: int) -> str:
    if not np.isfinite(difference):
        return "undefined"
    if pairs == 1:
        return "one_pair"
    if varies:
        return "ok"
    return "no_difference" if abs(difference) <= 1e-12 * size else "constant_difference"
