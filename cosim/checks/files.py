"""Writes the files of a check: criteria.csv with its dictionary, JUnit XML, and the summary of a CI step."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from analysis.criteria.table import CRITERIA
from analysis.files import read_json, write_csv, write_json
from analysis.sealing import seal
from analysis.tables.cells import cells
from analysis.tables.datapackage import describe
from cosim.checks.finding import Finding
from cosim.checks.junit import write_junit
from cosim.checks.summary import append_step_summary
from cosim.errors import InputError, SimulationError, reason_of

PACKAGE = "datapackage.json"


def write_findings(folder: Path, findings: Sequence[Finding], junit: Path | None) -> None:
    """Write the files; other entries of the folder's dictionary and manifest are kept.

    Raises
    ------
    InputError
        If the folder cannot be made.
    SimulationError
        If the files cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"--out {folder}: {error.strerror}") from error
    try:
        rows = cells(CRITERIA, [one.row() for one in findings], number="{:.9g}".format)
        package = describe([CRITERIA], "a check")
        others = [one for one in _described(folder / PACKAGE) if one.get("name") != CRITERIA.name]
        package["resources"] = [*others, *package["resources"]]
        files = (
            write_csv(folder / CRITERIA.file, CRITERIA.names(), rows),
            write_json(folder / PACKAGE, package),
        )
        seal(folder, files)
        if junit is not None:
            write_junit(junit, findings)
        append_step_summary(findings)
    except OSError as error:
        raise SimulationError(f"the files of the check could not be written: {reason_of(error)}") from error


def check_junit(path: Path | None) -> None:
    """Refuse a path that is a folder rather than a file.

    Raises
    ------
    InputError
        If it is a folder; the message is one line.
    """
    if path is not None and path.is_dir():
        raise InputError(f"--junit {path}: expected a file, this is a folder")


def _described(path: Path) -> list[dict[str, object]]:
    try:
        return list(read_json(path)["resources"])
    except (OSError, ValueError, KeyError, TypeError):
        return []  # the file is missing or damaged and will be written anew
