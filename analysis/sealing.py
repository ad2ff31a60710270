"""Records the hashes of the files of a run or a study, and checks them."""

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
    """Record the hashes of the recorded files of a run that has just ended."""
    _write(folder, _entries(_recorded(folder)))


def seal(folder: Path, written: Iterable[Path], removed: Iterable[Path] = ()) -> None:
    """Record the hashes of files that were just written, and forget files that were just removed.

    The entries of other files stay; in a folder without hashes, the recorded files are hashed as they are
    now.

    Raises
    ------
    DamageError
        If the previous manifest is damaged.
    """
    before = read_manifest(folder)
    entries = _entries(_recorded(folder)) if before is None else before
    entries |= _entries(written)
    for path in removed:
        entries.pop(path.name, None)
    _write(folder, entries)


def seal_tables(folder: Path, written: Iterable[Path]) -> None:
    """Record the hashes of all tables of a study or a check, which were just written."""
    _write(folder, _entries(written))


def has_hashes(folder: Path) -> bool:
    """Return whether the files of a run can be verified."""
    return (folder / MANIFEST).is_file()


def damages(folder: Path, recordings: bool = True) -> list[str]:
    """Check the files of a run or the tables of a study; return a line for each that was altered or lost.

    Parameters
    ----------
    folder : folder of the run or the study
    recordings : whether to check the large tables of a run, too
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
