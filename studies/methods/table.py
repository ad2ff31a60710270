"""The table from which a page of the methods is made: one row for each run.

It is published beside the page. In this way, runs from one machine can be added to runs from another, and
readers can check the numbers of the page.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from analysis.errors import StudyError
from analysis.files import read_csv, read_json, write_csv
from analysis.recording.reading import read_run
from analysis.study.design import read_study
from analysis.study.runs import StudyRun
from studies.finished import run_folders
from studies.methods.people import people_at_once

PEOPLE, LEAST_TTC = "people_at_once", "least_ttc_s"
"""Numbers of a run in addition to those of runs.csv and the tallies of its encounters."""
NUMBERS = (
    "ego_count",
    "met",
    "met_collision",
    "met_preventable",
    "met_ttc_lt_1p5",
    "ego_delay_mean_s",
    "p95_abs_jerk_mps3",
    "compute_p95_ms",
    "n_plans",
    "n_solver_fail",
    "n_plans_near_ped",
    "method_applies_share",
    "method_acts_where_applies_share",
    "method_overridden_share",
    PEOPLE,
    LEAST_TTC,
)
SETTING = ("duration_s", "ego_count", "ego_headway_s", "pedestrians_per_hour")
"""Settings that distinguish the conditions of a scenario."""
PARAMETERS = ("rules",)
"""Parameters that distinguish the variants of a method."""
_IDENTITY = ("run", "code", "scenario_id", "condition_id", "config_id", "controller", "seed", "valid")
HEADS = (*_IDENTITY, *(f"set_{name}" for name in (*SETTING, *PARAMETERS)), *NUMBERS)


def driven(folder: Path) -> list[StudyRun]:
    """Return the runs below a folder with what a page needs; their folders are relative to that folder.

    ``versions`` of a run is the commit of the tool that drove it; empty if it is not known.

    Raises
    ------
    StudyError
        If there are no runs in the folder, or one cannot be read.
    """
    study = read_study(run_folders(folder))
    if study.unreadable:
        raise StudyError(min(study.unreadable.values()))
    return [_of_folder(run, folder) for run in study.runs]


def merged(driven: Sequence[StudyRun], published: Iterable[StudyRun]) -> list[StudyRun]:
    """Return the driven runs, and the published runs under the same conditions that were not driven again."""
    conditions, folders = {run.condition_id for run in driven}, {run.folder for run in driven}
    kept = [one for one in published if one.condition_id in conditions and one.folder not in folders]
    return sorted([*driven, *kept], key=lambda run: run.folder.as_posix())


def write_table(path: Path, runs: Iterable[StudyRun]) -> None:
    """Write a table of runs."""
    write_csv(path, HEADS, (_cells(run) for run in runs))


def read_table(path: Path) -> list[StudyRun]:
    """Return the runs of a table as `driven` returns them.

    Raises
    ------
    StudyError
        If the table cannot be read or has other columns.
    """
    try:
        rows = read_csv(path)
        return [_of_row(row) for row in rows]
    except (OSError, ValueError, KeyError) as error:
        raise StudyError(f"{path}: not a table of runs as make study-papers writes it ({error})") from None


def _of_folder(run: StudyRun, root: Path) -> StudyRun:
    numbers = {name: run.numbers[name] for name in NUMBERS if name in run.numbers}
    if run.valid and len(run.samples["min_ttc_s"]):
        numbers[LEAST_TTC] = float(run.samples["min_ttc_s"].min())
    if run.valid and (run.folder / "neighbours.parquet").exists():
        people = people_at_once(read_run(run.folder))
        numbers |= {} if people is None else {PEOPLE: people}
    return replace(
        run,
        folder=run.folder.relative_to(root),
        setting={name: run.setting[name] for name in SETTING if name in run.setting},
        parameters={name: run.parameters[name] for name in PARAMETERS if name in run.parameters},
        versions=str(read_json(run.folder / "run.json").get("git_sha") or ""),
        numbers=numbers,
    )


def _of_row(row: Mapping[str, str]) -> StudyRun:
    return StudyRun(
        folder=Path(row["run"]),
        run_id=row["run"],
        config_id=row["config_id"],
        scenario_id=row["scenario_id"],
        controller=row["controller"],
        seed=int(row["seed"]),
        valid=row["valid"] == "1",
        invalid_reason="",
        setting={name: row[f"set_{name}"] for name in SETTING if row[f"set_{name}"]},
        condition_id=row["condition_id"],
        parameters={name: row[f"set_{name}"] for name in PARAMETERS if row[f"set_{name}"]},
        versions=row["code"],
        thresholds="",
        cells=(),
        numbers={name: float(row[name]) for name in NUMBERS if row[name]},
        samples={},
    )


def _cells(run: StudyRun) -> list[object]:
    given = {**run.setting, **run.parameters}
    identity = (run.scenario_id, run.condition_id, run.config_id, run.controller, run.seed, int(run.valid))
    return [
        run.folder.as_posix(),
        run.versions,
        *identity,
        *(given.get(name, "") for name in (*SETTING, *PARAMETERS)),
        *(f"{run.numbers[name]:.9g}" if name in run.numbers else "" for name in NUMBERS),
    ]
