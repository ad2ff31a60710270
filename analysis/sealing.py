"""Takes down the hashes of the files of a run or a study, and checks all of them."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from analysis.errors import DamageError
from analysis.files import write_text
from analysis.manifest import (
    MANIFEST,
    RECORDED,
    Entry,
    entry_of,
    read_as_written,
    read_manifest,
    text_of,
)


def seal_recording(folder: Path) -> None:
    """Take down what was recorded of a run that has just ended."""
    _write(folder, _entries(_recorded(folder)))


def seal(folder: Path, written: Iterable[Path], removed: Iterable[Path] = ()) -> None:
    """Take down files that were just written, last of all, and forget those that were just removed.

    The others stay as they were taken down; in a folder without hashes they are taken as they are now.

    Raises
    ------
    DamageError
        When the manifest of before is damaged.
    """
    before = read_manifest(folder)
    entries = _entries(_recorded(folder)) if before is None else before
    entries |= _entries(written)
    for path in removed:
        entries.pop(path.name, None)
    _write(folder, entries)


def seal_tables(folder: Path, written: Iterable[Path]) -> None:
    """Take down the tables of a study or a check, which were just written; there are no others."""
    _write(folder, _entries(written))


def has_hashes(folder: Path) -> bool:
    """Return whether the files of a run can be verified."""
    return (folder / MANIFEST).is_file()


def damages(folder: Path, recordings: bool = True) -> list[str]:
    """Check the files of a run or the tables of a study, and return a line for each that was altered or lost.

    Parameters
    ----------
    folder : of the run or the study
    recordings : whether the large tables of a run are checked too
    """
    try:
        entries = read_manifest(folder)
    except DamageError as error:
        return [str(error)]
    found = []
    for name in entries or {}:
        if name.endswith(".parquet") and not recordings:
            continue
        try:
            read_as_written(folder / name, entries)
        except DamageError as error:
            found.append(str(error))
        except OSError as error:
            found.append(f"{folder / name}: cannot be read ({error.strerror})")
    return found


def _recorded(folder: Path) -> list[Path]:
    return [path for pattern in RECORDED for path in folder.glob(pattern)]


def _entries(paths: Iterable[Path]) -> dict[str, Entry]:
    return {path.name: entry_of(path.name, path.read_bytes()) for path in paths}


def _write(folder: Path, entries: dict[str, Entry]) -> None:
    write_text(folder / MANIFEST, text_of(entries))
