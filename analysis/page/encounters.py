"""The encounters of a study: all of them for the distributions, and the worst of them for the lists."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv as pa_csv

from analysis.arrays import FloatArray
from analysis.encounters.severity_scale import LEVELS
from analysis.errors import StudyError
from analysis.files import as_given
from analysis.results.run_tables import ENCOUNTERS
from analysis.results.traffic_rows import TRAFFIC_ENCOUNTERS
from analysis.study.design import Study
from analysis.study.runs import StudyRun

SEVERITIES = LEVELS[::-1]
"""All severities, the worst first."""
_NUMBERS = (
    "encounter_id",
    "t_start_s",
    "entered",
    "min_ttc_s",
    "pet_area_s",
    "clearance_min_m",
    "min_dist_m",
    "t_min_dist_s",
    "t_min_ttc_s",
    "ego_max_decel_mps2",
    "impact_speed_kmh",
    "ped_delay_s",
    "preventable_r157",
)
_TEXTS = ("ego_id", "ped_id", "crossing_id", "severity", "contact_place", "contact_class")


@dataclass(frozen=True, slots=True)
class Listing:
    """The table of a run that lists encounters, and its names for the page's columns."""

    file: str
    renamed: Mapping[str, str]

    def name(self, column: str) -> str:
        """Return the table's name for a column of the page."""
        return self.renamed.get(column, column)


OF_EGOS = Listing(ENCOUNTERS.file, {})
OF_TRAFFIC = Listing(
    TRAFFIC_ENCOUNTERS.file, {"encounter_id": "traffic_encounter_id", "ego_id": "vehicle_id"}
)


@dataclass(frozen=True, slots=True)
class Found:
    """One row of a table of encounters, and its run."""

    run: StudyRun
    values: Mapping[str, Any]
    """Numbers and texts; ``None`` where the cell is empty."""

    @property
    def number(self) -> int:
        """Number of the encounter within the run."""
        return int(self.values["encounter_id"])

    @property
    def key(self) -> str:
        """Name of the replay."""
        return f"{self.run.run_id}-{self.number}"

    @property
    def contact(self) -> str:
        """Kind of the contact in a few words; empty if there was no contact."""
        if not self.values["contact_class"]:
            return ""
        kind = {"ego": ""}.get(self.values["contact_class"], self.values["contact_class"])
        spared = {0.0: "not preventable"}.get(self.values["preventable_r157"], "preventable")
        words = (self.values["contact_place"], kind, spared)
        return ", ".join(word.replace("_", " ") for word in words if word)

    @property
    def moment_s(self) -> float:
        """Time of the worst moment: that of the smallest TTC, or without one of the smallest distance [s]."""
        at = self.values["t_min_ttc_s"]
        return float(self.values["t_min_dist_s"] if at is None else at)


@dataclass(frozen=True, slots=True)
class Encounters:
    """All encounters of the valid runs of a study, as columns."""

    runs: Sequence[StudyRun]
    owner: np.ndarray[Any, np.dtype[np.int64]]
    """Index of each encounter's run."""
    numbers: Mapping[str, FloatArray]
    texts: Mapping[str, Sequence[str]]

    def __len__(self) -> int:
        return len(self.owner)

    def at(self, row: int) -> Found:
        """Return one encounter."""
        numbers = {name: float(values[row]) for name, values in self.numbers.items()}
        values: dict[str, Any] = {
            name: value if np.isfinite(value) else None for name, value in numbers.items()
        }
        values |= {name: column[row] for name, column in self.texts.items()}
        return Found(self.runs[int(self.owner[row])], values)


def read_encounters(study: Study, listing: Listing = OF_EGOS) -> Encounters:
    """Read the encounters of every valid run.

    Raises
    ------
    StudyError
        If a file cannot be read.
    """
    runs = [run for run in study.runs if run.valid]
    tables = [_read(run.folder / listing.file, listing) for run in runs]
    owner = np.repeat(np.arange(len(runs)), [len(table) for table in tables])
    whole = pa.concat_tables(tables) if tables else None
    if whole is None:
        return Encounters([], owner.astype(np.int64), dict.fromkeys(_NUMBERS, np.zeros(0)), {})
    return Encounters(
        runs,
        owner.astype(np.int64),
        {name: whole.column(name).to_numpy() for name in _NUMBERS},
        {name: [as_given(text or "") for text in whole.column(name).to_pylist()] for name in _TEXTS},
    )


def _read(path: Path, listing: Listing) -> pa.Table:
    kinds = {**dict.fromkeys(_NUMBERS, pa.float64()), **dict.fromkeys(_TEXTS, pa.string())}
    options = pa_csv.ConvertOptions(
        include_columns=[listing.name(column) for column in kinds],
        column_types={listing.name(column): kind for column, kind in kinds.items()},
        null_values=[""],
        strings_can_be_null=True,
    )
    try:
        return pa_csv.read_csv(path, convert_options=options).rename_columns(list(kinds))
    except (OSError, pa.ArrowException, KeyError) as error:
        raise StudyError(f"{path}: cannot be read ({str(error).splitlines()[0]})") from None


def worst_first(found: Encounters) -> list[int]:
    """Return the rows, the worst first: by severity, then TTC, then clearance, then distance.

    An encounter without a TTC or a clearance comes after those of its severity that have one.
    """
    if len(found) == 0:
        return []
    rank = np.array([SEVERITIES.index(text) for text in found.texts["severity"]])
    keys = [
        np.where(np.isfinite(found.numbers[name]), found.numbers[name], np.inf)
        for name in ("min_dist_m", "clearance_min_m", "min_ttc_s")
    ]
    # Ties are broken by run and number, which have a fixed order since they were read.
    return [int(row) for row in np.lexsort((np.arange(len(found)), *keys, rank))]


def pick(order: Iterable[int], found: Encounters, study: Study, most: int, of_each: int) -> list[int]:
    """Return the rows to list in order: the worst of all, and the worst of each configuration and setting."""
    rows = list(order)
    chosen = set(rows[:most])
    seen: dict[tuple[str, str], int] = {}
    for row in rows:
        run = found.runs[int(found.owner[row])]
        where = (study.label(run), run.condition_id)
        seen[where] = seen.get(where, 0) + 1
        if seen[where] <= of_each:
            chosen.add(row)
    return [row for row in rows if row in chosen]
