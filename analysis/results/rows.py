"""Makes the rows of a run's CSV files from the cases of its parts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, overload

import numpy as np

from analysis.arrays import IntArray
from analysis.encounters.case import Case, Values
from analysis.encounters.whole_run import Gathering, WholeRun
from analysis.errors import MetricError
from analysis.recording.reading import RecordedRun
from analysis.results import encounter_description, run_description
from analysis.results.encounter_description import ListedEncounter
from analysis.results.metric_catalog import Metric, find_metrics
from analysis.results.numbered_rows import numbered_rows
from analysis.results.origin import Origin
from analysis.results.overlap_rows import VEHICLE_OVERLAPS
from analysis.results.run_description import ListedRun
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.results.vehicle_conflict_rows import VEHICLE_CONFLICTS
from analysis.tables.cells import Row, plain
from analysis.tables.column import Column, row_of
from analysis.thresholds import Thresholds

_NUMBER = "encounter_id"


class Judgement:
    """Judges the parts of a run one after the other, and keeps only what the rows need.

    Parameters
    ----------
    run : RecordedRun
        The run, as :class:`analysis.recording.rides.Rides` provides it.
    thresholds : Thresholds
    metrics : Sequence
        The metrics to compute; those of the catalogue by default.
    """

    def __init__(
        self, run: RecordedRun, thresholds: Thresholds, metrics: Sequence[Metric] | None = None
    ) -> None:
        self._origin = Origin(run.meta)
        self._metrics = find_metrics() if metrics is None else metrics
        self._gathering = Gathering(run, thresholds)
        self._described: list[Row] = []
        self._measured: dict[str, dict[str, list[Any]]] = {metric.name: {} for metric in self._metrics}
        self._collected: dict[str, dict[str, list[Any]]] = {metric.name: {} for metric in self._metrics}

    def add_rides(self, case: Case, rows: IntArray) -> None:
        """Judge the rides of a part; ``rows`` are the indices of its egos among all egos."""
        self._gathering.add_rides(case, rows)
        for metric in self._metrics:
            self._collect(metric, metric.collect_rides, case)

    def add_encounters(self, case: Case, rows: IntArray) -> None:
        """Judge the encounters of a case of a part; ``rows`` as for :meth:`add_rides`.

        Raises
        ------
        MetricError
            If a metric returns a column that it does not declare, or a number of values that differs from the
            number of encounters.
        """
        self._gathering.add_encounters(case, rows)
        for index in range(len(case)):
            listed = ListedEncounter(self._origin, case, index)
            self._described.append(row_of(encounter_description.COLUMNS, listed))
        for metric in self._metrics:
            if metric.columns:
                for name, values in of_encounters(metric, case).items():
                    self._measured[metric.name].setdefault(name, []).append(values)
            self._collect(metric, metric.collect_encounters, case)

    def _collect(self, metric: Metric, collect: Callable[[Case], Values] | None, case: Case) -> None:
        if collect is not None:
            for name, values in collect(case).items():
                self._collected[metric.name].setdefault(name, []).extend(values)

    def judged(self) -> JudgedRun:
        """Return the judged run after all parts were added.

        Raises
        ------
        MetricError
            If a metric returns a column that it does not declare.
        """
        order, whole = self._gathering.order(), self._gathering.whole()
        columns: dict[str, Any] = {}
        summary: dict[str, Any] = {}
        for metric in self._metrics:
            own = {name: _joined(parts, order) for name, parts in self._measured[metric.name].items()}
            columns.update(own)
            if metric.summarise is not None:
                found = metric.summarise(whole, {**own, **self._collected[metric.name]})
                summary.update(_declared(metric, "RUN_COLUMNS", metric.run_columns, found))
        described = [self._described[index] for index in order.tolist()]
        return JudgedRun(self._origin, whole, order, EncounterRows(described, columns), summary)


class JudgedRun:
    """The results of a run.

    Parameters
    ----------
    origin : Origin
    whole : WholeRun
    order : IntArray
        Indices of the encounters as they were added, from 0, in the order of the run.
    encounters : Sequence
        Rows of encounters.csv.
    summary : Mapping
        The metrics' values for the run.
    """

    def __init__(
        self,
        origin: Origin,
        whole: WholeRun,
        order: IntArray,
        encounters: EncounterRows,
        summary: Mapping[str, Any],
    ) -> None:
        self._origin, self.whole, self.order, self.encounters = origin, whole, order, encounters
        self.summary = summary

    def run_row(self) -> Row:
        """Return the row of runs.csv."""
        described = row_of(run_description.COLUMNS, ListedRun(self._origin, self.whole))
        return plain(RUNS, {**described, **self.summary})

    def overlap_rows(self) -> Sequence[Row]:
        """Return the rows of vehicle_overlaps.csv."""
        return numbered_rows(VEHICLE_OVERLAPS, self._origin, self.whole.overlaps)

    def conflict_rows(self) -> Sequence[Row]:
        """Return the rows of vehicle_conflicts.csv."""
        return numbered_rows(VEHICLE_CONFLICTS, self._origin, self.whole.vehicle_conflicts)


class EncounterRows(Sequence[Row]):
    """The rows of encounters.csv, each made only on demand because a long run has very many.

    Parameters
    ----------
    described : Sequence
        For each encounter, the columns that are not metrics.
    columns : Mapping
        The metrics' columns.
    """

    def __init__(self, described: Sequence[Row], columns: Values) -> None:
        self._described, self.columns = described, columns

    def __len__(self) -> int:
        return len(self._described)

    @overload
    def __getitem__(self, index: int) -> Row: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Row]: ...
    def __getitem__(self, index: int | slice) -> Row | Sequence[Row]:
        numbers = range(len(self))[index]
        return self._row(numbers) if isinstance(numbers, int) else [self._row(one) for one in numbers]

    def __iter__(self) -> Iterator[Row]:
        return map(self._row, range(len(self)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and list(self) == list(other)

    __hash__ = None  # type: ignore[assignment]

    def _row(self, index: int) -> Row:
        measured = {name: values[index] for name, values in self.columns.items()}
        return plain(ENCOUNTERS, {**self._described[index], _NUMBER: index + 1, **measured})


def measure(metric: Metric, case: Case) -> tuple[Values, Values]:
    """Return a metric's columns of all encounters and its values for the run, from a case of the whole run.

    Raises
    ------
    MetricError
        If it returns a column that it does not declare, or a number of values that differs from the number of
        encounters.
    """
    judgement = Judgement(case.run, case.thresholds, [metric])
    rows = np.arange(len(case.run.egos))
    judgement.add_rides(case, rows)
    judgement.add_encounters(case, rows)
    judged = judgement.judged()
    return judged.encounters.columns, judged.summary


def of_encounters(metric: Metric, case: Case) -> Values:
    """Return the encounter columns of a metric for all encounters of a case.

    Raises
    ------
    MetricError
        As for `measure`.
    """
    if metric.compute is None:
        return {}
    values = metric.compute(case)
    for name, column in _declared(metric, "COLUMNS", metric.columns, values).items():
        if len(column) != len(case):
            raise MetricError(
                f"metric {metric.name}: {len(column)} values of {name} for {len(case)} encounters"
            )
    return values


def _declared(metric: Metric, where: str, columns: Sequence[Column], values: Values) -> Values:
    if foreign := sorted(set(values) - {column.name for column in columns}):
        raise MetricError(f"metric {metric.name}: its {where} do not declare {', '.join(foreign)}")
    return values


def _joined(parts: Sequence[Any], order: IntArray) -> Any:
    """Return the values of all parts in the order of the run: an array if all are arrays, else a list."""
    some = [one for one in parts if len(one)] or parts[:1]
    if all(isinstance(one, np.ndarray) for one in some):
        return np.concatenate(some)[order]
    joined = [value for one in some for value in one]
    return [joined[index] for index in order.tolist()]
