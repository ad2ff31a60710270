"""Judges finished runs by criteria, with one finding for each thing judged."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analysis.criteria.criterion import Cells, Criterion, chosen_rows, judge, row_value, statistic_value
from analysis.criteria.culprit import OF_ALL_STEPS, culprit, of_row
from analysis.criteria.culprit_alone import ALONE, of_ego
from analysis.criteria.culprit_vehicle import CLOSE, of_conflict
from analysis.files import read_csv
from analysis.results.overlap_rows import VEHICLE_OVERLAPS
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.results.vehicle_conflict_rows import VEHICLE_CONFLICTS
from cosim.checks.finding import Finding

if TYPE_CHECKING:
    from cosim.suites.judging import Case, Verdict

MOST_SEEDS = 10
"""Largest number of seeds that a note names."""

Statistics = Mapping[tuple[str, str, str], Cells]
"""Rows of configs.csv by config_id, measure and kind."""


@dataclass(frozen=True, slots=True)
class Made:
    """Outcome of a run."""

    seed: int
    command: str
    """Command that makes the run again."""
    folder: Path | None
    """Folder of a run that went to its end; ``None`` for other runs."""
    place: str
    """Folder relative to that of the check."""
    reason: str
    """Why the run is not valid; empty for a valid run."""
    description: Mapping[str, Any]


def judged_statistic(
    origin: Finding, criterion: Criterion, made: Sequence[Made], statistics: Statistics
) -> Finding:
    """Return the finding on a configuration over all its runs."""
    about = _about(origin, criterion)
    valid = [run for run in made if not run.reason]
    about = replace(about, n_runs=len(valid))
    if len(valid) < len(made):
        first = next(run for run in made if run.reason)
        lost = f"{len(made) - len(valid)} of {len(made)} runs are not valid, for instance seed "
        return replace(about, status="invalid", note=f"{lost}{first.seed}: {first.reason}")
    config_id = str(valid[0].description["config_id"])
    row = statistics[config_id, criterion.metric, criterion.kind]
    found = judge(criterion, statistic_value(criterion, row))
    note = "" if found.value is not None else f"{row['status']}, {row['n_defined']} runs have a value; "
    seeds = ", ".join(str(run.seed) for run in made[:MOST_SEEDS])
    note += f"over {len(made)} runs, seeds {seeds}" + (", …" if len(made) > MOST_SEEDS else "")
    return replace(
        about,
        status=found.status,
        value=found.value,
        margin=found.margin,
        counts=not (found.status == "undefined" and criterion.allow_undefined),
        note=note,
    )


def _about(origin: Finding, criterion: Criterion) -> Finding:
    return replace(
        origin,
        scope=criterion.scope,
        criterion_id=criterion.id,
        metric=criterion.metric,
        statistic=criterion.statistic or None,
        unit=criterion.unit,
        operator=criterion.operator,
        threshold=criterion.threshold,
    )


def of_run(about: Finding, run: Made) -> Finding:
    return replace(about, seed=run.seed, run=run.place or None, command=run.command)


def validity(origin: Finding, run: Made) -> Finding:
    return replace(of_run(origin, run), status="invalid" if run.reason else "pass", note=run.reason or None)


def judged_rows(origin: Finding, criterion: Criterion, run: Made) -> Iterator[Finding]:
    """Return a finding for each row that is judged, or a single one that says why there is no row."""
    about = of_run(_about(origin, criterion), run)
    if run.reason or run.folder is None:
        yield replace(about, status="invalid", note=run.reason)
        return
    table = ENCOUNTERS if criterion.scope == "encounter" else RUNS
    rows = chosen_rows(criterion, read_csv(run.folder / table.file))
    of_encounters = criterion.scope == "encounter"
    counts = not criterion.allow_undefined
    if not rows:
        yield replace(about, status="undefined", counts=counts, note=f"no {criterion.scope} to judge")
    for row in rows:
        found = judge(criterion, row_value(criterion, row))
        judged = replace(
            about,
            status=found.status,
            value=found.value,
            margin=found.margin,
            counts=counts or found.status != "undefined",
        )
        yield _of_encounter(judged, row) if of_encounters else with_culprit(judged, run.folder, row)


def _of_encounter(judged: Finding, row: Cells) -> Finding:
    found = replace(
        judged,
        encounter_id=int(row["encounter_id"]),
        ego_id=row["ego_id"],
        ped_id=row["ped_id"],
        t_start_s=float(row["t_start_s"]),
    )
    if judged.status != "fail":
        return found
    worst = of_row(judged.metric, row)
    return replace(found, moment_s=worst.moment_s, place=worst.place)


def with_culprit(judged: Finding, folder: Path, run: Cells) -> Finding:
    """Return the finding on a run; if it failed, add the road users, time and place.

    Parameters
    ----------
    judged : finding on the run
    folder : folder of the run
    run : row of the run in runs.csv
    """
    if judged.status != "fail":
        return judged
    if judged.metric in (*ALONE, *CLOSE):
        if judged.metric in CLOSE:
            alone = of_conflict(judged.metric, read_csv(folder / VEHICLE_CONFLICTS.file))
        else:
            alone = of_ego(judged.metric, run, read_csv(folder / VEHICLE_OVERLAPS.file))
        return judged if alone is None else replace(judged, **asdict(alone))
    rows = read_csv(folder / ENCOUNTERS.file)
    worst = culprit(judged.metric, rows)
    if worst is None:
        return judged
    row = next(row for row in rows if int(row["encounter_id"]) == worst.encounter_id)
    told_by = OF_ALL_STEPS.get(judged.metric)
    if told_by is not None and row[told_by] != run[judged.metric]:
        return judged
    return replace(_of_encounter(judged, row), moment_s=worst.moment_s, place=worst.place)


def about_case(origin: Finding, case: Case, run: Made) -> Finding:
    """Return the finding on a run of a test protocol, still without its verdict."""
    return replace(
        of_run(origin, run),
        scope="case",
        criterion_id=f"protocol {case.name}",
        metric="impact_speed_kmh",
        unit="km/h",
    )


def with_verdict(about: Finding, case: Case, verdict: Verdict) -> Finding:
    """Return the finding with the verdict of a protocol; impacts that could not be prevented do not count."""
    notes = [f"expected {case.group.rule.replace('_', ' ')}", verdict.note]
    limit, speed = case.highest_impact_kmh, verdict.impact_speed_kmh
    if limit is not None:
        about = replace(
            about, operator="<=", threshold=limit, margin=None if speed is None else limit - speed
        )
        notes = [verdict.note]
    if not verdict.passed and not verdict.counts:
        notes.append("not preventable, so it does not count")
    return replace(
        about,
        status="pass" if verdict.passed else "fail",
        counts=verdict.passed or verdict.counts,
        value=speed,
        colour=verdict.colour or None,
        points=verdict.points,
        note="; ".join(filter(None, notes)) or None,
    )
