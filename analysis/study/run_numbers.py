"""Reads the numbers of one run that are summarised over runs from its CSV files."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pa_csv

from analysis.arrays import FloatArray
from analysis.encounters.severity_scale import CONFLICTS
from analysis.errors import StudyError
from analysis.files import read_csv_rows
from analysis.manifest import read_verified
from analysis.metrics.deceleration_to_avoid_collision import BEYOND
from analysis.results.measures import encounter_measures
from analysis.results.origin import SCHEMA_VERSION
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.tables.column import Table
from analysis.thresholds import DRAC_LIMIT_MPS2, LOW_PET_S, LOW_TTC_S

_FLAGS, _TEXTS = ("entered", "collision", "preventable_r157"), ("drac_status", "severity")


def read_cells(path: Path) -> tuple[str, ...]:
    """Return the only row of a run's runs.csv; empty if there is no such file."""
    try:
        rows = read_csv_rows(path)
    except FileNotFoundError:
        return ()
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise StudyError(f"{path}: cannot be read ({error}); cosim analyse makes it again") from None
    if len(rows) != 2 or tuple(rows[0]) != RUNS.names() or len(rows[1]) != len(rows[0]):
        raise StudyError(
            f"{path}: expected one row with the columns of schema {SCHEMA_VERSION}; "
            "cosim analyse makes it again"
        )
    return tuple(rows[1])


def numbers_in(cells: Sequence[str]) -> dict[str, float]:
    """Return the numbers in a row of runs.csv; undefined ones are missing."""
    if not cells:
        return {}
    return {
        column.name: float(cell)
        for column, cell in zip(RUNS.columns, cells, strict=True)
        if column.kind in ("integer", "number") and cell
    }


def table_text(folder: Path, table: Table = ENCOUNTERS) -> str:
    """Return the content of one of a run's tables.

    Raises
    ------
    AnalysisError
        If it cannot be read, was changed after writing, or has other columns.
    """
    path = folder / table.file
    try:
        text = read_verified(path).decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise StudyError(f"{path}: cannot be read ({error}); cosim analyse makes it again") from None
    if text.partition("\n")[0] != ",".join(table.names()):
        raise StudyError(
            f"{path}: expected the columns of schema {SCHEMA_VERSION}; cosim analyse makes it again"
        )
    return text


def arrow_file(content: bytes) -> pa.BufferReader:
    """Return bytes as a file in Arrow's own memory.

    Arrow's threads release what they have read at any time. If that is Python's memory and the interpreter is
    ending, the process aborts.
    """
    sink = pa.BufferOutputStream()
    sink.write(content)
    return pa.BufferReader(sink.getvalue())


def tallies_and_samples(path: Path, text: str) -> tuple[dict[str, float], dict[str, FloatArray]]:
    """Return the tallies of a run's encounters and the defined values of the encounter measures."""
    names = [measure.name for measure in encounter_measures()]
    options = pa_csv.ConvertOptions(
        include_columns=[*_FLAGS, *_TEXTS, *names],
        column_types={
            **dict.fromkeys(names, pa.float64()),
            **dict.fromkeys(_FLAGS, pa.float64()),
            **dict.fromkeys(_TEXTS, pa.string()),
        },
        null_values=[""],
    )
    try:
        table = pa_csv.read_csv(arrow_file(text.encode()), convert_options=options)
    except (pa.ArrowException, KeyError) as error:
        told = str(error).splitlines()[0]
        raise StudyError(f"{path}: cannot be read ({told}); cosim analyse makes it again") from None
    values = {name: table.column(name).to_numpy() for name in (*names, *_FLAGS)}
    drac_status, severity = (np.array(table.column(name).to_pylist()) for name in _TEXTS)
    struck = values["collision"] == 1.0
    met = (values["entered"] == 1.0) | struck
    beyond = np.isin(drac_status, BEYOND) | (values["drac_max_mps2"] > DRAC_LIMIT_MPS2)
    tallies = {
        "met": met,
        "met_collision": struck,
        # An undefined value counts as preventable.
        "met_preventable": struck & (values["preventable_r157"] != 0.0),
        "met_ttc_lt_1p5": met & (values["min_ttc_s"] < LOW_TTC_S),
        "met_pet_lt_1p5": met & (values["pet_area_s"] < LOW_PET_S),
        "met_drac_gt_3p4": met & beyond,
        "met_conflict": met & np.isin(severity, CONFLICTS),
    }
    samples = {name: values[name][np.isfinite(values[name])] for name in names}
    return {name: float(flags.sum()) for name, flags in tallies.items()}, samples
