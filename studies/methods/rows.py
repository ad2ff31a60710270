"""The results of one method under one condition."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from analysis.statistics.intervals import Interval, share_interval
from analysis.study.design import Condition, Study
from analysis.study.runs import StudyRun
from studies.methods.table import LEAST_TTC, PEOPLE
from studies.methods.untuned import LEVELS


@dataclass(frozen=True, slots=True)
class Row:
    """One method under one condition."""

    method: str
    runs: int
    valid: int
    people_at_once: float | None
    encounters: int
    contacts: int
    """Number of encounters with a collision."""
    contact_share: Interval | None
    least_ttc: float | None
    short_ttc: int
    """Number of encounters with TTC < 1.5 s."""
    delay: float | None
    jerk: float | None
    control_ms: float | None
    preventable: int = 0
    """Number of contacts whose first collision the careful driver of R157 would have prevented."""
    applies: float | None = None
    """Share of the plans near pedestrians in which the method's condition holds."""
    acts: float | None = None
    """Share of those plans in which its own plan is driven."""
    overridden: float | None = None
    """Share of the plans near pedestrians in which braking or a fallback overrides it."""
    solved: float | None = None
    """Share of all plans that were solved."""


def rows(study: Study, condition: Condition) -> list[Row]:
    """Return one row for each controller that was run under a condition."""
    found = []
    for label in study.all_labels():
        runs = [run for _, run in sorted(study.seeds(label, condition).items())]
        if runs:
            found.append(_row(label, runs))
    return found


def _row(label: str, runs: Sequence[StudyRun]) -> Row:
    valid = [run for run in runs if run.valid]
    encounters, contacts, preventable, short = (
        round(sum(run.numbers[name] for run in valid))
        for name in ("met", "met_collision", "met_preventable", "met_ttc_lt_1p5")
    )
    return Row(
        method=label,
        runs=len(runs),
        valid=len(valid),
        people_at_once=_mean([run.numbers.get(PEOPLE) for run in valid]),
        encounters=encounters,
        contacts=contacts,
        contact_share=share_interval(contacts, encounters),
        least_ttc=min((run.numbers[LEAST_TTC] for run in valid if LEAST_TTC in run.numbers), default=None),
        short_ttc=short,
        delay=_per_ego(valid, "ego_delay_mean_s"),
        jerk=_mean([run.numbers.get("p95_abs_jerk_mps3") for run in valid]),
        control_ms=_mean([run.numbers.get("compute_p95_ms") for run in valid]),
        preventable=preventable,
        applies=_near(valid, "method_applies_share"),
        acts=_near(valid, "method_acts_where_applies_share", "method_applies_share"),
        overridden=_near(valid, "method_overridden_share"),
        solved=_solved(valid),
    )


def title(study: Study, condition: Condition) -> str:
    """Return the scenario of a condition and its level of demand, taken from the folders of its runs."""
    parts = {
        part for run in study.runs if run.condition_id == condition.condition_id for part in run.folder.parts
    }
    levels = [level for level in LEVELS if level in parts]
    return ", ".join(filter(None, [condition.scenario_id, *levels[:1], condition.text]))


def balanced(study: Study) -> Study:
    """Return the part of a study that all methods drove, so that a stopped study remains comparable.

    It consists of the conditions and seeds with the most labels.
    """
    drivers: dict[tuple[str, int], set[str]] = {}
    for run in study.runs:
        drivers.setdefault((run.condition_id, run.seed), set()).add(study.label(run))
    most = max(map(len, drivers.values()), default=0)
    runs = tuple(run for run in study.runs if len(drivers[run.condition_id, run.seed]) == most)
    left = {run.condition_id for run in runs}
    conditions = tuple(one for one in study.conditions if one.condition_id in left)
    return replace(study, runs=runs, conditions=conditions)


def pooled(study: Study, label: str) -> Row:
    """Return one row for a label over all its runs."""
    return _row(label, [run for run in study.runs if study.label(run) == label])


def _near(runs: Sequence[StudyRun], name: str, of: str = "") -> float | None:
    """Return a share over all runs' plans near pedestrians, or over the share ``of`` of these plans."""
    known = [run for run in runs if name in run.numbers and run.numbers.get("n_plans_near_ped")]
    plans = [run.numbers["n_plans_near_ped"] * (run.numbers[of] if of else 1.0) for run in known]
    if not sum(plans):
        return None
    return sum(run.numbers[name] * plan for run, plan in zip(known, plans, strict=True)) / sum(plans)


def _solved(runs: Sequence[StudyRun]) -> float | None:
    plans = sum(run.numbers.get("n_plans", 0.0) for run in runs)
    unsolved = sum(run.numbers.get("n_solver_fail", 0.0) for run in runs)
    return 1.0 - unsolved / plans if plans else None


def _per_ego(runs: Sequence[StudyRun], name: str) -> float | None:
    known = [run for run in runs if name in run.numbers]
    egos = sum(run.numbers["ego_count"] for run in known)
    return sum(run.numbers[name] * run.numbers["ego_count"] for run in known) / egos if egos else None


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None
