"""Reads what the folder of a study holds of a run, and reports damage."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from analysis.files import read_json
from analysis.sealing import damages
from cosim.batches.outcome import NOTE
from cosim.errors import InputError

ESSENTIAL = ("run.json", NOTE, "runs.csv", "encounters.csv")
FAILURE = "failure.json"
"""File that describes a failed run."""
DAMAGED = "damaged"
"""Key that marks a failed run whose file cannot be read."""
_NEEDED = ("run", "scenario", "controller", "seed", "reason", "command")
REMEDY = "remove the folder {folder} and repeat the command, which makes the run again"


def run_damages(folder: Path) -> list[str]:
    """Return a line for each file of a finished run of a batch that was altered or lost."""
    told = damages(folder) or [
        f"{folder / name}: is missing; {REMEDY.format(folder=folder)}"
        for name in ESSENTIAL
        if not (folder / name).is_file()
    ]
    if not told:
        try:
            read_made(folder)
        except InputError as error:
            told = [str(error)]
    return told


def read_made(folder: Path) -> tuple[dict[str, Any], str]:
    """Return a run's description, and the hash of the code that made it.

    Raises
    ------
    InputError
        If they cannot be read; names the folder and the remedy.
    """
    try:
        description = read_json(folder / "run.json")
        note = read_json(folder / NOTE)
        return description, str(note["source"])
    except (OSError, ValueError, KeyError) as error:
        raise InputError(f"{folder}: cannot be read ({error}); {REMEDY.format(folder=folder)}") from error


def read_failure(folder: Path) -> dict[str, Any]:
    """Return what is known of a failed run; one with a damaged file is marked and has that as its reason."""
    path = folder / FAILURE
    try:
        found = read_json(path)
        return {**found, **{key: str(found[key]) for key in _NEEDED}, "seed": int(found["seed"])}
    except (OSError, ValueError, TypeError, KeyError) as error:
        told = f"{path}: cannot be read ({error}); {REMEDY.format(folder=folder)}"
        return {"run": folder.name, "reason": " ".join(told.split()), DAMAGED: True}
