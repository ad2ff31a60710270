"""Reads the finished runs of a study: what was asked for, and the numbers that are summed up over runs."""

from __future__ import annotations

import csv
import hashlib
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv as pa_csv

from analysis.errors import StudyError
from analysis.files import PART, read_csv_rows, read_json
from analysis.results.measures import encounter_measures, is_wall_clock
from analysis.results.origin import SCHEMA_VERSION
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.statistics.intervals import FloatArray
from analysis.thresholds import DRAC_LIMIT_MPS2, LOW_PET_S, LOW_TTC_S

_NEEDED = ("run_id", "config_id", "scenario_id", "controller", "seed", "valid")
_DRAC_BEYOND = ("unbounded", "collision")
_CONFLICTS = ("serious", "severe", "collision")
_DESCRIPTIVE = ("entered", "collision", "drac_status", "severity")


@dataclass(frozen=True, slots=True)
class StudyRun:
    """One finished run."""

    folder: Path
    run_id: str
    config_id: str
    scenario_id: str
    controller: str
    seed: int
    valid: bool
    invalid_reason: str
    setting: Mapping[str, str]
    """What the run shares with those of other controllers: demand, egos, step, files."""
    condition_id: str
    """Identity of scenario and setting."""
    parameters: Mapping[str, str]
    """Of the controller."""
    versions: str
    thresholds: str
    """Of the analysis; empty where they are not known."""
    cells: tuple[str, ...]
    """Its row of runs.csv; empty when too little was recorded to analyse."""
    numbers: Mapping[str, float]
    """Columns of runs.csv and tallies of encounters; what is undefined is missing."""
    samples: Mapping[str, FloatArray]
    """Defined values of the encounter measures."""


def find_run_folders(root: Path) -> list[Path]:
    """Return the folders at or below a folder that hold a ``run.json``, in alphabetical order.

    Folders whose name begins with a dot or ends in ``.part`` or ``.tmp`` are skipped.
    """
    found = []
    for place, folders, files in os.walk(root):
        if "run.json" in files:
            found.append(Path(place))
            folders.clear()
        folders[:] = [
            name for name in folders if not name.startswith(".") and not name.endswith((PART, ".tmp"))
        ]
    return sorted(found)


def read_runs(folders: Iterable[Path]) -> list[StudyRun]:
    """Read run folders, in any order; return the runs in a fixed one.

    A run that has not ended is one that is not valid. Two folders with the same run count once.

    Raises
    ------
    StudyError
        For a folder that cannot be read, was not analysed or by another version, for two runs of one
        configuration and seed that are not the same, and for runs analysed with different thresholds.
    """
    runs = [_read(folder) for folder in sorted(folders)]
    runs.sort(key=lambda run: (run.scenario_id, run.config_id, run.seed, not run.valid, run.run_id))
    _check_thresholds(runs)
    return _once(runs)


def _read(folder: Path) -> StudyRun:
    path = folder / "run.json"
    try:
        meta = read_json(path)
    except OSError as error:
        raise StudyError(f"{path}: cannot be read ({error.strerror})") from None
    except ValueError as error:
        raise StudyError(f"{path}: truncated or not JSON ({error})") from None
    for key in _NEEDED:
        if not isinstance(meta, dict) or meta.get(key) is None:
            raise StudyError(f"{path}: no value for {key!r}")
    cells = _cells(folder / RUNS.file)
    if meta["valid"] and not cells:
        raise StudyError(f"{folder} was not analysed: no {RUNS.file}; cosim analyse makes it")
    numbers, samples = _numbers(cells), dict[str, FloatArray]()
    if meta["valid"]:
        tallies, samples = _read_encounters(folder / ENCOUNTERS.file)
        numbers |= tallies
    setting = _setting(meta)
    return StudyRun(
        folder=folder,
        run_id=str(meta["run_id"]),
        config_id=str(meta["config_id"]),
        scenario_id=str(meta["scenario_id"]),
        controller=str(meta["controller"]),
        seed=int(meta["seed"]),
        valid=bool(meta["valid"]),
        invalid_reason=str(meta.get("invalid_reason") or ""),
        setting=setting,
        condition_id=_digest([str(meta["scenario_id"]), setting]),
        parameters=_texts((meta.get("parameters") or {}).get("controller") or {}),
        versions=json.dumps(meta.get("versions") or meta.get("tool_version"), sort_keys=True),
        thresholds=_thresholds(folder / "config.json"),
        cells=cells,
        numbers=numbers,
        samples=samples,
    )


def _setting(meta: Mapping[str, Any]) -> dict[str, str]:
    parameters = dict((meta.get("parameters") or {}).get("scenario") or {})
    for key in ("step_s", "warmup_s", "actuation", "sensing"):
        parameters.setdefault(key, meta.get(key))
    sensing = dict((meta.get("parameters") or {}).get("sensing") or {})
    parameters |= {f"sensing.{key}": value for key, value in sensing.items()}
    parameters.setdefault("duration_s", meta.get("requested_duration_s"))
    egos = {f"ego_{key.removeprefix('ego_')}": value for key, value in (meta.get("egos") or {}).items()}
    inputs = _digest(sorted((meta.get("inputs") or {}).values()))
    return _texts({**egos, **parameters, "inputs": inputs})


