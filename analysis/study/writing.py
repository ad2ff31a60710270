"""Writes the tables over many runs and their dictionary: runs, encounters, configs and comparisons."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from analysis.files import completing, csv_lines, json_text, read_json, write_csv
from analysis.results.exposure_rows import EXPOSURE
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.results.traffic_rows import TRAFFIC_ENCOUNTERS
from analysis.study.comparison_rows import comparison_rows
from analysis.study.configuration_rows import configuration_rows
from analysis.study.design import read_study
from analysis.study.run_numbers import table_text
from analysis.study.runs import StudyRun
from analysis.study.tables import COMPARISONS, CONFIGS, STUDY_TABLES
from analysis.tables.cells import Row, cells
from analysis.tables.column import Table
from analysis.tables.datapackage import describe

PACKAGE = "datapackage.json"


def write_tables(out: Path, folders: Sequence[Path], baseline: str | None) -> Mapping[Path, str]:
    """Write the tables of a study; the same runs give the same bytes, whatever their order.

    All files are complete before the first of them gets its name.

    Parameters
    ----------
    out
        Folder for the tables; it is made if it does not exist.
    folders
        Run folders. Runs that failed or have not ended are counted, but do not enter any mean.
    baseline
        What the others are compared with: a controller, a controller with the parameters that distinguish
        it from its variants (``vo_mpc horizon=20``), or a config_id. ``None``: ``sumo``, or else the first
        in the alphabet. A baseline without any run leaves comparisons.csv without rows.

    Returns
    -------
    Mapping
        As in :attr:`analysis.study.design.Study.unreadable`.

    Raises
    ------
    StudyError
        If no run can be read or runs do not belong together; nothing is written then.
    OSError
        If the files cannot be written; previous files are kept.
    """
    study = read_study(folders)
    out.mkdir(parents=True, exist_ok=True)
    content = {
        RUNS.file: csv_lines([RUNS.names(), *(run.cells for run in study.runs if run.cells)]),
        ENCOUNTERS.file: _joined(ENCOUNTERS, study.runs),
        CONFIGS.file: _rows(CONFIGS, configuration_rows(study)),
        COMPARISONS.file: _rows(COMPARISONS, comparison_rows(study, baseline)),
    }
    tables: tuple[Table, ...] = STUDY_TABLES
    for table in (TRAFFIC_ENCOUNTERS, EXPOSURE):
        having = [run for run in study.runs if (run.folder / table.file).is_file()]
        if having:
            content[table.file] = _joined(table, having)
            tables = (*tables, table)
    content[PACKAGE] = iter([_package(out, tables)])
    with ExitStack() as stack:
        for name, texts in content.items():
            part = stack.enter_context(completing(out / name))
            with part.open("w", encoding="utf-8", newline="") as file:
                file.writelines(texts)
    return study.unreadable


def write_comparison(path: Path, rows: Sequence[Row]) -> None:
    """Write some rows of comparisons to a separate file."""
    write_csv(path, COMPARISONS.names(), _cells(COMPARISONS, rows))


def _rows(table: Table, rows: Iterable[Row]) -> Iterator[str]:
    return csv_lines([table.names(), *_cells(table, rows)])


def _cells(table: Table, rows: Iterable[Row]) -> Iterable[Sequence[str]]:
    # Six significant digits, because p values and rates of rare events are small, and the last digits of a
    # sum differ between processors.
    return cells(table, list(rows), number="{:.6g}".format)


def _joined(table: Table, runs: Iterable[StudyRun]) -> Iterator[str]:
    """Yield the lines of one table for all runs, holding only one run in memory at a time."""
    header = ",".join(table.names()) + "\n"
    yield header
    for run in runs:
        if run.cells:
            yield table_text(run.folder, table).removeprefix(header)


def _package(out: Path, tables: Sequence[Table]) -> str:
    """Return the data dictionary of these tables and of everything else that the folder's dictionary has."""
    package = describe(tables, "a study of many runs")
    mine = {table.name for table in tables}
    package["resources"] += [one for one in _described(out / PACKAGE) if one.get("name") not in mine]
    return json_text(package)


def _described(path: Path) -> list[dict[str, Any]]:
    try:
        return list(read_json(path)["resources"])
    except (OSError, ValueError, KeyError, TypeError):
        return []  # it is missing or damaged, and is written anew
