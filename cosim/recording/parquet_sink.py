"""Writes rows to a Parquet file in chunks, so that the use of memory does not grow with a run's length."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from cosim.errors import lacks_memory
from cosim.processes import uninterrupted

Column = Sequence[Any] | NDArray[np.float64]

PART = ".part"
"""Suffix of a table in progress: a stream of record batches, which is readable wherever it breaks off."""
NEW = ".new"
"""Suffix of the Parquet file until it is complete."""
AT_RISK = 32
"""A crash of the process loses at most the rows of one chunk divided by this."""
ROWS_PER_CHUNK = 8192
_REPEATED = 3
"""Numbers that occur more often than this on average are stored with a dictionary."""


class ParquetSink:
    """Writes one table to disk.

    Rows go to ``<path>.part``, and ``close`` converts that to the final file. A file with its final name is
    therefore always complete; if rows could not be written, the part remains a part. The bytes depend on
    the rows alone. `recover` converts the part that a crashed process left behind.
    """

    def __init__(self, path: Path, schema: pa.Schema, rows_per_chunk: int = ROWS_PER_CHUNK) -> None:
        self._path = path
        self._part = path.with_name(path.name + PART)
        self._schema = schema
        self._rows_per_chunk = rows_per_chunk
        self._blocks: list[Sequence[Column]] = []
        """Rows to write, as columns; an interrupt finds a block added or not, never half of it."""
        self._rows: list[Sequence[Any]] = []
        self._waiting = 0
        self._in_chunk = 0
        self._batches = 1
        self._chunk_ends: list[int] = []
        """Number of batches written at the end of each chunk of the file."""
        self._file = pa.OSFile(str(self._part), "wb")
        self._stream = pa.ipc.new_stream(self._file, schema)
        self._open = True
        self._whole = True
        """Whether no write has failed so far."""
        # The schema is written with the first batch, so that an empty table is valid, too.
        try:
            self._write([pa.array([], type=field.type) for field in schema])
        except OSError:
            self.close()
            raise

    def add_row(self, row: Sequence[Any]) -> None:
        """Add one row with its values in the order of the schema."""
        self._check_width(len(row))
        self._rows.append(row)
        self._count(1)

    def add_columns(self, columns: Sequence[Column]) -> None:
        """Add rows given as columns of equal length, in the order of the schema."""
        self._check_width(len(columns))
        count = len(columns[0])
        if any(len(column) != count for column in columns):
            lengths = [len(column) for column in columns]
            raise ValueError(f"{self._path.name}: expected columns of one length, got {lengths}")
        if count == 0:
            return
        if self._rows:
            with uninterrupted():
                self._add_block_of_rows()
        # The caller may overwrite the array before it is written.
        self._blocks.append(
            [column.copy() if isinstance(column, np.ndarray) else column for column in columns]
        )
        self._count(count)

    def close(self) -> None:
        """Write the remaining rows and make the file; a second call does nothing.

        Raises
        ------
        OSError
            If there is no room for the rows or the file.
        MemoryError
            If there is not enough memory to make the file; the rows already written are kept.
        """
        if not self._open:
            return
        with uninterrupted():
            self._open = False
            try:
                if self._whole:
                    self._flush()
            finally:
                with closing(self._file):
                    self._stream.close()
            if self._whole:
                _convert(self._part, self._path, self._chunk_ends, self._rows_per_chunk, self._batches)

    def _check_width(self, width: int) -> None:
        if width != len(self._schema):
            raise ValueError(f"{self._path.name}: expected {len(self._schema)} columns, got {width}")

    def _count(self, rows: int) -> None:
        self._waiting += rows
        self._in_chunk += rows
        if self._in_chunk >= self._rows_per_chunk:
            with uninterrupted():
                self._flush()
                self._chunk_ends.append(self._batches)
                self._in_chunk = 0
        elif self._waiting * AT_RISK >= self._rows_per_chunk:
            with uninterrupted():
                self._flush()

    def _add_block_of_rows(self) -> None:
        """Turn the rows that were added one by one into columns."""
        if self._rows:
            self._blocks.append(list(zip(*self._rows, strict=True)))
            self._rows = []

    def _flush(self) -> None:
        self._add_block_of_rows()
        if not self._blocks:
            return
        pieces = list(zip(*self._blocks, strict=True))
        self._blocks = []
        self._waiting = 0
        self._write([_array(column, field.type) for column, field in zip(pieces, self._schema, strict=True)])
        self._batches += 1

    def _write(self, arrays: Sequence[pa.Array]) -> None:
        self._whole = False
        self._stream.write_batch(pa.RecordBatch.from_arrays(arrays, schema=self._schema))
        self._whole = True


def recover(part: Path) -> None:
    """Make the file of a table from what a crashed process had written.

    Parameters
    ----------
    part : the ``<path>.part`` of the table

    Raises
    ------
    ArrowInvalid
        If not even the beginning of the part was written.
    OSError
        If the file cannot be written; the part is kept.
    MemoryError
        Likewise.
    """
    _convert(part, part.with_name(part.name.removesuffix(PART)), (), ROWS_PER_CHUNK)


def _convert(
    part: Path, path: Path, chunk_ends: Sequence[int], rows_per_chunk: int, batches: int | None = None
) -> None:
    """Make a Parquet file of a stream of record batches, and remove the stream.

    Parameters
    ----------
    part, path : the stream, and the file to make
    chunk_ends : number of batches before each end of a chunk; after the last one, a chunk ends as soon as
        it has ``rows_per_chunk`` rows
    batches : expected number of batches; ``None`` for as many as are complete

    Raises
    ------
    OSError
        If the file is not complete; it does not get its final name then, and the stream is kept.
    MemoryError
        Likewise.
    """
    unfinished = path.with_name(path.name + NEW)
    try:
        _copy(part, unfinished, set(chunk_ends), rows_per_chunk, batches)
        unfinished.replace(path)
    except OSError as error:
        if lacks_memory(error):
            raise MemoryError(str(error)) from error
        raise
    finally:
        unfinished.unlink(missing_ok=True)
    part.unlink()


def _copy(part: Path, to: Path, ends: set[int], rows_per_chunk: int, batches: int | None) -> None:
    """Write the batches of a stream to a Parquet file, and check that it holds all of them."""
    rows = count = 0
    with pa.OSFile(str(part), "rb") as file:
        stream = pa.ipc.open_stream(file)
        with ExitStack() as stack:
            writer: pq.ParquetWriter | None = None
            waiting: list[pa.RecordBatch] = []

            def write() -> None:
                nonlocal writer
                chunk = pa.Table.from_batches(waiting, stream.schema).combine_chunks()
                waiting.clear()
                if writer is None:
                    writer = stack.enter_context(_writer(to, chunk))
                if len(chunk):
                    writer.write_table(chunk)

            for count, batch in enumerate(_whole(stream), start=1):
                waiting.append(batch)
                rows += batch.num_rows
                if count in ends or sum(one.num_rows for one in waiting) >= rows_per_chunk:
                    write()
            if waiting or writer is None:
                write()
    try:
        complete = pq.read_metadata(to).num_rows == rows and count >= (batches or 0)
    except pa.ArrowInvalid:
        complete = False
    if not complete:
        raise OSError(f"{to.name} is not complete: {part.name} was cut short")


def _writer(to: Path, first: pa.Table) -> pq.ParquetWriter:
    """Return a writer; columns whose numbers seldom repeat in the first chunk get no dictionary."""
    repeated = [
        field.name
        for field in first.schema
        if not pa.types.is_floating(field.type)
        or pc.count_distinct(first[field.name]).as_py() * _REPEATED < len(first)
    ]
    return pq.ParquetWriter(
        to,
        first.schema,
        version="2.6",
        compression="zstd",
        compression_level=6,
        use_dictionary=repeated,
        write_page_checksum=True,
    )


def _whole(stream: Any) -> Iterator[pa.RecordBatch]:
    """Yield the batches of a stream up to the first incomplete one."""
    while True:
        try:
            yield stream.read_next_batch()
        except (StopIteration, pa.ArrowInvalid, OSError):
            return


def _array(pieces: Sequence[Column], kind: pa.DataType) -> pa.Array:
    """Return a column made of its pieces; if all are arrays, numbers are not converted one by one."""
    arrays = [piece for piece in pieces if isinstance(piece, np.ndarray)]
    if len(arrays) == len(pieces):
        return pa.array(np.concatenate(arrays), type=kind)
    if len(pieces) == 1:
        return pa.array(pieces[0], type=kind)
    lists = [piece.tolist() if isinstance(piece, np.ndarray) else piece for piece in pieces]
    return pa.array(list(chain.from_iterable(lists)), type=kind)
