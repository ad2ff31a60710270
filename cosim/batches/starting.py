"""How worker processes start: as copies of one that has loaded everything, so that it is loaded once.

To load what a run needs takes more than a second, and each worker used to do it for itself; so did each that
took the place of one whose run had failed.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import forkserver, get_context
from typing import Any

LOADED = ("cosim.running.execution", "libsumo", "pandas")
"""What runs need, and pyarrow, too, while a table is written."""


def context() -> Any:
    """Return how `multiprocessing` is to start processes; call it before each process pool is made."""
    if not sys.platform.startswith("linux"):
        return get_context("spawn")  # system libraries of macOS do not bear to be copied
    found = get_context("forkserver")
    found.set_forkserver_preload([*LOADED])
    with _same_import_path():
        forkserver.ensure_running()
    return found


@contextmanager
def _same_import_path() -> Iterator[None]:
    """Let a new process import what this one would, also where a program has changed ``sys.path``."""
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join(place or os.getcwd() for place in sys.path)
    try:
        yield
    finally:
        if before is None:
            del os.environ["PYTHONPATH"]
        else:
            os.environ["PYTHONPATH"] = before
