"""Recorded rows without the repeated rows of standing vehicles, which are nearly all rows in a jam.

A row is a *repeat* if the rows of the same vehicle one recorded instant earlier and one later hold the same
values to the bit. The remaining rows determine every value at every instant.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Set
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from analysis.arrays import BoolArray, FloatArray, IntArray
from analysis.recording.columns import NEIGHBOURS
from analysis.recording.presence import PEDESTRIAN, VEHICLE
from analysis.recording.reading import Columns, checked_rows
from analysis.recording.row_groups import RowGroups, chosen_rows

ROWS_KEPT = 1_000_000
"""Number of rows of vehicles that are kept for the next part, at most."""
_ROW, _STEP, _LEFT_OUT = "row", "step", "left_out"


class WithoutRepeats:
    """The recorded rows of road users near egos, without repeats.

    Parameters
    ----------
    path : Path
        Path of the file, for error messages.
    file : pyarrow.parquet.ParquetFile
        The opened file, whose schema was checked.
    times : FloatArray
        All recorded instants [s].
    """

    def __init__(self, path: Path, file: pq.ParquetFile, times: FloatArray) -> None:
        self._path, self._times = path, times
        self._groups = RowGroups(path, NEIGHBOURS, file)
        rows = [file.metadata.row_group(number).num_rows for number in range(file.num_row_groups)]
        self._begins = np.cumsum([0, *rows])
        self._vehicles: OrderedDict[int, pa.Table] = OrderedDict()
        self._kept = 0

    def of(
        self, people: Set[str], of_people: range, vehicles: Set[str], of_vehicles: range
    ) -> tuple[Columns, IntArray]:
        """Return the rows of some pedestrians, and of some vehicles, each in some row groups.

        Returns
        -------
        rows
            In the order of the file.
        left_out
            Number of repeats left out between each row and the row before of the same vehicle.
        """
        nobody = self._numbered(self._groups.empty(), 0)
        tables = [nobody, *(self._some(number, people, PEDESTRIAN) for number in of_people)]
        moving = [nobody, *(self._moving(number, vehicles) for number in of_vehicles)]
        # Repeats are removed again, for vehicles that stand through several row groups.
        table = pa.concat_tables([*tables, _without_repeats(pa.concat_tables(moving))])
        table = table.take(pa.array(np.argsort(table[_ROW].to_numpy(), kind="stable")))
        left_out = table[_LEFT_OUT].to_numpy().astype(np.int64)
        return checked_rows(self._path, NEIGHBOURS, table.drop_columns([_ROW, _STEP, _LEFT_OUT])), left_out

    def _some(self, number: int, names: Set[str], kind: str) -> pa.Table:
        table = self._numbered(self._groups.table(number), int(self._begins[number]))
        return chosen_rows(table, {kind: names}, "object_kind", "object_id")

    def _moving(self, number: int, names: Set[str]) -> pa.Table:
        """Return the rows of some vehicles in a row group; the rows of all are kept for the next part."""
        known = self._vehicles.get(number)
        if known is None:
            table = self._numbered(self._groups.table(number), int(self._begins[number]))
            known = _without_repeats(table.filter(pc.equal(table["object_kind"], VEHICLE)))
            self._vehicles[number] = known
            self._kept += len(known)
        self._vehicles.move_to_end(number)
        while len(self._vehicles) > 1 and self._kept > ROWS_KEPT:
            self._kept -= len(self._vehicles.popitem(last=False)[1])
        return chosen_rows(known, {VEHICLE: names}, "object_kind", "object_id")

    def _numbered(self, table: pa.Table, begin: int) -> pa.Table:
        steps = np.searchsorted(self._times, np.round(table["time_s"].to_numpy(), 6))
        for name, values in (
            (_ROW, begin + np.arange(len(table))),
            (_STEP, steps),
            (_LEFT_OUT, np.zeros(len(table))),
        ):
            table = table.append_column(name, pa.array(values.astype(np.int64)))
        return table


def _without_repeats(table: pa.Table) -> pa.Table:
    """Return the rows of vehicles without repeats; some repeats may have been left out before."""
    if len(table) < 3:
        return table
    values = {name: _bits(table[name]) for name in table.column_names}
    step, left_out = values.pop(_STEP), values.pop(_LEFT_OUT)
    del values["time_s"], values[_ROW]
    order = np.lexsort((step, values["object_id"]))
    joined: BoolArray = np.diff(step[order]) == 1 + left_out[order[1:]]
    for column in values.values():
        joined &= column[order[1:]] == column[order[:-1]]
    kept = np.ones(len(table), dtype=np.bool_)
    kept[1:-1] = ~(joined[:-1] & joined[1:])
    rows = order[kept]
    gone = np.diff(np.flatnonzero(kept)) > 1
    left_out[rows[1:][gone]] = np.diff(step[rows])[gone] - 1
    table = table.set_column(table.column_names.index(_LEFT_OUT), _LEFT_OUT, pa.array(left_out))
    return table.take(pa.array(np.sort(rows)))


def _bits(column: pa.ChunkedArray) -> IntArray:
    """Return numbers that are equal where the values are equal to the bit; undefined values are equal."""
    array = column.combine_chunks()
    if pa.types.is_string(array.type):
        array = array.dictionary_encode().indices.fill_null(-1)
    values = array.to_numpy(zero_copy_only=False)
    if values.dtype.kind == "f":
        values = values.astype(np.float64).view(np.int64)
    return np.array(values, np.int64)
