"""The folder of a study, with the tables over all its runs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from analysis.study.runs import find_run_folders
from cosim.api.recorded_run import Run
from cosim.api.tables import page_of, read_table

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True)
class Study:
    """The folder of a batch, or any folder that contains run folders; iterating over it gives the runs."""

    folder: Path
    problems: tuple[str, ...] = ()
    """Why the batch is not complete, one line each; empty if it is complete and all runs are valid."""

    @cached_property
    def runs(self) -> DataFrame:
        """One row per run (``runs.csv``)."""
        return read_table(self.folder, "runs.csv")

    @cached_property
    def encounters(self) -> DataFrame:
        """One row per encounter of any run (``encounters.csv``)."""
        return read_table(self.folder, "encounters.csv")

    @cached_property
    def configurations(self) -> DataFrame:
        """One row per configuration, with intervals over its seeds (``configs.csv``)."""
        return read_table(self.folder, "configs.csv")

    @cached_property
    def comparisons(self) -> DataFrame:
        """Paired comparisons of controllers, corrected for their number (``comparisons.csv``)."""
        return read_table(self.folder, "comparisons.csv")

    def __iter__(self) -> Iterator[Run]:
        return (Run(folder) for folder in find_run_folders(self.folder))

    def __len__(self) -> int:
        return len(find_run_folders(self.folder))

    def _repr_html_(self) -> str:
        table = ""
        if (self.folder / "configs.csv").is_file():
            shown = [one for one in ("scenario_id", "controller", "n_runs") if one in self.configurations]
            table = self.configurations[shown].to_html(index=False) if shown else ""
        rows = {"runs": str(len(self)), "folder": str(self.folder)}
        rows |= {f"problem {number}": text for number, text in enumerate(self.problems, 1)}
        return page_of("Study", rows, table)
