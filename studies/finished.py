"""Finds the runs of a finished study."""

from __future__ import annotations

from pathlib import Path

from analysis.errors import StudyError
from analysis.study.runs import find_run_folders


def run_folders(folder: Path) -> list[Path]:
    """Return the folders of a study's runs, sorted.

    Raises
    ------
    StudyError
        If there are no runs.
    """
    folders = find_run_folders(folder)
    if not folders:
        raise StudyError(f"{folder}: no runs; cosim batch makes them")
    return folders
