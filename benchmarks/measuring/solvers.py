"""Which solvers are measured."""

from __future__ import annotations

import qpsolvers


def solvers() -> tuple[str, ...]:
    """Return OSQP, which every installation has, and DAQP where it is installed."""
    return ("osqp", *(name for name in ("daqp",) if name in qpsolvers.available_solvers))
