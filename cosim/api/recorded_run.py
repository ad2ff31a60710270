"""A recorded run, its tables and its figures."""

from __future__ import annotations

import io
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cosim.api.tables import as_input_errors, page_of, read_description, read_table
from cosim.errors import InputError
from cosim.presentation.numbers import read_row, shown_rows
from cosim.presentation.pictures import require_matplotlib

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame, Series

FIGURES = ("space-time", "plane", "traces")


@dataclass(frozen=True)
class Run:
    """One finished run: its folder, and the recorded and computed tables in it.

    A table is read when it is first used, and checked against the hash that was written with it.
    """

    folder: Path

    @cached_property
    def description(self) -> dict[str, Any]:
        """Content of ``run.json``: identity, versions, seed, parameters, validity, wall-clock times."""
        return read_description(self.folder)

    @property
    def scenario(self) -> str:
        """Name of the scenario."""
        return str(self.description["scenario_id"])

    @property
    def controller(self) -> str:
        """Name of the controller."""
        return str(self.description["controller"])

    @property
    def seed(self) -> int:
        """Seed of all random numbers."""
        return int(self.description["seed"])

    @property
    def valid(self) -> bool:
        """Whether the run went on to its end undisturbed."""
        return bool(self.description["valid"])

    @property
    def invalid_reason(self) -> str:
        """Why the run is not valid, in one line; empty for a valid run."""
        return str(self.description["invalid_reason"] or "")

    @cached_property
    def numbers(self) -> Series[Any]:
        """The run's row of ``runs.csv``; units are in the names."""
        return read_table(self.folder, "runs.csv").iloc[0]

    @cached_property
    def encounters(self) -> DataFrame:
        """One row per encounter (``encounters.csv``)."""
        return read_table(self.folder, "encounters.csv")

    @cached_property
    def egos(self) -> DataFrame:
        """One row per ego and step (``egos.parquet``)."""
        return read_table(self.folder, "egos.parquet")

    @cached_property
    def neighbours(self) -> DataFrame:
        """Pedestrians and vehicles near any ego, one row per object and step (``neighbours.parquet``)."""
        return read_table(self.folder, "neighbours.parquet")

    def table(self, name: str) -> DataFrame:
        """Return any other table of the folder, for instance ``timing.parquet``.

        Raises
        ------
        InputError
            If there is no such table; the message lists those that exist.
        """
        return read_table(self.folder, name)

    def plot(
        self, kind: str = "space-time", *, ego: str | None = None, encounter: int | None = None
    ) -> Figure:
        """Draw an ego's trip or one encounter.

        Parameters
        ----------
        kind
            ``space-time``: position along the ego's path over time; ``plane``: the scene on the map;
            ``traces``: speed, acceleration, steering and time to collision over time.
        ego
            Name of the ego; by default the first one.
        encounter
            ``encounter_id`` of the encounter; by default the whole trip is drawn.

        Raises
        ------
        InputError
            If the figure, ego or encounter is unknown, or matplotlib is not installed.
        """
        if kind not in FIGURES:
            raise InputError(f"plot: expected one of {', '.join(FIGURES)}, got {kind!r}")
        require_matplotlib("Run.plot")
        from analysis.encounters.recorded_case import read_case
        from analysis.plots.figures import FIGURES as DRAW
        from analysis.plots.scene import choose

        with as_input_errors():
            figure = DRAW[kind](choose(read_case(self.folder), ego, encounter))
        # So that a notebook shows the figure even if it was not told to show matplotlib's figures.
        setattr(figure, "_repr_png_", partial(_as_png, figure))  # noqa: B010  no such attribute is declared
        return figure

    def _repr_html_(self) -> str:
        title = f"{self.scenario} with {self.controller}, seed {self.seed}"
        if not self.valid:
            title += f" (invalid: {self.invalid_reason})"
        rows = shown_rows(read_row(self.folder)) if (self.folder / "runs.csv").is_file() else {}
        return page_of(title, {**rows, "folder": str(self.folder)})


def _as_png(figure: Figure) -> bytes:
    content = io.BytesIO()
    figure.savefig(content, format="png", dpi=100, metadata={"Software": None})
    return content.getvalue()
