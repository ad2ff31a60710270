"""Writes copies of route and additional files that fit a mended network; the originals are not touched."""

from __future__ import annotations

import os
from collections import defaultdict
from pathlib import Path
from xml.etree import ElementTree

from cosim.inspection.carried import Carried
from cosim.inspection.carry_demand import ON_FOOT, VEHICLES, Ends
from cosim.inspection.carry_places import Places
from cosim.inspection.lane_shift import LaneShift
from cosim.inspection.xml_elements import elements
from cosim.sumo.network import Network
from sumo_scenarios.outputs import is_output

Element = ElementTree.Element

STOPPING_PLACES = {
    "busStop": "busStop",
    "trainStop": "busStop",
    "containerStop": "containerStop",
    "parkingArea": "parkingArea",
    "chargingStation": "chargingStation",
    "overheadWireSegment": "overheadWireSegment",
}
"""Attribute with which a stop or a stage names a stopping place, by element of the place."""
_ALONE = ("stop", "access", "closingLaneReroute", "parkingAreaReroute")
"""Parts that can be left out alone; if another part cannot be carried over, its whole element is left out."""
_IN_PARTS = ("rerouter", "calibrator")
"""Elements into which the content of their ``file`` can be moved."""
_INPUTS = ("file", "imgFile")


class CarryOver:
    """Writes the copies; additional files must come first, because they define objects that routes name.

    Parameters
    ----------
    before, after : the network before and after mending
    folder : folder in which the copies will be read; names of further files are relative to it
    """

    def __init__(self, before: Network, after: Network, folder: Path) -> None:
        self.carried = Carried()
        shift = LaneShift(before, after)
        self._places = Places(shift, self.carried)
        self._ends = Ends(shift, self.carried)
        self._signals = _signals(after)
        self._folder = folder
        self._gone: defaultdict[str, set[str]] = defaultdict(set)

    def write(self, path: Path, target: Path, root: str) -> None:
        """Write the copy of a file, with the content of included files in their place.

        Parameters
        ----------
        path, target : the file, and its copy
        root : name of the root element
        """
        with target.open("w", encoding="utf-8", newline="\n") as file:
            file.write(f"<{root}>\n")
            for source, element in elements(path):
                self._with_files(element, source.parent)
                if self._carry(element):
                    element.tail = None
                    file.write(f"    {ElementTree.tostring(element, encoding='unicode')}\n")
            file.write(f"</{root}>\n")

    def _carry(self, element: Element) -> bool:
        """Change an element, and return whether it is kept."""
        self._ends.remember(element)
        why = self._why_signals_differ(element) or self._parts(element, element.tag in ON_FOOT)
        if why:
            name = element.get("id", element.get("junctionID", "?"))
            self.carried.left_out(element.tag, name, why)
            self._gone[STOPPING_PLACES.get(element.tag, element.tag)].add(name)
            return False
        for vehicle in element.iter():
            if vehicle.tag in VEHICLES:
                self._ends.carry_vehicle(vehicle, _calibrated(element))
        if element.tag in ON_FOOT:
            self._ends.carry_person(element)
        return True

    def _parts(self, element: Element, on_foot: bool) -> str:
        """Change an element and its parts; return why that is not possible, or nothing if it is."""
        why = self._names_what_is_gone(element)
        why = why or self._places.carry(element, on_foot or element.tag == "access")
        if why:
            return why
        for part in list(element):
            reason = self._parts(part, on_foot)
            if reason and (part.tag not in _ALONE or (on_foot and part.tag == "stop")):
                return reason
            if reason:
                self.carried.left_out(f"{part.tag} of {element.tag}", _name(element, part), reason)
                element.remove(part)
        return ""

    def _names_what_is_gone(self, element: Element) -> str:
        named = {key: element.get(key, "") for key in STOPPING_PLACES.values()}
        if element.tag == "parkingAreaReroute":
            named["parkingArea"] = element.get("id", "")
        gone = next((name for key, name in named.items() if name in self._gone[key]), None)
        return "" if gone is None else f"it needs {gone!r}, which is left out"

    def _why_signals_differ(self, element: Element) -> str:
        """Return why a signal program does not fit; empty if it does, and for other elements."""
        if element.tag == "wautJunction" and element.get("junctionID", "") in self._gone["tlLogic"]:
            return "its signal program is left out"
        if element.tag != "tlLogic":
            return ""
        needed = self._signals.get(element.get("id", ""), 0)
        fewest = min((len(phase.get("state", "")) for phase in element.iter("phase")), default=needed)
        return f"its crossings have signals now, {needed} in all, for which it has none" * (fewest < needed)

    def _with_files(self, element: Element, folder: Path) -> None:
        """Make names of input files relative to the folder of the copy; outputs are written beside it."""
        for part in element.iter():
            for key in _INPUTS:
                path = folder / part.get(key, "")
                if is_output(part.tag, key) or not path.is_file():
                    continue
                if part.tag in _IN_PARTS:
                    part.extend(one for _, one in elements(path))
                    del part.attrib[key]
                else:
                    part.set(key, os.path.relpath(path, self._folder))


def _calibrated(element: Element) -> str:
    """Return the edge of a calibrator, on which its flows begin; empty for other elements."""
    if element.tag != "calibrator":
        return ""
    return element.get("edge", "") or element.get("lane", "").rpartition("_")[0]


def _name(element: Element, part: Element) -> str:
    return part.get("id", "") or element.get("id", "?")


def _signals(network: Network) -> dict[str, int]:
    """Return how many signals each traffic light has, including those of crossings."""
    last: defaultdict[str, int] = defaultdict(int)
    for group in network.connections.values():
        for one in group:
            last[one.signal] = max(last[one.signal], one.signal_index + 1)
    for crossing in network.crossings.values():
        last[crossing.signal] = max(
            last[crossing.signal], *(index + 1 for index in crossing.signal_indices), 0
        )
    return last
