"""Writes CSV files as one Excel workbook, with units in the headings and a sheet of definitions."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from analysis.errors import AnalysisError
from analysis.files import completing, read_csv_rows, read_json
from cosim.errors import InputError

WORKBOOK = "tables.xlsx"
PACKAGE = "datapackage.json"
DEFINITIONS = "definitions"
LONGEST = 1_048_576
"""Largest number of rows in a sheet, including the heading."""
_EPOCH = datetime(1980, 1, 1)
"""Date of everything in the file, so that the same tables give the same bytes."""
_MODIFIED = re.compile(rb"(<dcterms:modified[^>]*>)[^<]*")


def write_workbook(folders: Sequence[Path], out: Path) -> Path:
    """Write the tables that the data dictionaries of some folders describe, and return the file.

    Parameters
    ----------
    folders : folders with a ``datapackage.json`` each; if tables have the same name, the first one is used
    out : folder of the workbook

    Raises
    ------
    InputError
        If openpyxl is not installed, there is no table, a table cannot be read or is too long for a sheet, or
        the file cannot be written.
    """
    try:
        from openpyxl import Workbook
    except ModuleNotFoundError as error:
        raise InputError(
            "--xlsx needs openpyxl, which is not installed; run: pip install openpyxl"
        ) from error
    tables = _tables(folders)
    if not tables:
        raise InputError(f"--xlsx: no table in {', '.join(map(str, folders))}")
    book = Workbook(write_only=True)
    book.properties.created = _EPOCH
    book.properties.creator = "sumo-cosim"
    for name, (path, fields) in tables.items():
        _fill(book.create_sheet(name), path, fields)
    sheet = book.create_sheet(DEFINITIONS)
    for row in _definitions(tables):
        sheet.append(row)
    content = io.BytesIO()
    book.save(content)
    path = out / WORKBOOK
    try:
        with completing(path) as part:
            part.write_bytes(_undated(content.getvalue()))
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from error
    return path


Tables = Mapping[str, tuple[Path, Sequence[Mapping[str, Any]]]]


def _tables(folders: Sequence[Path]) -> Tables:
    """Return file and fields of each table, by name."""
    found: dict[str, tuple[Path, Sequence[Mapping[str, Any]]]] = {}
    for folder in folders:
        if not (folder / PACKAGE).is_file():
            continue
        try:
            resources = read_json(folder / PACKAGE)["resources"]
            for one in resources:
                path = folder / one["path"]
                if path.suffix == ".csv" and path.is_file():
                    found.setdefault(one["name"], (path, one["schema"]["fields"]))
        except (AnalysisError, OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(f"{folder / PACKAGE}: cannot be read: {error}") from error
    return found


def _fill(sheet: Any, path: Path, fields: Sequence[Mapping[str, Any]]) -> None:
    from openpyxl.cell import WriteOnlyCell

    try:
        header, *rows = read_csv_rows(path)
    except (AnalysisError, OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    if len(rows) >= LONGEST:
        raise InputError(f"{path}: {len(rows)} rows are more than a sheet can have ({LONGEST - 1})")
    kinds = {one["name"]: one for one in fields}
    sheet.freeze_panes = "A2"
    sheet.append([_heading(kinds.get(name, {"name": name})) for name in header])
    for row in rows:
        cells = []
        for name, text in zip(header, row, strict=True):
            cell = WriteOnlyCell(sheet, _value(text, str(kinds.get(name, {}).get("type", "string"))))
            if isinstance(cell.value, str):
                cell.data_type = "s"  # so that a spreadsheet does not take a text for a formula
            cells.append(cell)
        sheet.append(cells)


def _heading(field: Mapping[str, Any]) -> str:
    unit = field.get("unit", "")
    return f"{field['name']} [{unit}]" if unit not in ("", "1") else str(field["name"])


def _value(text: str, kind: str) -> str | float | int | bool | None:
    if text == "":
        return None
    if kind == "boolean":
        return text == "1"
    if kind == "integer":
        return int(text)
    return float(text) if kind == "number" else text


def _definitions(tables: Tables) -> Iterator[list[str]]:
    yield ["table", "column", "type", "unit", "meaning"]
    for name, (_, fields) in tables.items():
        for one in fields:
            yield [name, one["name"], one["type"], one.get("unit", ""), one.get("description", "")]


def _undated(content: bytes) -> bytes:
    """Return a workbook without the time at which it was made."""
    written = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(content)) as before,
        zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as after,
    ):
        for entry in before.infolist():
            part = _MODIFIED.sub(rb"\g<1>1980-01-01T00:00:00Z", before.read(entry))
            after.writestr(zipfile.ZipInfo(entry.filename), part, zipfile.ZIP_DEFLATED)
    return written.getvalue()
