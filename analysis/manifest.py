"""Hashes of a run's files, so that a file that was altered or lost since is not read as a result.

``files.json`` in a run's folder gives the length and SHA-256 of every file that the tool has written there
and, for a table, the number of rows. It is written last and holds its own hash. All files of a run are read
through `read_verified`. The tables of a study and of a check have such a manifest, too. An older folder
without hashes is read unchecked.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from analysis.errors import DamageError

MANIFEST = "files.json"
CLAIM = "hashes"
"""Key of ``run.json`` that names the manifest, so that a lost manifest is noticed."""
RECORDED = ("run.json", "job.json", "map.json", "*.parquet")
"""Files that no analysis can make again."""
WRITTEN_AGAIN = "the batch or check, repeated, writes it again"
"""Remedy for lost tables of a study or a check."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A file's properties when it was written."""

    bytes: int
    rows: int | None
    """Number of rows of a table; ``None`` for other files."""
    sha256: str


def read_manifest(folder: Path) -> dict[str, Entry] | None:
    """Return the entries of a run's files by name; ``None`` for a folder without hashes.

    Raises
    ------
    DamageError
        If the manifest is lost or damaged.
    """
    path = folder / MANIFEST
    try:
        text = path.read_bytes()
        entries = {name: Entry(**entry) for name, entry in json.loads(text)["files"].items()}
        if text != text_of(entries).encode():
            raise ValueError("it does not fit its own hash")
        return entries
    except FileNotFoundError:
        if _claims(folder):
            raise DamageError(f"{path}: is missing; {make_again(folder)}") from None
        return None
    except OSError as error:
        raise DamageError(f"{path}: cannot be read ({error.strerror})") from None
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise DamageError(f"{path}: is damaged ({error!s:.80}); {make_again(folder)}") from None


def text_of(entries: Mapping[str, Entry]) -> str:
    """Return the content of a manifest."""
    lines = [f" {json.dumps(name)}: {json.dumps(asdict(entries[name]))}" for name in sorted(entries)]
    files = "{\n" + ",\n".join(lines) + "\n}"
    digest = hashlib.sha256(files.encode()).hexdigest()
    return f'{{"files": {files},\n"sha256": "{digest}"}}\n'


def read_verified(path: Path) -> bytes:
    """Return the content of a file, checked against its hash if the run has hashes.

    Raises
    ------
    DamageError
        If the file was altered or lost; the text names a remedy.
    OSError
        If the file cannot be read.
    """
    return read_as_written(path, read_manifest(path.parent))


def read_as_written(path: Path, entries: Mapping[str, Entry] | None) -> bytes:
    """Return the same as `read_verified`, with a manifest that is already read; ``None`` if there is none."""
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        if entries is not None and path.name in entries:
            raise _lost(path, entries) from None
        raise
    if entries is not None:
        entry = entries.get(path.name)
        if entry is None:
            raise DamageError(f"{path}: was not written with the files beside it; {_remedy(path, entries)}")
        if entry.bytes != len(content) or entry.sha256 != hashlib.sha256(content).hexdigest():
            raise _altered(path, entries, content)
    return content


def _lost(path: Path, entries: Mapping[str, Entry]) -> DamageError:
    """Return the error for a lost file."""
    return DamageError(f"{path}: is missing; {_remedy(path, entries)}")


def _altered(path: Path, entries: Mapping[str, Entry], content: bytes) -> DamageError:
    """Return the error for an altered file."""
    entry = entries[path.name]
    said = "has another content than it was written with"
    rows = count_rows(path.name, content)
    if len(content) < entry.bytes:
        said = f"was cut short or altered: {len(content)} bytes, {entry.bytes} were written"
    if rows != entry.rows:
        said = f"was altered: {'no readable table' if rows is None else f'{rows} rows'}, "
        said += f"{entry.rows} rows were written"
    return DamageError(f"{path}: {said}; {_remedy(path, entries)}")


def _remedy(path: Path, entries: Mapping[str, Entry]) -> str:
    """Return the remedy for a lost or altered file."""
    if "run.json" not in entries:
        return WRITTEN_AGAIN
    recorded = any(path.match(pattern) for pattern in RECORDED)
    if not recorded and any(name.endswith(".parquet") for name in entries):
        return f"cosim analyse {path.parent} makes it again"
    return make_again(path.parent)


def make_again(folder: Path) -> str:
    """Return the remedy if nothing else restores the files of a folder."""
    if (folder / "configs.csv").exists() or (folder / "criteria.csv").exists():
        return WRITTEN_AGAIN
    return f"remove the folder {folder} and make the run again"


def count_rows(name: str, content: bytes) -> int | None:
    """Return the number of rows of a table; ``None`` if it cannot be read, and for other files."""
    if name.endswith(".csv"):
        text = io.StringIO(content.decode("utf-8", errors="replace"), newline="")
        try:
            return max(0, sum(1 for _ in csv.reader(text)) - 1)
        except csv.Error:
            return None
    if name.endswith(".parquet"):
        import pyarrow as pa
        import pyarrow.parquet as pq

        try:
            return int(pq.read_metadata(pa.BufferReader(content)).num_rows)
        except (pa.ArrowException, OSError):
            return None
    return None


def entry_of(name: str, content: bytes) -> Entry:
    """Return a file's entry for the manifest."""
    return Entry(len(content), count_rows(name, content), hashlib.sha256(content).hexdigest())


def _claims(folder: Path) -> bool:
    try:
        return bool(json.loads((folder / "run.json").read_bytes()).get(CLAIM))
    except (OSError, ValueError, AttributeError):
        return False
