"""Names of what exists, without loading any of it: for ``cosim list`` and for completion in a shell."""

from __future__ import annotations

import pkgutil
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path

PLUG_INS = "cosim.controllers"
"""Group of entry points."""


def scenarios() -> list[str]:
    """Return the built-in scenarios."""
    return sorted(path.parent.name for path in _folder("sumo_scenarios").glob("*/scenario.toml"))


def controllers() -> list[str]:
    """Return the controllers of this project and of installed plug-ins."""
    return sorted({*_modules("controllers.strategies"), *(one.name for one in entry_points(group=PLUG_INS))})


def metrics() -> list[str]:
    """Return the metrics."""
    return _modules("analysis.metrics")


def sensing_models() -> list[str]:
    """Return the sensing models."""
    return _modules("cosim.sensing.models")


def suites() -> list[str]:
    """Return the test protocols, as they are named in commands."""
    folder = _folder("sumo_scenarios.suites")
    return sorted(f"suite:{path.parent.name}" for path in folder.glob("*/suite.toml"))


def targets(incomplete: str) -> list[str]:
    """Return the scenarios and suites that begin so."""
    return [name for name in (*scenarios(), *suites()) if name.startswith(incomplete)]


def drivers(incomplete: str) -> list[str]:
    """Return the controllers that begin so."""
    return [name for name in controllers() if name.startswith(incomplete)]


def sensing(incomplete: str) -> list[str]:
    """Return the sensing models that begin so."""
    return [name for name in sensing_models() if name.startswith(incomplete)]


def _modules(package: str) -> list[str]:
    return sorted(found.name for found in pkgutil.iter_modules([str(_folder(package))]))


def _folder(package: str) -> Path:
    spec = find_spec(package)
    places = None if spec is None else spec.submodule_search_locations
    if not places:
        raise ModuleNotFoundError(f"{package} is not installed")
    return Path(places[0])
