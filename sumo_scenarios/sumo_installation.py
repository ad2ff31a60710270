"""Locations of the installed SUMO's programs and files."""

from __future__ import annotations

import os
from importlib import metadata
from pathlib import Path

from sumo_scenarios.errors import ScenarioError


def sumo_home() -> Path:
    """Return the folder of the installed ``eclipse-sumo`` package."""
    try:
        import sumo
    except ImportError:
        raise ScenarioError("the package eclipse-sumo is not installed: pip install eclipse-sumo") from None
    return Path(sumo.SUMO_HOME)


def sumo_version() -> str:
    """Return the version of the installed ``eclipse-sumo`` package."""
    return metadata.version("eclipse-sumo")


def netconvert() -> Path:
    """Return the path of the package's netconvert."""
    program = sumo_home() / "bin" / ("netconvert.exe" if os.name == "nt" else "netconvert")
    if not program.is_file():
        raise ScenarioError("the installed eclipse-sumo package has no netconvert: reinstall eclipse-sumo")
    return program


def packaged_file(relative: str) -> Path:
    """Return a file that the package ships, by its path relative to the package."""
    path = sumo_home() / relative
    if not path.is_file():
        raise ScenarioError(f"the installed eclipse-sumo {sumo_version()} does not ship {relative}")
    return path
