"""The rows of configs.csv: each configuration's measures over its valid runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from analysis.arrays import FloatArray
from analysis.results.measures import Measure, encounter_measures, run_measures
from analysis.results.origin import SCHEMA_VERSION
from analysis.statistics.intervals import (
    Interval,
    all_equal,
    mean_interval,
    percentile_interval,
    rate_interval,
    rate_upper_bound,
    share_interval,
    share_upper_bound,
)
from analysis.statistics.ratios import contributions
from analysis.statistics.replications import replications_needed
from analysis.study.design import Study
from analysis.study.runs import StudyRun
from analysis.tables.cells import Row

_TAIL = {"lower": ("p05", 5.0), "higher": ("p95", 95.0)}


def parts(measure: Measure, runs: Sequence[StudyRun]) -> tuple[float, float] | None:
    """Return numerator and denominator over some runs; ``None`` if the measure is undefined.

    A value of each run has the denominator 1, so that every measure is a ratio of sums.
    """
    numerator = denominator = 0.0
    for run in runs:
        top = run.numbers.get(measure.numerator)
        bottom = run.numbers.get(measure.denominator) if measure.denominator else 1.0
        if top is None or bottom is None:
            return None
        numerator += float(top > 0.0) if measure.kind == "yes_no" else top
        denominator += bottom / measure.per
    return (numerator, denominator) if denominator > 0.0 else None


def configuration_rows(study: Study) -> Iterator[Row]:
    """Return one row per configuration and measure, in a fixed order."""
    for condition in study.conditions:
        for label in study.all_labels():
            runs = [run for _, run in sorted(study.seeds(label, condition).items())]
            if not runs:
                continue
            valid = [run for run in runs if run.valid]
            for measure in (*run_measures(), *encounter_measures()):
                values = _encounters(measure, valid) if measure.kind == "encounter" else _runs(measure, valid)
                yield {
                    "schema_version": SCHEMA_VERSION,
                    "scenario_id": condition.scenario_id,
                    "condition_id": condition.condition_id,
                    "condition": condition.text or None,
                    "config_id": runs[0].config_id,
                    "controller": runs[0].controller,
                    "configuration": label,
                    **describe(measure),
                    "n_runs": len(runs),
                    "n_valid": len(valid),
                    "denominator_unit": measure.denominator_unit,
                    **values,
                }


def describe(measure: Measure) -> dict[str, Any]:
    """Return the columns that say what is measured."""
    return {
        "metric": measure.name,
        "kind": measure.kind,
        "unit": measure.unit,
        "group": measure.group,
        "key": measure.key,
        "worse": measure.worse,
    }


def _runs(measure: Measure, valid: Sequence[StudyRun]) -> dict[str, Any]:
    found = [both for run in valid if (both := parts(measure, [run])) is not None]
    if not found:
        return _nothing("undefined" if valid else "no_valid_run")
    tops, bottoms = np.array(found).T
    events, exposure = float(tops.sum()), float(bottoms.sum())
    each = contributions(tops, bottoms)
    exact, upper = _exact(measure, events, exposure)
    interval = exact if measure.kind == "yes_no" else mean_interval(each, measure.lowest, measure.highest)
    none_or_all = events == 0.0 or (measure.kind == "share" and events == exposure)
    if interval is None and none_or_all:
        interval = exact  # no run differs from the others, but the next one might
    return {
        "n_defined": len(found),
        "numerator": events,
        "denominator": exposure,
        **_spread(each),
        **_ends("ci", interval),
        **_ends("exact", exact),
        "upper95": upper,
        **_percentiles(tops / bottoms),
        **_needed(each),
        "status": _status(each),
    }


def _encounters(measure: Measure, valid: Sequence[StudyRun]) -> dict[str, Any]:
    groups = [run.samples[measure.name] for run in valid]
    number = sum(len(group) for group in groups)
    if number == 0:
        return _nothing("undefined" if valid else "no_valid_run")
    everybody = int(sum(run.numbers["n_encounters"] for run in valid))
    filled = [group for group in groups if len(group)]
    sums, sizes = (np.array([f(group) for group in filled], dtype=float) for f in (np.sum, len))
    each = contributions(sums, sizes)
    whole = number == everybody
    tail, percent = _TAIL[measure.worse]
    interval = percentile_interval(filled, percent)
    return {
        "n_defined": len(filled),
        "numerator": number,
        "denominator": everybody,
        **(_spread(each) if whole else {}),
        **_ends("ci", mean_interval(each, measure.lowest, measure.highest) if whole else None),
        **_ends("exact", None),
        **_percentiles(np.concatenate(filled)),
        "tail": tail,
        "tail95_lo": None if interval is None else interval.low,
        "tail95_hi": None if interval is None else interval.high,
        **(_needed(each) if whole else {}),
        "status": _status(each) if whole else "partly_defined",
    }


def _nothing(status: str) -> dict[str, Any]:
    return {"n_defined": 0, "ci_method": "none", "exact_method": "none", "status": status}


def _exact(measure: Measure, events: float, exposure: float) -> tuple[Interval | None, float | None]:
    if measure.kind in ("share", "yes_no"):
        return (
            share_interval(round(events), round(exposure)),
            share_upper_bound(round(events), round(exposure)),
        )
    if measure.kind in ("rate", "count"):
        return rate_interval(round(events), exposure), rate_upper_bound(round(events), exposure)
    return None, None


def _spread(each: FloatArray) -> dict[str, Any]:
    deviation = float(np.std(each, ddof=1)) if len(each) > 1 else None
    return {
        "mean": float(np.mean(each)),
        "sd": deviation,
        "sem": None if deviation is None else deviation / float(np.sqrt(len(each))),
    }


def _ends(name: str, interval: Interval | None) -> dict[str, Any]:
    if interval is None:
        return {f"{name}_method": "none"}
    return {
        f"{name}95_lo": interval.low,
        f"{name}95_hi": interval.high,
        f"{name}_method": interval.method,
    }


def _percentiles(values: FloatArray) -> dict[str, Any]:
    names = ("min", "p05", "median", "p95", "max")
    return dict(zip(names, np.percentile(values, (0.0, 5.0, 50.0, 95.0, 100.0)).tolist(), strict=True))


def _needed(each: FloatArray) -> dict[str, Any]:
    """Return how many runs are needed; empty if there is no deviation to compute it from."""
    if len(each) < 2 or all_equal(each):
        return {}
    needed = replications_needed(float(np.mean(each)), float(np.std(each, ddof=1)))
    if needed is None:
        return {}
    more = max(0, needed - len(each))
    return {"n_required_e10pct": needed, "n_more_e10pct": more, "enough_runs": more == 0}


def _status(each: FloatArray) -> str:
    if len(each) == 1:
        return "one_run"
    return "all_equal" if all_equal(each) else "ok"