def _digest(content: Any) -> str:
    text = json.dumps(content, sort_keys=True, ensure_ascii=False)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()[:8]


def _texts(values: Mapping[str, Any]) -> dict[str, str]:
    """Return the values as ``--set`` takes them."""
    return {
        key: value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
        for key, value in sorted(values.items())
    }


def _cells(path: Path) -> tuple[str, ...]:
    """Return the only row of a run's runs.csv; nothing when there is no such file."""
    try:
        rows = read_csv_rows(path)
    except FileNotFoundError:
        return ()
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise StudyError(f"{path}: cannot be read ({error})") from None
    if len(rows) != 2 or tuple(rows[0]) != RUNS.names() or len(rows[1]) != len(rows[0]):
        raise StudyError(
            f"{path}: expected one row with the columns of schema {SCHEMA_VERSION}; "
            "cosim analyse makes it again"
        )
    return tuple(rows[1])


def _numbers(cells: Sequence[str]) -> dict[str, float]:
    if not cells:
        return {}
    return {
        column.name: float(cell)
        for column, cell in zip(RUNS.columns, cells, strict=True)
        if column.kind in ("integer", "number") and cell
    }


def _read_encounters(path: Path) -> tuple[dict[str, float], dict[str, FloatArray]]:
    """Return the tallies of a run's encounters and the defined values of the encounter measures."""
    names = [measure.name for measure in encounter_measures()]
    options = pa_csv.ConvertOptions(
        include_columns=[*_DESCRIPTIVE, *names],
        column_types={
            **dict.fromkeys(names, pa.float64()),
            **dict.fromkeys(("entered", "collision"), pa.float64()),
            **dict.fromkeys(("drac_status", "severity"), pa.string()),
        },
        null_values=[""],
    )
    try:
        table = pa_csv.read_csv(path, convert_options=options)
    except (OSError, pa.ArrowException, KeyError) as error:
        raise StudyError(f"{path}: cannot be read ({str(error).splitlines()[0]})") from None
    values = {name: table.column(name).to_numpy() for name in (*names, "entered", "collision")}
    drac_status, severity = (np.array(table.column(name).to_pylist()) for name in _DESCRIPTIVE[2:])
    met = (values["entered"] == 1.0) | (values["collision"] == 1.0)
    beyond = np.isin(drac_status, _DRAC_BEYOND) | (values["drac_max_mps2"] > DRAC_LIMIT_MPS2)
    tallies = {
        "met": met,
        "met_collision": met & (values["collision"] == 1.0),
        "met_ttc_lt_1p5": met & (values["min_ttc_s"] < LOW_TTC_S),
        "met_pet_lt_1p5": met & (values["pet_area_s"] < LOW_PET_S),
        "met_drac_gt_3p4": met & beyond,
        "met_conflict": met & np.isin(severity, _CONFLICTS),
    }
    samples = {name: values[name][np.isfinite(values[name])] for name in names}
    return {name: float(flags.sum()) for name, flags in tallies.items()}, samples


def _thresholds(path: Path) -> str:
    try:
        return json.dumps(read_json(path).get("thresholds"), sort_keys=True)
    except FileNotFoundError:
        return ""
    except (OSError, ValueError) as error:
        raise StudyError(f"{path}: cannot be read ({error})") from None


def _check_thresholds(runs: Sequence[StudyRun]) -> None:
    known = [run for run in runs if run.valid and run.thresholds]
    for run in known[1:]:
        if run.thresholds != known[0].thresholds:
            raise StudyError(
                f"{known[0].folder} and {run.folder} were analysed with different thresholds; "
                "cosim analyse makes their numbers again with the same ones"
            )


def _once(runs: Sequence[StudyRun]) -> list[StudyRun]:
    """Return each configuration and seed once, a valid run before a failed one; refuse two that differ."""
    kept: dict[tuple[str, int], StudyRun] = {}
    for run in runs:
        first = kept.setdefault((run.config_id, run.seed), run)
        if first is not run and run.valid and not _same(first, run):
            raise StudyError(
                f"{first.folder} and {run.folder} are two runs of {run.config_id} with seed {run.seed} "
                "and differ: keep one of them"
            )
    return list(kept.values())


def _same(one: StudyRun, other: StudyRun) -> bool:
    """Return whether two runs have the same numbers, wall-clock times aside."""
    free = {i for i, name in enumerate(RUNS.names()) if is_wall_clock(name) or name == "git_sha"}
    cells = [[cell for i, cell in enumerate(run.cells) if i not in free] for run in (one, other)]
    return cells[0] == cells[1] and one.run_id == other.run_id
