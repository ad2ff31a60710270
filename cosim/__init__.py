"""Drives vehicle controllers through pedestrian crossings in SUMO traffic and reports how safe they were.

``docs/python.md`` explains the names below. They are loaded at their first use, so that ``import cosim``
loads neither SUMO nor pandas.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cosim.api.batching import batch
    from cosim.api.comparing import Comparison, compare
    from cosim.api.reading import analyse, load
    from cosim.api.recorded_run import Run
    from cosim.api.running import run
    from cosim.api.study import Study
    from cosim.errors import CosimError, InputError, SimulationError

__all__ = [
    "Comparison",
    "CosimError",
    "InputError",
    "Run",
    "SimulationError",
    "Study",
    "analyse",
    "batch",
    "compare",
    "load",
    "run",
]

_HOME = {
    "Comparison": "cosim.api.comparing",
    "CosimError": "cosim.errors",
    "InputError": "cosim.errors",
    "Run": "cosim.api.recorded_run",
    "SimulationError": "cosim.errors",
    "Study": "cosim.api.study",
    "analyse": "cosim.api.reading",
    "batch": "cosim.api.batching",
    "compare": "cosim.api.comparing",
    "load": "cosim.api.reading",
    "run": "cosim.api.running",
}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'cosim' has no attribute {name!r}; there are {', '.join(__all__)}")
    found = getattr(importlib.import_module(_HOME[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
