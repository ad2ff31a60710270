"""The tables of a study for the page, read from CSV files so that each number shown is a cell in a file."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.errors import StudyError
from analysis.files import read_csv, read_csv_rows
from analysis.results.measures import Measure, encounter_measures, run_measures
from analysis.results.run_tables import RUNS
from analysis.sealing import damages
from analysis.study.design import Study
from analysis.study.seeds_needed import seeds_needed
from analysis.study.tables import COMPARISONS, CONFIGS
from analysis.study.writing import write_tables
from analysis.tables.column import Column, Table
from analysis.wording import decimals, p_value

Row = Mapping[str, Any]

_SHARES = ("share", "yes_no")
_ENCOUNTER_ROWS = ("min_ttc_s", "pet_area_s", "clearance_min_m", "ego_max_decel_mps2")
_RUN_ROWS = (
    "n_collisions",
    "n_collisions_preventable",
    "n_collisions_crossing",
    "n_collisions_carriageway",
    "n_collisions_walking_area_or_kerb",
    "n_collisions_class_appeared",
    "n_interventions",
    "n_solver_fail",
)
_WORDS = {"no_difference_shown": "no difference shown"}


@dataclass(frozen=True, slots=True)
class Tables:
    """Rows of configs.csv and comparisons.csv, and the folder with the files."""

    folder: Path
    configs: Sequence[Row]
    comparisons: Sequence[Row]


def study_tables(
    study: Study, root: Path | None, out: Path, folders: Sequence[Path], baseline: str | None
) -> Tables:
    """Return the tables of a study: those beside its runs if they belong to these, else new ones in ``out``.

    Parameters
    ----------
    study
        The study read from ``folders``.
    root
        Folder that may already hold tables; ``None`` if there is none.
    out
        Folder for new tables.
    folders
        Run folders.
    baseline
        As for :func:`analysis.study.writing.write_tables`; existing tables are used only without a baseline.
    """
    place = root if root is not None and baseline is None and _is_current(root, study) else out
    if place is out:
        write_tables(out, folders, baseline)
    return Tables(
        place,
        read_rows(place / CONFIGS.file, CONFIGS),
        read_rows(place / COMPARISONS.file, COMPARISONS),
    )


def _is_current(root: Path, study: Study) -> bool:
    files = [root / table.file for table in (RUNS, CONFIGS, COMPARISONS)]
    if not all(path.is_file() for path in files) or damages(root, recordings=False):
        return False
    for path, table in zip(files[1:], (CONFIGS, COMPARISONS), strict=True):
        if tuple(next(iter(read_csv_rows(path)), ())) != table.names():
            return False  # written by another version
    lines = [tuple(row) for row in read_csv_rows(files[0])]
    return sorted(lines[1:]) == sorted(run.cells for run in study.runs if run.cells)


def read_rows(path: Path, table: Table) -> list[dict[str, Any]]:
    """Return the rows of a CSV file with their types; an empty cell is ``None``.

    Raises
    ------
    StudyError
        If the file cannot be read or lacks a column.
    """
    try:
        rows = read_csv(path)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise StudyError(f"{path}: cannot be read ({error})") from None
    try:
        return [{one.name: _typed(one, row[one.name]) for one in table.columns} for row in rows]
    except (KeyError, ValueError) as error:
        raise StudyError(f"{path}: not a table of this version ({error})") from None


def _typed(column: Column, text: str) -> Any:
    if text == "":
        return None
    if column.kind == "string":
        return text
    if column.kind == "boolean":
        return text == "1"
    return int(text) if column.kind == "integer" else float(text)


def measures_by_name() -> dict[tuple[str, str], Measure]:
    """Return every measure by its name and kind."""
    return {(one.name, one.kind): one for one in (*run_measures(), *encounter_measures())}


def configuration_blocks(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """Return a table for each scenario and setting: one line per measure, one cell per configuration."""
    measures = measures_by_name()
    blocks: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        shown = row["key"] or row["metric"] in _RUN_ROWS or _of_encounters(row)
        if shown and (row["metric"], row["kind"]) in measures:
            blocks.setdefault((row["scenario_id"], row["condition_id"]), []).append(row)
    found = []
    for (scenario, condition_id), mine in blocks.items():
        names = list(dict.fromkeys(row["configuration"] for row in mine))
        lines: dict[tuple[str, str], dict[str, Row]] = {}
        for row in mine:
            lines.setdefault((row["metric"], row["kind"]), {})[row["configuration"]] = row
        by_name = {row["configuration"]: row for row in mine}
        found.append(
            {
                "scenario": scenario,
                "condition": mine[0]["condition"] or "",
                "condition_id": condition_id,
                "columns": [
                    {
                        "name": name,
                        "config_id": by_name[name]["config_id"],
                        "valid": by_name[name]["n_valid"],
                        "runs": by_name[name]["n_runs"],
                    }
                    for name in names
                ],
                "lines": [_line(measures[key], cells, names) for key, cells in lines.items()],
            }
        )
    return found


def _of_encounters(row: Row) -> bool:
    return bool(row["kind"] == "encounter" and row["metric"] in _ENCOUNTER_ROWS)


def _line(measure: Measure, cells: Mapping[str, Row], names: Sequence[str]) -> dict[str, Any]:
    ends = [_ends(cells[name]) for name in names if name in cells]
    known = [value for end in ends for value in end if value is not None]
    low, high = min([0.0, *known]), max([0.0, *known])
    return {
        "text": label(measure, tail=measure.kind == "encounter"),
        "metric": measure.name,
        "group": measure.group,
        "worse": measure.worse,
        "cells": [_cell(cells.get(name), measure, low, high) for name in names],
    }


def _ends(row: Row) -> tuple[float | None, float | None, float | None]:
    """Return the value of a cell, a mean or the tail of encounters, and the ends of its interval."""
    if row["kind"] == "encounter":
        return (row[row["tail"]] if row["tail"] else None), row["tail95_lo"], row["tail95_hi"]
    return row["mean"], row["ci95_lo"], row["ci95_hi"]


def _cell(row: Row | None, measure: Measure, low: float, high: float) -> dict[str, Any] | None:
    if row is None:
        return None
    value, lo, hi = _ends(row)
    if value is None:
        return {"text": "–", "interval": row["status"].replace("_", " "), "place": None, "row": row}
    place = None
    if high > low:
        place = [None if one is None else 100.0 * (one - low) / (high - low) for one in (value, lo, hi)]
    interval = "" if lo is None or hi is None else f"{shown(lo, measure)} … {shown(hi, measure)}"
    return {"text": shown(value, measure), "interval": interval, "place": place, "row": row}


def comparison_blocks(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """Return a table of key measures for each scenario, setting and pair of configurations."""
    measures = measures_by_name()
    blocks: dict[tuple[Any, ...], list[dict[str, Any]]] = {}
    for row in rows:
        measure = measures.get((row["metric"], row["kind"]))
        if not row["key"] or measure is None:
            continue
        where = (row["scenario_id"], row["condition"] or "", row["condition_id"], row["base"], row["alt"])
        interval = "–"
        if row["ci95_lo"] is not None:
            interval = f"{shown(row['ci95_lo'], measure, '+')} … {shown(row['ci95_hi'], measure, '+')}"
        blocks.setdefault(where, []).append(
            {
                "text": label(measure),
                "metric": row["metric"],
                "base": shown(row["base_mean"], measure),
                "alt": shown(row["alt_mean"], measure),
                "difference": shown(row["diff_mean"], measure, "+"),
                "interval": interval,
                "p": p_value(row["p_holm"]),
                "pairs": row["n_pairs"],
                "needed": seeds_needed(row),
                "verdict": _WORDS.get(row["verdict"], row["verdict"]),
                "level": row["verdict"] if row["verdict"] in ("better", "worse") else "none",
            }
        )
    keys = ("scenario", "condition", "condition_id", "base", "alt")
    return [{**dict(zip(keys, where, strict=True)), "lines": lines} for where, lines in blocks.items()]


def label(measure: Measure, tail: bool = False) -> str:
    """Return the text of a line with its unit; shares are in percent, and rates name their denominator."""
    text = measure.text
    if tail:
        text += ", 5th percentile" if measure.worse == "lower" else ", 95th percentile"
    if measure.unit == "1" or measure.kind == "rate":
        return text
    return f"{text} [{pretty_unit(measure.unit)}]"


def pretty_unit(unit: str) -> str:
    """Return a unit with raised exponents.

    Examples
    --------
    >>> pretty_unit("m/s^2")
    'm/s²'
    """
    return unit.replace("^2", "²").replace("^3", "³")


def shown(value: float | None, measure: Measure, sign: str = "") -> str:
    """Return a number with about three digits, and never 0 for a number that is not 0; shares in percent."""
    if value is None:
        return "–"
    sign = sign if value else ""
    if measure.kind in _SHARES:
        return f"{value:{sign}.{decimals(100.0 * value, 1)}%}".replace("%", " %")
    return f"{value:{sign}.{decimals(value) if value else 0}f}"
