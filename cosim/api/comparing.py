"""``cosim.compare``: is one controller safer than another, and slower?"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from cosim.api.recorded_run import Run
from cosim.api.study import Study
from cosim.api.tables import page_of
from cosim.errors import InputError
from cosim.presentation.comparison import CompareRequest, compare_runs
from cosim.presentation.comparison import Comparison as Compared
from cosim.presentation.wording import notes, sentence

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True)
class Comparison:
    """Two controllers on the same seeds."""

    compared: Compared

    @cached_property
    def table(self) -> DataFrame:
        """One row per measure and scenario: both means, difference, interval, p value, verdict."""
        from pandas import DataFrame

        return DataFrame([dict(row) for one in self.compared.tables for row in one.rows])

    @property
    def sentences(self) -> tuple[str, ...]:
        """The answer in words, one sentence per scenario."""
        return tuple(sentence(one.rows, self.compared.measures) for one in self.compared.tables)

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes that help to read the table."""
        return tuple(line for one in self.compared.tables for line in notes(one.rows, one.pairs, one.runs))

    def __str__(self) -> str:
        return "\n".join(self.sentences)

    def _repr_html_(self) -> str:
        names = ("scenario_id", "metric", "base_mean", "alt_mean", "diff_mean", "ci95_lo", "ci95_hi")
        table = self.table[[*names, "p_holm", "verdict"]]
        shown = table.to_html(index=False, float_format="{:.3g}".format, na_rep="–")
        below = "".join(f"<p>{escape(line)}</p>" for line in self.notes)
        return page_of(" ".join(self.sentences), {}, shown + below)


def compare(
    runs: str | PathLike[str] | Study | Iterable[Run],
    *,
    alt: str,
    base: str = "sumo",
    metrics: Iterable[str] = (),
    scenario: str | None = None,
    each: bool = False,
) -> Comparison:
    """Compare two controllers on the seeds that both have.

    Parameters
    ----------
    runs
        A study, a folder that contains runs, or runs.
    alt, base
        Controllers, optionally with the parameters that distinguish them from their variants
        (``vo_mpc steps=20``).
    metrics
        Measures to compare; by default the key measures.
    scenario
        Name of the only scenario to compare; by default all scenarios are.
    each
        Whether to make one table per setting of a scenario instead of one for all settings.

    Raises
    ------
    InputError
        If there is no such controller, measure or scenario, or no seed in common.
    """
    folder, chosen = _folders(runs)
    request = CompareRequest(folder, alt, base, tuple(metrics), scenario, each, chosen)
    return Comparison(compare_runs(request))


def _folders(runs: str | PathLike[str] | Study | Iterable[Run]) -> tuple[Path, tuple[Path, ...] | None]:
    """Return the folder that messages name, and the runs; ``None`` for all below the folder."""
    if isinstance(runs, Study):
        return runs.folder, None
    if isinstance(runs, str | PathLike):
        return Path(runs), None
    found = tuple(runs)
    if not found or not all(isinstance(one, Run) for one in found):
        raise InputError("compare: expected runs, a study or a folder; got no run or something else")
    return found[0].folder.parent, tuple(one.folder for one in found)
