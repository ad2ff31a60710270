"""Origin of a study: its runs, commands, versions, seeds and hashes, and runs that failed or are invalid."""

from __future__ import annotations

import csv
import json
import os
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from analysis.criteria.table import CRITERIA
from analysis.errors import StudyError
from analysis.files import read_csv
from analysis.page.recorded import has_recording
from analysis.page.tables import read_rows
from analysis.study.design import Study
from analysis.study.runs import STUDY_FILE, StudyRun

FAILED = "failed.csv"
NOTE = "job.json"
MOST_CRITERIA = 400
"""Largest number of rows of criteria.csv on the page; the rows that fail the check come first."""
_WORDS = {"invalid": "invalid", "fail": "failed", "undefined": "undefined", "pass": "passed"}


def run_lines(study: Study, out: Path) -> list[dict[str, Any]]:
    """Return one line for each run: what it is, where it is, and the command that repeats it."""
    return [
        {
            "folder": relative(run.folder, out),
            "name": run.folder.name,
            "run_id": run.run_id,
            "config_id": run.config_id,
            "label": study.label(run),
            "scenario": run.scenario_id,
            "seed": run.seed,
            "valid": run.valid,
            "reason": run.invalid_reason or ("" if run.valid else "not finished"),
            "recorded": has_recording(run.folder),
            "command": command(run),
        }
        for run in study.runs
    ]


def relative(folder: Path, out: Path) -> str:
    """Return the path of a folder relative to the folder of the report."""
    return Path(os.path.relpath(folder.resolve(), out.resolve())).as_posix()


def command(run: StudyRun) -> str:
    """Return the command that repeats a run: the one noted with it, or one made from its description."""
    noted = _json(run.folder / NOTE).get("command")
    if isinstance(noted, str) and noted:
        return noted
    words = ["cosim", "run", run.scenario_id, "--controller", run.controller, "--seed", str(run.seed)]
    described = _json(run.folder / "run.json")
    if described.get("command"):
        return str(described["command"])
    if described.get("sensing") not in (None, "perfect"):
        words += ["--sensing", str(described["sensing"])]
    parameters = described.get("parameters") or {}
    for group in ("scenario", "controller", "sensing"):
        for name, value in (parameters.get(group) or {}).items():
            if value is not None:
                text = value if isinstance(value, str) else json.dumps(value)
                words += ["--set", f"{name}={text}"]
    return shlex.join(words)


def made_with(study: Study, root: Path | None) -> dict[str, Any]:
    """Return the versions, seeds and hashes of the runs, each once."""
    described = [_json(run.folder / "run.json") for run in study.runs]
    networks = {
        (one.get("scenario_id"), (one.get("inputs") or {}).get("network", "")): None for one in described
    }
    study_file = None if root is None else root / STUDY_FILE
    return {
        "versions": list(dict.fromkeys(_versions(one) for one in described)),
        "commits": sorted({str(one["git_sha"]) for one in described if one.get("git_sha")}),
        "seeds": spans(sorted({run.seed for run in study.runs})),
        "networks": [{"scenario": name, "hash": text} for name, text in networks if text],
        "thresholds": sorted({run.thresholds for run in study.runs if run.thresholds}),
        "study": study_file.read_text("utf-8") if study_file is not None and study_file.is_file() else "",
    }


def _versions(described: Mapping[str, Any]) -> str:
    versions = dict(described.get("versions") or {"sumo-cosim": described.get("tool_version")})
    if described.get("sumo_version"):
        versions["SUMO"] = described["sumo_version"]
    return ", ".join(f"{name} {version}" for name, version in versions.items())


def spans(numbers: Sequence[int]) -> str:
    """Return whole numbers in ascending order as a short text.

    Examples
    --------
    >>> spans([1, 2, 3, 7])
    '1–3, 7'
    """
    groups: list[list[int]] = []
    for number in numbers:
        if groups and number == groups[-1][-1] + 1:
            groups[-1].append(number)
        else:
            groups.append([number])
    return ", ".join(f"{one[0]}–{one[-1]}" if len(one) > 1 else str(one[0]) for one in groups)


def failed_runs(root: Path | None) -> list[dict[str, str]]:
    """Return the rows of failed.csv of a batch, or of all studies of a check."""
    if root is None:
        return []
    return [row for path in sorted([root / FAILED, *root.glob(f"*/{FAILED}")]) for row in _rows(path)]


def damaged_runs(study: Study, out: Path) -> list[dict[str, str]]:
    """Return the runs that are left out because they cannot be read or were changed after writing."""
    return [
        {"run": relative(folder, out), "reason": told, "command": ""}
        for folder, told in study.unreadable.items()
    ]


def criteria(root: Path | None) -> dict[str, Any] | None:
    """Return the results of a check, those that make it fail first; ``None`` without a criteria.csv.

    Rows that make it fail have ``decides`` true, which a failure that does not count has not.
    """
    if root is None or not (root / CRITERIA.file).is_file():
        return None
    rows: list[dict[str, Any]] = [
        {**row, "decides": row["status"] != "pass" and bool(row["counts"])}
        for row in read_rows(root / CRITERIA.file, CRITERIA)
    ]
    order = {"invalid": 0, "fail": 1, "undefined": 2, "pass": 3}
    rows.sort(key=lambda row: (not row["decides"], order[row["status"]]))
    counted = {status: sum(row["status"] == status for row in rows) for status in order}
    return {
        "rows": rows[:MOST_CRITERIA],
        "total": len(rows),
        "counts": [f"{number} {_WORDS[status]}" for status, number in counted.items() if number],
        "passed": not any(row["decides"] for row in rows),
    }


def _rows(path: Path) -> list[dict[str, str]]:
    if not path.is_file():
        return []
    try:
        return read_csv(path)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise StudyError(f"{path}: cannot be read ({error})") from None


def _json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}
