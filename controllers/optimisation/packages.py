"""Packages that some solvers need in addition to those that are always installed."""

from __future__ import annotations

import importlib.util


def require_pymoo() -> None:
    """Check that pymoo can be used.

    Raises
    ------
    ValueError
        If it is not installed.
    """
    try:
        there = importlib.util.find_spec("pymoo") is not None
    except ValueError:  # a module without a specification has taken its place
        there = False
    if not there:
        raise ValueError("needs pymoo: pip install pymoo matplotlib")
