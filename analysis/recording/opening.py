"""Opens the tables of a recording and makes sure that they are as the run wrote them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from analysis.errors import RecordingError
from analysis.files import PART
from analysis.manifest import read_verified


@contextmanager
def opened_table(path: Path) -> Iterator[pq.ParquetFile]:
    """Open a recorded table; the file is read once and checked against its hash and its own checksums.

    Raises
    ------
    DamageError
        When the file is not as the run wrote it.
    RecordingError
        When it is missing, truncated or not Parquet, here or while it is read.
    """
    try:
        content = read_verified(path)
        with pq.ParquetFile(pa.BufferReader(content), page_checksum_verification=True) as file:
            yield file
    except FileNotFoundError:
        cut = path.with_name(path.name + PART)
        hint = f" (the run was cut off: {cut.name} is there)" if cut.exists() else ""
        raise RecordingError(f"{path}: no such file{hint}") from None
    except MemoryError:  # also that of Arrow, which is an ArrowException too
        raise
    except (pa.ArrowException, OSError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise RecordingError(f"{path}: truncated or not Parquet ({reason})") from None
