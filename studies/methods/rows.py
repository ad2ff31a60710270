"""One method under one condition: what its runs come to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from analysis.arrays import FloatArray
from analysis.recording.reading import RecordedRun, read_run
from analysis.statistics.intervals import Interval, share_interval
from analysis.study.design import Condition, Study
from analysis.study.runs import StudyRun
from studies.methods.untuned import LEVELS

NEAR_M = 45.0
"""Of an ego, or an ego of a crossing: the distance within which encounters begin [m]."""
EVERY_S = 1.0
"""How often the people near an ego are counted [s]."""


@dataclass(frozen=True, slots=True)
class Row:
    """One method under one condition."""

    method: str
    runs: int
    valid: int
    people_at_once: float | None
    encounters: int
    contacts: int
    """Encounters with a collision."""
    contact_share: Interval | None
    least_ttc: float | None
    short_ttc: int
    """Encounters with TTC < 1.5 s."""
    delay: float | None
    jerk: float | None
    control_ms: float | None
    preventable: int = 0
    """Those whose first collision the careful driver of R157 would have prevented."""
    applies: float | None = None
    """Share of the plans near pedestrians in which the method's condition holds."""
    acts: float | None = None
    """Share of those in which its own plan is driven."""
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


def people_at_once(run: RecordedRun) -> float | None:
    """Return the mean number of pedestrians near an ego that is near a crossing; ``None`` if it never is."""
    egos, others = run.egos.numbers, run.neighbours.numbers
    people = np.flatnonzero(run.neighbours.texts["object_kind"].equal("pedestrian"))
    people = people[np.argsort(others["time_s"][people], kind="stable")]
    times = others["time_s"][people]
    counts = []
    for row in np.flatnonzero(_near_a_crossing(run) & _on_the_second(egos["time_s"])):
        now = egos["time_s"][row]
        here = people[slice(*np.searchsorted(times, (now - 1e-6, now + 1e-6)))]
        away = np.hypot(
            others["x_m"][here] - egos["front_x_m"][row], others["y_m"][here] - egos["front_y_m"][row]
        )
        counts.append(np.count_nonzero(away < NEAR_M))
    return float(np.mean(counts)) if counts else None


def _row(label: str, runs: Sequence[StudyRun]) -> Row:
    valid = [run for run in runs if run.valid]
    encounters, contacts, preventable, short = (
        round(sum(run.numbers[name] for run in valid))
        for name in ("met", "met_collision", "met_preventable", "met_ttc_lt_1p5")
    )
    ttc = np.concatenate([run.samples["min_ttc_s"] for run in valid]) if valid else np.zeros(0)
    recorded = [read_run(run.folder) for run in valid if (run.folder / "neighbours.parquet").exists()]
    return Row(
        method=label,
        runs=len(runs),
        valid=len(valid),
        people_at_once=_mean([people_at_once(run) for run in recorded]),
        encounters=encounters,
        contacts=contacts,
        contact_share=share_interval(contacts, encounters),
        least_ttc=float(ttc.min()) if len(ttc) else None,
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
    """Return the scenario of a condition, and its level of demand as its runs' folders name it."""
    parts = {
        part for run in study.runs if run.condition_id == condition.condition_id for part in run.folder.parts
    }
    levels = [level for level in LEVELS if level in parts]
    return ", ".join(filter(None, [condition.scenario_id, *levels[:1], condition.text]))


def balanced(study: Study) -> Study:
    """Return the part of a study that everybody drove, so that one that was stopped stays comparable.

    It is the conditions and seeds with the most labels.
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
    """Return a share over the plans near pedestrians of all runs, or over those of another share of them."""
    known = [run for run in runs if name in run.numbers and run.numbers.get("n_plans_near_ped")]
    plans = [run.numbers["n_plans_near_ped"] * (run.numbers[of] if of else 1.0) for run in known]
    if not sum(plans):
        return None
    return sum(run.numbers[name] * plan for run, plan in zip(known, plans, strict=True)) / sum(plans)


def _solved(runs: Sequence[StudyRun]) -> float | None:
    plans = sum(run.numbers.get("n_plans", 0.0) for run in runs)
    unsolved = sum(run.numbers.get("n_solver_fail", 0.0) for run in runs)
    return 1.0 - unsolved / plans if plans else None


def _near_a_crossing(run: RecordedRun) -> np.ndarray:
    x, y = run.egos.numbers["front_x_m"], run.egos.numbers["front_y_m"]
    near = np.zeros(len(x), dtype=bool)
    for area in run.crossings():
        for (x0, y0), (x1, y1) in zip(area.shape[:-1], area.shape[1:], strict=True):
            length = max((x1 - x0) ** 2 + (y1 - y0) ** 2, 1e-12)
            share = np.clip(((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / length, 0.0, 1.0)
            near |= np.hypot(x0 + share * (x1 - x0) - x, y0 + share * (y1 - y0) - y) < NEAR_M
    return near


def _on_the_second(times: FloatArray) -> np.ndarray:
    return np.abs(times - EVERY_S * np.round(times / EVERY_S)) < 1e-6


def _per_ego(runs: Sequence[StudyRun], name: str) -> float | None:
    known = [run for run in runs if name in run.numbers]
    egos = sum(run.numbers["ego_count"] for run in known)
    return sum(run.numbers[name] * run.numbers["ego_count"] for run in known) / egos if egos else None


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None
