"""Writes the ranking of a network's crossings into the folder of its study."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from analysis.files import write_csv, write_json
from analysis.screening import geojson
from analysis.screening.changes import CHANGES, change_rows
from analysis.screening.counts import Counts, read_counts
from analysis.screening.crossings_table import CROSSINGS, crossing_rows
from analysis.screening.ranking import BY_RISK, rank
from analysis.sealing import seal
from analysis.tables.cells import Row, cells
from analysis.tables.datapackage import describe

PACKAGE = "crossings.datapackage.json"
CHANGES_PACKAGE = "crossing_changes.datapackage.json"


@dataclass(frozen=True, slots=True)
class Screened:
    """The ranked crossings of a network."""

    rows: Sequence[Row]
    """As in crossings.csv."""
    counts: Counts
    files: Sequence[Path]

    @property
    def seeds(self) -> Sequence[int]:
        """Seeds of the valid runs."""
        return self.counts.seeds


def write_ranking(folder: Path, least_pedestrians: float, by: str = BY_RISK) -> Screened:
    """Rank the crossings of a study, and write crossings.csv, its dictionary and crossings.geojson.

    Parameters
    ----------
    folder
        Folder of a study whose runs recorded everybody.
    least_pedestrians
        A crossing with fewer pedestrians in all runs is listed, but not ranked.
    by
        One of ``RANK_BY``.

    Raises
    ------
    StudyError
        If no valid run recorded everybody.
    OSError
        If a file cannot be read or written.
    """
    counts = read_counts(folder)
    ranking = rank(counts.counted(), least_pedestrians, by)
    rows = crossing_rows(counts, ranking)
    files = [
        write_csv(folder / CROSSINGS.file, CROSSINGS.names(), cells(CROSSINGS, rows)),
        write_json(folder / PACKAGE, describe([CROSSINGS], "the crossings of a network")),
    ]
    collection = geojson.features(rows)
    removed = []
    if collection is not None:
        files.append(write_json(folder / geojson.FILE, collection))
    else:
        removed.append(folder / geojson.FILE)
        removed[0].unlink(missing_ok=True)
    seal(folder, files, removed)
    return Screened(rows, counts, files)


@dataclass(frozen=True, slots=True)
class Changed:
    """What an alternative changes."""

    rows: Sequence[Row]
    """As in crossing_changes.csv."""
    files: Sequence[Path]


def write_changes(folder: Path, base: Counts, alt: Counts) -> Changed:
    """Compare an alternative with the base, and write crossing_changes.csv and its dictionary.

    Parameters
    ----------
    folder
        Folder of the base.
    base, alt
        Counts of the runs of each.

    Raises
    ------
    StudyError
        If they have no valid seed or no crossing in common.
    OSError
        If a file cannot be written.
    """
    rows = change_rows(base, alt)
    files = [
        # As in comparisons.csv, so that a p value below 0.0000005 is not written as 0.
        write_csv(folder / CHANGES.file, CHANGES.names(), cells(CHANGES, rows, number="{:.6g}".format)),
        write_json(folder / CHANGES_PACKAGE, describe([CHANGES], "what an alternative changes")),
    ]
    seal(folder, files, [])
    return Changed(rows, files)
