"""Tests whether a measure has got worse than in a baseline: the same runs then and now, paired by seed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from analysis.results.measures import Measure
from analysis.statistics.paired import holm
from analysis.study.comparison_rows import compare_labels, moved
from analysis.study.design import Condition, Study
from analysis.study.runs import StudyRun

THEN, NOW = "baseline", "now"


@dataclass(frozen=True, slots=True)
class Pairing:
    """Runs of one configuration then and now, in any order."""

    then: Sequence[StudyRun]
    now: Sequence[StudyRun]


def regression_rows(
    pairings: Sequence[Pairing], measures: Sequence[Measure], level: float
) -> list[list[dict[str, Any]]]:
    """Return a row of comparison for each pairing and measure, with ``p_holm`` and ``worse_now``.

    The p values of all pairings and measures are corrected together. A measure is worse when its
    corrected p is below the level, its mean has moved in the direction that is worse, and the interval of
    the difference, if there is one, does not hold 0: ranks may move the other way than the mean.

    Parameters
    ----------
    pairings
        One for each configuration.
    measures
        Measures to compare; those without a bad direction are left out.
    level
        Probability of calling anything worse although nothing has changed, over the whole family.
    """
    judged = [one for one in measures if one.worse != "neither"]
    groups = [_compared(one, judged) for one in pairings]
    rows = [row for group in groups for row in group]
    corrected = holm([row["p_value"] for row in rows])
    number = sum(p is not None for p in corrected)
    for row, p in zip(rows, corrected, strict=True):
        row["p_holm"], row["n_family"] = p, number
        row["worse_now"] = p is not None and p < level and moved(row) == row["worse"]
    return groups


def _compared(pairing: Pairing, measures: Sequence[Measure]) -> list[dict[str, Any]]:
    condition = Condition(THEN, "", "")
    runs = tuple(
        replace(run, config_id=label, condition_id=condition.condition_id)
        for label, side in ((THEN, pairing.then), (NOW, pairing.now))
        for run in side
    )
    study = Study(runs, (condition,), {THEN: THEN, NOW: NOW})
    return compare_labels(study, [condition], THEN, NOW, measures)
