"""Tables of runs and studies as pandas data frames, and as HTML for a notebook."""

from __future__ import annotations

import html
import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analysis.errors import AnalysisError
from analysis.files import read_json
from analysis.manifest import read_verified
from cosim.errors import InputError

if TYPE_CHECKING:
    from pandas import DataFrame


DTYPES = {"number": "float64", "integer": "int64", "boolean": "bool", "string": "str"}
"""Types of columns in a data package, and in pandas."""


def read_table(folder: Path, name: str) -> DataFrame:
    """Return a table of a folder as it was written; undefined values are nan.

    Parameters
    ----------
    folder
        Folder of a run or a study.
    name
        Name of the file, which ends in ``.csv`` or ``.parquet``.

    Raises
    ------
    InputError
        If there is no such table; the message lists those that exist.
    DamageError
        If the table was altered since it was written.
    """
    import pandas

    path = folder / name
    try:
        content = read_verified(path)
    except OSError as error:
        tables = sorted(one.name for one in folder.glob("*") if one.suffix in (".csv", ".parquet"))
        raise InputError(
            f"{path}: cannot be read ({error.strerror}); tables there: {', '.join(tables) or 'none'}"
        ) from error
    if path.suffix == ".parquet":
        return pandas.read_parquet(io.BytesIO(content))
    table = pandas.read_csv(io.BytesIO(content))
    if table.empty:  # its values do not tell what its columns hold
        table = table.astype(_declared(folder, name))
    for column in table.select_dtypes(include=["object", "string"]).columns:
        table[column] = table[column].str.removeprefix("'")  # written so that no spreadsheet computes it
    return table


def _declared(folder: Path, name: str) -> dict[str, str]:
    """Return the types of a table's columns that the data packages of its folder declare."""
    for package in sorted(folder.glob("*datapackage.json")):
        for table in read_json(package)["resources"]:
            if table["path"] == name:
                return {field["name"]: DTYPES[field["type"]] for field in table["schema"]["fields"]}
    return {}


def read_description(folder: Path) -> dict[str, Any]:
    """Return ``run.json`` of a folder.

    Raises
    ------
    InputError
        If the file does not exist or cannot be read.
    """
    try:
        return read_json(folder / "run.json")
    except (OSError, ValueError) as error:
        raise InputError(f"{folder}: cannot be read as a run ({error})") from error


def page_of(title: str, rows: Mapping[str, str], below: str = "") -> str:
    """Return a title and named values as HTML.

    Parameters
    ----------
    title, rows
        Texts, which are escaped.
    below
        HTML to put below the table.
    """
    lines = "".join(
        f"<tr><th style='text-align:left'>{html.escape(name)}</th>"
        f"<td style='text-align:right'>{html.escape(value)}</td></tr>"
        for name, value in rows.items()
    )
    table = f"<table>{lines}</table>" if lines else ""
    return f"<p><strong>{html.escape(title)}</strong></p>{table}{below}"


@contextmanager
def as_input_errors() -> Iterator[None]:
    """Turn errors of the analysis into `InputError`."""
    try:
        yield
    except AnalysisError as error:
        raise InputError(str(error)) from error
