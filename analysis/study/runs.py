"""Reads the finished runs of a study: their settings, and the numbers that are summarised over runs."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.arrays import FloatArray
from analysis.errors import AnalysisError, StudyError
from analysis.files import PART, read_json
from analysis.manifest import MANIFEST, make_again
from analysis.results.measures import is_wall_clock
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.sealing import damages
from analysis.study.run_numbers import numbers_in, read_cells, table_text, tallies_and_samples

STUDY_FILE = "study.toml"
"""Copy of the study file; marks the folder of a study."""
_NEEDED = ("run_id", "config_id", "scenario_id", "controller", "seed", "valid")


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
    """What the run has in common with runs of other controllers: demand, egos, step, files."""
    condition_id: str
    """Identifies scenario and setting."""
    parameters: Mapping[str, str]
    """Parameters of the controller, and ``file``, the beginning of the hash of its own file."""
    versions: str
    thresholds: str
    """Thresholds of the analysis; empty if they are not known."""
    cells: tuple[str, ...]
    """Its row of runs.csv; empty if too little was recorded to analyse."""
    numbers: Mapping[str, float]
    """Columns of runs.csv and tallies of encounters; undefined ones are missing."""
    samples: Mapping[str, FloatArray]
    """Defined values of the encounter measures."""


def find_run_folders(root: Path, *, nested: bool = False) -> list[Path]:
    """Return the sorted folders of runs at or below a folder, including runs that lost their ``run.json``.

    Folders whose name begins with a dot or ends in ``.part`` or ``.tmp`` are skipped.

    Parameters
    ----------
    root
    nested
        Whether to include the runs of a study within the folder of another study.
    """
    found = []
    alone = not nested and (root / STUDY_FILE).is_file()
    for place, folders, files in os.walk(root):
        if alone and STUDY_FILE in files and Path(place) != root:
            folders.clear()
            continue
        if "run.json" in files or (MANIFEST in files and any(map(_is_of_a_run, files))):
            found.append(Path(place))
            folders.clear()
        folders[:] = [
            name for name in folders if not name.startswith(".") and not name.endswith((PART, ".tmp"))
        ]
    return sorted(found)


def _is_of_a_run(name: str) -> bool:
    """Return whether a file marks a folder of a run; folders of studies have hashes, too."""
    return name == "job.json" or name.endswith(".parquet")


def read_runs(folders: Iterable[Path]) -> list[StudyRun]:
    """Read run folders, given in any order, and return the runs in a fixed order.

    A run that has not ended is not valid. Two folders with the same run count once.

    Raises
    ------
    StudyError
        If a folder cannot be read, was not analysed or was analysed by another version, if two runs of one
        configuration and seed differ, or if runs were analysed with different thresholds.
    """
    runs, unreadable = read_whole_runs(folders)
    if unreadable:
        raise StudyError(min(unreadable.values()))
    return runs


def read_whole_runs(folders: Iterable[Path]) -> tuple[list[StudyRun], dict[Path, str]]:
    """Read run folders as `read_runs` does, but go on if one cannot be read.

    Returns
    -------
    list
        The runs that can be read.
    dict
        The folders of the others, each with one line that names the file and the remedy.

    Raises
    ------
    StudyError
        If two runs of one configuration and seed differ, or if runs were analysed with different thresholds.
    """
    runs: list[StudyRun] = []
    unreadable: dict[Path, str] = {}
    for folder in sorted(folders):
        try:
            runs.append(_read(folder))
        except AnalysisError as error:
            unreadable[folder] = str(error)
        except (ValueError, TypeError, AttributeError, KeyError) as error:  # only in a folder without hashes
            said = f"a file in it is not what a run writes ({error!r})"
            unreadable[folder] = f"{folder}: {said}; {make_again(folder)}"
    runs.sort(key=lambda run: (run.scenario_id, run.config_id, run.seed, not run.valid, run.run_id))
    _check_thresholds(runs)
    return _once(runs), unreadable


def _read(folder: Path) -> StudyRun:
    if damaged := damages(folder, recordings=False):
        raise StudyError(damaged[0])
    path = folder / "run.json"
    try:
        meta = read_json(path)
    except OSError as error:
        raise StudyError(f"{path}: cannot be read ({error.strerror}); {make_again(folder)}") from None
    except ValueError as error:
        raise StudyError(f"{path}: truncated or not JSON ({error}); {make_again(folder)}") from None
    for key in _NEEDED:
        if meta.get(key) is None:
            raise StudyError(f"{path}: no value for {key!r}; {make_again(folder)}")
    cells = read_cells(folder / RUNS.file)
    if meta["valid"] and not cells:
        raise StudyError(f"{folder} was not analysed: no {RUNS.file}; cosim analyse makes it")
    numbers, samples = numbers_in(cells), dict[str, FloatArray]()
    encounters = table_text(folder) if cells else ""
    if meta["valid"]:
        tallies, samples = tallies_and_samples(folder / ENCOUNTERS.file, encounters)
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
        parameters=_controller(meta),
        versions=json.dumps(meta.get("versions") or meta.get("tool_version"), sort_keys=True),
        thresholds=_thresholds(folder / "config.json"),
        cells=cells,
        numbers=numbers,
        samples=samples,
    )


def _controller(meta: Mapping[str, Any]) -> dict[str, str]:
    parameters = dict((meta.get("parameters") or {}).get("controller") or {})
    if files := meta.get("controller_files"):  # two versions of one file are two controllers
        parameters["file"] = "+".join(str(digest)[:8] for digest in sorted(files.values()))
    return _texts(parameters)


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
    """Return the values as texts for ``--set``."""
    return {
        key: value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
        for key, value in sorted(values.items())
    }


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
    """Return one run for each configuration and seed, preferring valid ones; refuse two runs that differ."""
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
    """Return whether two runs have the same numbers, apart from wall-clock times."""
    free = {i for i, name in enumerate(RUNS.names()) if is_wall_clock(name) or name == "git_sha"}
    cells = [[cell for i, cell in enumerate(run.cells) if i not in free] for run in (one, other)]
    return cells[0] == cells[1] and one.run_id == other.run_id
