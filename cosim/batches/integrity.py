"""Checks that the runs in a folder (of a run, a study or a check, or several) are as they were written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from analysis.manifest import MANIFEST
from analysis.sealing import damages, has_hashes
from analysis.study.runs import STUDY_FILE, find_run_folders
from cosim.batches.ledger import RUNS, Ledger
from cosim.batches.stored import run_damages
from cosim.errors import InputError
from cosim.presentation.notes import unverified


@dataclass(frozen=True, slots=True)
class Verified:
    """The result of verifying a folder."""

    runs: int
    """Number of runs whose files have hashes."""
    damages: Sequence[str]
    """A line for each file that was altered or lost."""
    notes: Sequence[str]


def verify_folder(folder: Path) -> Verified:
    """Check all files of the runs at or below a folder.

    Raises
    ------
    InputError
        If the folder does not exist or holds no run.
    """
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder")
    runs = find_run_folders(folder, nested=True)
    ledgers = [Ledger(place) for place in _folders_with(STUDY_FILE, folder) if (place / RUNS).is_dir()]
    of_batches = {one.run_folder(name) for one in ledgers for name in one.finished()}
    found = [told for run in sorted(of_batches) for told in run_damages(run)]
    found += [told for run in runs if run not in of_batches for told in damages(run)]
    found += [told for one in ledgers for told in one.damaged_failures().values()]
    tables = [place for place in _folders_with(MANIFEST, folder) if place not in of_batches.union(runs)]
    found += [told for place in tables for told in damages(place)]
    if not runs and not found:
        raise InputError(
            f"{folder}: contains no runs; expected the folder of a run, a study or a check, "
            "or one of run folders"
        )
    return Verified(sum(map(has_hashes, runs)), found, unverified(runs))


def _folders_with(name: str, root: Path) -> list[Path]:
    """Return the folders with such a file, sorted; leave out hidden ones, which hold runs in progress."""
    found = sorted(path.parent for path in root.rglob(name))
    return [one for one in found if not any(part.startswith(".") for part in one.relative_to(root).parts)]
