"""Finds vehicles of given names in the files of a demand, which SUMO reads only as their departures near."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from pathlib import Path

from sumo_scenarios.outputs import opened

_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_VEHICLE = re.compile(rb"""<(?:vehicle|trip)\s(?:[^>]*?\s)?id\s*=\s*["']([^"']+)["']""")


def taken_names(files: Iterable[Path], names: Collection[str]) -> dict[str, Path]:
    """Return which of the names a vehicle or trip in one of the files has, and in which file."""
    found: dict[str, Path] = {}
    for path in files if names else ():
        with opened(path) as file:
            content = file.read()
        if any(name.encode() in content for name in names):
            for match in _VEHICLE.finditer(_COMMENT.sub(b"", content)):
                name = match[1].decode(errors="replace")
                if name in names:
                    found.setdefault(name, path)
    return found
