"""``cosim.load`` and ``cosim.analyse``: reads and analyses existing recordings."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from analysis.results.analyse import analyse_run
from analysis.study.runs import find_run_folders
from analysis.thresholds import with_settings
from cosim.api.recorded_run import Run
from cosim.api.study import Study
from cosim.api.tables import as_input_errors, read_description
from cosim.errors import InputError
from cosim.running.inventory import as_text


def load(folder: str | PathLike[str]) -> Run | Study:
    """Return the recorded run in a folder, or a study if the folder contains run folders.

    Raises
    ------
    InputError
        If there is no run in the folder.
    """
    path = Path(folder)
    if (path / "run.json").is_file():
        read_description(path)
        return Run(path)
    if not path.is_dir():
        raise InputError(f"{path}: no such folder")
    if not find_run_folders(path):
        raise InputError(f"{path}: no run in it; expected the folder of a run or of a study")
    return Study(path)


def analyse(run: Run | str | PathLike[str], **thresholds: float) -> Run:
    """Compute the numbers of a recorded run again, without simulating, and return it.

    Parameters
    ----------
    run
        A run, or its folder; its CSV files are replaced.
    **thresholds
        Thresholds of the analysis, such as ``severity_ttc_serious_s=1.2``; the others keep their defaults.

    Raises
    ------
    InputError
        If a threshold is unknown, or the folder cannot be read.
    """
    folder = run.folder if isinstance(run, Run) else Path(run)
    with as_input_errors():
        analyse_run(folder, with_settings({key: as_text(value) for key, value in thresholds.items()}))
    return Run(folder)
