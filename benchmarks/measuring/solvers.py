"""Which solvers are measured."""

from __future__ import annotations

SOLVERS = ("daqp", "osqp")
"""Those that every installation has; the first is the default of ``vo_mpc``."""
DEFAULT = SOLVERS[0]
