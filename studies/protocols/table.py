"""The verdicts of a suite as ``protocol.csv``, and its scores."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from analysis.errors import AnalysisError
from analysis.files import read_csv_rows, write_csv
from analysis.protocols.verdict import Verdict

FILE = "protocol.csv"
COLUMNS = (
    *("suite", "case", "group", "controller", "seed", "ego_speed_kmh", "pedestrian", "share"),
    *("contact", "impact_speed_kmh", "colour", "points", "passed", "preventable_r157", "counts"),
    *("max_deceleration_mps2", "valid", "note"),
)


@dataclass(frozen=True, slots=True)
class Row:
    """One test of one controller."""

    suite: str
    case: str
    group: str
    controller: str
    seed: int
    ego_speed_kmh: float
    pedestrian: str
    share: str
    """Part of a rating that the case belongs to; empty if there is no rating."""
    verdict: Verdict | None
    """The verdict; ``None`` without a valid run."""
    note: str = ""

    def cells(self) -> list[str]:
        """Return the cells as written: 0 and 1 for no and yes, empty if undefined."""
        verdict = self.verdict
        about: list[str] = [""] * 8
        if verdict is not None:
            about = [
                str(int(verdict.contact)),
                _number(verdict.impact_speed_kmh, 2),
                verdict.colour,
                _number(verdict.points, 2),
                str(int(verdict.passed)),
                str(int(verdict.preventable)),
                str(int(verdict.counts)),
                _number(verdict.max_deceleration_mps2, 3),
            ]
        return [
            *(self.suite, self.case, self.group, self.controller, str(self.seed)),
            *(f"{self.ego_speed_kmh:g}", self.pedestrian, self.share),
            *about,
            str(int(verdict is not None)),
            self.note if verdict is None else verdict.note,
        ]


def write(folder: Path, rows: Iterable[Row]) -> Path:
    """Write ``protocol.csv`` and return its path."""
    return write_csv(folder / FILE, COLUMNS, [row.cells() for row in rows])


def read(path: Path) -> list[dict[str, str]]:
    """Return the rows of a ``protocol.csv``.

    Raises
    ------
    AnalysisError
        If the file cannot be read, or has other columns.
    """
    try:
        heads, *rows = read_csv_rows(path) or [[]]
    except OSError as error:
        raise AnalysisError(f"{path}: cannot be read: {error.strerror}") from error
    if tuple(heads) != COLUMNS or any(len(row) != len(COLUMNS) for row in rows):
        raise AnalysisError(f"{path}: other columns than {', '.join(COLUMNS)}")
    return [dict(zip(COLUMNS, row, strict=True)) for row in rows]


def score(shares: Sequence[float], most: float) -> float:
    """Return the points of cases with equal weights: ``most`` times the mean of their shares.

    Parameters
    ----------
    shares : share of each case's points, 0 without a valid run
    most : highest points that the cases give together

    >>> score([1.0, 0.25], 2.0)
    1.25
    """
    return most * sum(shares) / len(shares)


def _number(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:.{digits}f}"
