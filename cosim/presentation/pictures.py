"""Checks the requirements of drawing: matplotlib, and a file name with a known format."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from cosim.errors import InputError

FORMATS = ("png", "svg")


def require_matplotlib(what: str) -> None:
    """Raise `InputError` if matplotlib is not installed."""
    if importlib.util.find_spec("matplotlib") is None:
        raise InputError(f"{what} needs matplotlib: pip install matplotlib")


def check_picture(path: Path, formats: tuple[str, ...] = FORMATS) -> None:
    """Raise `InputError` if no picture can be written to a file because of its suffix or its folder."""
    if path.suffix.lower().removeprefix(".") not in formats:
        endings = " or ".join(f".{name}" for name in formats)
        raise InputError(f"{path}: expected a file name that ends in {endings}")
    if not path.parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist")
    if path.is_dir():
        raise InputError(f"{path}: expected a file, this is a folder")
