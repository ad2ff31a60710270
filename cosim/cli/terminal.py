"""The terminal on which tables are printed."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

LOG_WIDTH = 132


def console() -> Console:
    """Return a console on the standard output that prints texts as they are, units in brackets too."""
    from rich.console import Console

    width = None if sys.stdout.isatty() else LOG_WIDTH
    return Console(highlight=False, markup=False, width=width)
