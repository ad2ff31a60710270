"""Which solvers are measured."""

from __future__ import annotations

import importlib.util
from typing import Any

FAST = "fast"
"""What the extra ``[fast]`` brings: DAQP, and arithmetic compiled by Numba."""


def solvers() -> tuple[str, ...]:
    """Return OSQP, which every installation has, and the fast path where it is installed."""
    installed = all(importlib.util.find_spec(name) for name in ("daqp", "numba"))
    return ("osqp", FAST) if installed else ("osqp",)


def settings(name: str) -> dict[str, Any]:
    """Return the parameters of ``vo_mpc`` that stand for one of them.

    >>> settings("osqp")
    {'solver': 'osqp'}
    """
    return {"solver": "daqp", "compiled": True} if name == FAST else {"solver": name}


def given(name: str) -> dict[str, str]:
    """Return the same as a user gives it.

    >>> given("osqp")
    {'solver': 'osqp'}
    """
    return {parameter: str(value) for parameter, value in settings(name).items()}
