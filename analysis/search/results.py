"""The tables of a search: trials, failures, unpreventable ones, kinds, influences and progress."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Any

from analysis.files import write_csv, write_json
from analysis.sealing import seal_tables
from analysis.search.axes import Axis, Point
from analysis.search.kinds import Failure, Kind, happening
from analysis.search.objective import Verdict
from analysis.search.sensitivity import Influence
from analysis.tables import column
from analysis.tables.cells import cells
from analysis.tables.column import Column, Table
from analysis.tables.datapackage import describe

PASS, FAIL, UNPREVENTABLE, UNDEFINED, INVALID = "pass", "fail", "unpreventable", "undefined", "invalid"
STATUSES = (PASS, FAIL, UNPREVENTABLE, UNDEFINED, INVALID)
PACKAGE = "datapackage.json"


@dataclass(frozen=True, slots=True)
class Tried:
    """One run of a trial."""

    number: int
    """Number of the trial, from 1."""
    seed: int
    point: Point
    verdict: Verdict
    invalid: str = ""
    trial_margin: float | None = None
    """Mean margin over the seeds of the trial, if there are several."""

    @property
    def status(self) -> str:
        """One of `STATUSES`."""
        if self.invalid:
            return INVALID
        if self.verdict.failed:
            return FAIL
        if self.verdict.unpreventable:
            return UNPREVENTABLE
        return UNDEFINED if self.verdict.margin is None else PASS

    @property
    def failure(self) -> Failure:
        """The run as a failure."""
        assert self.verdict.margin is not None
        return Failure(
            self.number,
            self.seed,
            self.point,
            self.verdict.margin,
            self.verdict.criterion,
            self.verdict.facts,
        )


@dataclass(frozen=True, slots=True)
class KindRow:
    """A kind of failures and what is known about it."""

    number: int
    kind: Kind
    scenario: str
    """Folder of its clearest failure, within the folder of the search."""
    command: str
    change: str = ""
    """Smallest change that leads back to success, in words."""
    change_runs: int = 0


def trial_margins(tried: Iterable[Tried]) -> tuple[list[Point], list[float]]:
    """Return the points of the trials and their margins, each the mean of its runs that have a margin."""
    runs: dict[int, list[Tried]] = {}
    for one in tried:
        if one.verdict.margin is not None:
            runs.setdefault(one.number, []).append(one)
    means = [fmean(one.verdict.margin or 0.0 for one in some) for some in runs.values()]
    return [some[0].point for some in runs.values()], means


def tried_rows(axes: Sequence[Axis], tried: Iterable[Tried]) -> list[dict[str, Any]]:
    """Return the rows of trials.csv."""
    return [
        {
            "trial": one.number,
            "seed": one.seed,
            "status": one.status,
            "margin": one.verdict.margin,
            "trial_margin": one.trial_margin,
            "criterion": one.verdict.criterion or None,
            **_facts(one.verdict.facts),
            "note": one.invalid or None,
            **{axis.name: one.point[axis.name] for axis in axes},
        }
        for one in tried
    ]


def write_results(
    folder: Path,
    axes: Sequence[Axis],
    tried: Sequence[Tried],
    kinds: Sequence[KindRow],
    influences: Sequence[Influence],
) -> None:
    """Write the tables of a search.

    Parameters
    ----------
    folder
    axes
    tried
        All runs in the order of the trials.
    kinds
    influences
        Empty if nothing is known about them.
    """
    kind_of = {(one.trial, one.seed): row for row in kinds for one in row.kind.failures}
    failures = []
    for run, row in zip(tried, tried_rows(axes, tried), strict=True):
        if run.status == FAIL and (found := kind_of.get((run.number, run.seed))):
            del row["status"], row["note"], row["trial_margin"]
            failures.append({"kind": found.number, "happening": happening(run.failure), **row})
    apart = [row for row in tried_rows(axes, tried) if row["status"] == UNPREVENTABLE]
    kind_rows = [
        {
            "kind": one.number,
            "name": one.kind.name,
            "n_failures": len(one.kind.failures),
            "trial": one.kind.worst.trial,
            "seed": one.kind.worst.seed,
            "margin": one.kind.worst.margin,
            "change_to_success": one.change or None,
            "n_runs_of_change": one.change_runs,
            "scenario": one.scenario,
            "command": one.command,
        }
        for one in kinds
    ]
    influence_rows = [
        {
            "parameter": one.axis,
            "first_order": one.first_order,
            "first_order_ci95": one.half_width,
        }
        for one in influences
    ]
    tables: list[tuple[Table, Sequence[Mapping[str, Any]]]] = [
        (trials_table(axes), tried_rows(axes, tried)),
        (failures_table(axes), failures),
        (unpreventable_table(axes), apart),
        (KINDS, kind_rows),
        (INFLUENCES, influence_rows),
        (PROGRESS, _progress(tried)),
    ]
    files = [
        write_csv(folder / table.file, table.names(), cells(table, rows, number="{:.6g}".format))
        for table, rows in tables
    ]
    files.append(write_json(folder / PACKAGE, describe([table for table, _ in tables], "a search")))
    seal_tables(folder, files)


def _progress(tried: Sequence[Tried]) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    smallest: float | None = None
    failures = 0
    for number, one in enumerate(tried, 1):
        margin = one.verdict.margin
        if margin is not None:
            smallest = margin if smallest is None else min(smallest, margin)
        failures += one.status == FAIL
        rows.append({"run": number, "trial": one.number, "smallest_margin": smallest, "n_failures": failures})
    return rows


_FACTS = (
    column.text("ped_id", "pedestrian of the encounter"),
    column.number("impact_speed_kmh", "km/h", "speed of the ego at the contact"),
    column.text("impact_side", "side of the ego that was touched"),
    column.text("contact_place", "where the contact was"),
    column.text("contact_moved_by", "whose motion closed the last gap"),
    column.number("clearance_min_m", "m", "smallest distance of the moving ego"),
    column.number("min_ttc_s", "s", "smallest time to collision"),
)


def _facts(facts: Mapping[str, str]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for one in _FACTS:
        text = facts.get(one.name, "")
        found[one.name] = None if not text else float(text) if one.kind == "number" else text
    return found


def _axes_columns(axes: Sequence[Axis]) -> tuple[Column, ...]:
    return tuple(
        Column(
            axis.name,
            "integer" if axis.whole else "number" if axis.numeric else "string",
            "" if not axis.numeric else "as its name",
            "value of the parameter",
            choices=axis.choices,
            required=True,
        )
        for axis in axes
    )


_TRIAL = column.count("trial", "number of the trial, from 1", required=True)
_SEED = column.count("seed", "seed of the run", required=True)
_MARGIN = column.number("margin", "1", "smallest margin of the criteria, −1 to 1, negative where violated")
_CRITERION = column.text("criterion", "criterion with that margin")


def trials_table(axes: Sequence[Axis]) -> Table:
    """Return the table of all runs."""
    columns = (
        _TRIAL,
        _SEED,
        column.text("status", "what became of the run", *STATUSES, required=True),
        _MARGIN,
        column.number("trial_margin", "1", "mean margin of the trial's seeds, where there are several"),
        _CRITERION,
        *_FACTS,
        column.text("note", "why there is no valid run"),
        *_axes_columns(axes),
    )
    return Table("trials", "One row for each run of a search", columns, ("trial", "seed"))


def failures_table(axes: Sequence[Axis]) -> Table:
    """Return the table of failures that count."""
    columns = (
        column.count("kind", "row of kinds.csv", required=True),
        _TRIAL,
        _SEED,
        _MARGIN,
        _CRITERION,
        column.text("happening", "what happened, in words", required=True),
        *_FACTS,
        *_axes_columns(axes),
    )
    return Table("failures", "One row for each preventable failure", columns, ("trial", "seed"))


def unpreventable_table(axes: Sequence[Axis]) -> Table:
    """Return the table of failures that a careful driver would not have prevented."""
    return Table(
        "unpreventable",
        "One row for each run with a failure that a careful driver would not have prevented",
        trials_table(axes).columns,
        ("trial", "seed"),
    )


TAKEN = frozenset((*trials_table(()).names(), *failures_table(()).names()))
"""Columns of these tables that are no parameters."""
KINDS = Table(
    "kinds",
    "One row for each kind of failures, the clearest first",
    (
        column.count("kind", "number", required=True),
        column.text("name", "what happened, and where in the space", required=True),
        column.count("n_failures", "runs of this kind", required=True),
        column.count("trial", "clearest failure", required=True),
        _SEED,
        column.number("margin", "1", "its margin", required=True),
        column.text("change_to_success", "smallest change of parameters that was found to make it pass"),
        column.count("n_runs_of_change", "runs that finding it took", required=True),
        column.text("scenario", "folder of its scenario", required=True),
        column.text("command", "makes the run again", required=True),
    ),
    ("kind",),
)
INFLUENCES = Table(
    "sensitivity",
    "How much each parameter decides the margin, from the trials that cover the space evenly",
    (
        column.text("parameter", "name", required=True),
        column.number("first_order", "1", "Sobol's first-order index", required=True),
        column.number("first_order_ci95", "1", "half width of its 95 % interval", required=True),
    ),
    ("parameter",),
)
PROGRESS = Table(
    "progress",
    "The search after each run",
    (
        column.count("run", "number of runs", required=True),
        _TRIAL,
        column.number("smallest_margin", "1", "smallest margin so far"),
        column.count("n_failures", "preventable failures so far", required=True),
    ),
    ("run",),
)
