"""Finds vehicles and persons whose type or route no file defines; SUMO stops while it reads them."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

SUMOS_TYPES = frozenset(f"DEFAULT_{kind}TYPE" for kind in ("VEH", "PED", "BIKE", "TAXI", "RAIL", "CONTAINER"))
"""Types that SUMO defines itself."""
TYPE, ROUTE = "type", "route"
_DEFINES = {"vType": TYPE, "vTypeDistribution": TYPE, "route": ROUTE, "routeDistribution": ROUTE}
_LISTS = {"vTypeDistribution": (TYPE, "vTypes"), "routeDistribution": (ROUTE, "routes")}


class _Use(NamedTuple):
    kind: str
    name: str
    by: str
    file: Path


class References:
    """Notes definitions and uses of types and routes in the order of the files."""

    def __init__(self) -> None:
        self._defined: dict[tuple[str, str], Path] = {(TYPE, name): Path() for name in SUMOS_TYPES}
        self._open: list[_Use] = []

    def note(self, element: ElementTree.Element, file: Path, departs: bool) -> None:
        """Note what a child of the root element defines and uses; ``departs`` for road users."""
        for one in element.iter():
            if one.tag in _DEFINES and one.get("id"):
                self._defined.setdefault((_DEFINES[one.tag], one.get("id", "")), file)
        by = f"{element.tag} {element.get('id', '?')!r}"
        if element.tag in _LISTS:
            kind, key = _LISTS[element.tag]
            for name in element.get(key, "").split():
                self._use(_Use(kind, name, by, file))
        elif departs:
            for kind in (TYPE, ROUTE):
                if element.get(kind):
                    self._use(_Use(kind, element.get(kind, ""), by, file))

    def unknown(self) -> list[str]:
        """Return in words who uses what is never defined, or only further down in the same file."""
        found = []
        for one in self._open:
            file = self._defined.get((one.kind, one.name))
            if file is None or file == one.file:
                late = "" if file is None else ", which is defined only below it"
                found.append(f"{one.file.name}: {one.by} has the {one.kind} {one.name!r}{late}")
        return found

    def _use(self, one: _Use) -> None:
        if (one.kind, one.name) not in self._defined:
            self._open.append(one)
