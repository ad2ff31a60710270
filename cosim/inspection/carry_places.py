"""Adapts elements at a place on a lane, such as stops, detectors and signs, to a mended network."""

from __future__ import annotations

from xml.etree import ElementTree

from cosim.inspection.carried import Carried
from cosim.inspection.lane_shift import LaneShift

Element = ElementTree.Element

SHORTEST_M = 10.0
"""A stretch that would reach beyond the end of its lane is moved back to keep at least this length [m]."""
FIRST_M = 1.0
"""Smallest end of a stretch without a start, as SUMO does not accept a stretch of length zero [m]."""
_STARTS = ("pos", "startPos")
_WITH_LENGTH = ("laneAreaDetector", "e2Detector")
"""Elements that may give a length instead of an end; the length of a parking area is that of one space."""
_NO_LANE = "its lane is not in the network"


class Places:
    """Carries over the lanes that an element names, and its positions along them.

    All kinds of elements are treated alike: SUMO calls the attribute ``lane`` or ``lanes`` everywhere, except
    for the lane that a rerouter closes.
    """

    def __init__(self, shift: LaneShift, carried: Carried) -> None:
        self._shift = shift
        self._carried = carried

    def carry(self, element: Element, on_foot: bool = False) -> str:
        """Change an element; return why it cannot be carried over, or nothing if it can.

        Parameters
        ----------
        element : the element
        on_foot : whether it is a place for people, who now walk on the sidewalk instead of the road
        """
        key = _key(element)
        if key:
            return self._on_lanes(element, key, on_foot)
        edge = element.get("edge")
        if edge and any(element.get(name) for name in (*_STARTS, "endPos")):
            self._on_edge(element, edge)
        return ""

    def _on_lanes(self, element: Element, key: str, on_foot: bool) -> str:
        old = element.get(key, "").split()
        find = self._shift.lane_on_foot if on_foot else self._shift.lane
        new = [name for name in map(find, old) if name is not None]
        if not old or len(new) < len(old):
            return _NO_LANE
        if new != old:
            element.set(key, " ".join(new))
            self._carried.renumbered(element.tag)
        self._along(element, old, new)
        return ""

    def _along(self, element: Element, old: list[str], new: list[str]) -> None:
        places = {key: _number(element.get(key)) for key in (*_STARTS, "endPos")}
        changed = {
            key: self._shift.place(*((old[-1], new[-1]) if key == "endPos" else (old[0], new[0])), place)
            for key, place in places.items()
            if place is not None
        }
        if len(old) == 1:
            reach = _number(element.get("length")) if element.tag in _WITH_LENGTH else None
            if reach is not None or "startPos" in changed:
                self._stretch(element, changed, (old[0], new[0]), reach)
            elif "endPos" in changed and 0.0 <= changed["endPos"] < FIRST_M:
                changed["endPos"] = min(FIRST_M, self._shift.after.lanes[new[0]].length)
        self._write(element, places, changed)

    def _stretch(
        self, element: Element, changed: dict[str, float], lanes: tuple[str, str], reach: float | None
    ) -> None:
        """Move a stretch back if too little of it would be on its lane."""
        before = self._shift.before.lanes[lanes[0]].length
        length = self._shift.after.lanes[lanes[1]].length
        first = next((key for key in _STARTS if key in changed), "startPos")
        start_was = _from_start(_number(element.get(first)) or 0.0, before)
        end_was = _from_start(_number(element.get("endPos")), before) if reach is None else start_was + reach
        start = _from_start(changed.get(first, 0.0), length)
        end = _from_start(changed.get("endPos"), length) if reach is None else min(start + reach, length)
        kept = min(end_was - start_was, SHORTEST_M, length)
        if end - start < kept - 1e-6:
            end = min(max(end, kept), length)
            start = max(end - kept, 0.0)
            changed[first] = start
            if "endPos" in changed:
                changed["endPos"] = end
        if reach is not None and end - start < reach - 1e-6:
            element.set("length", f"{end - start:.2f}")

    def _on_edge(self, element: Element, edge: str) -> None:
        places = {key: _number(element.get(key)) for key in (*_STARTS, "endPos")}
        changed = {
            key: self._shift.place_on_edge(edge, place) for key, place in places.items() if place is not None
        }
        self._write(element, places, changed)

    def _write(self, element: Element, was: dict[str, float | None], now: dict[str, float]) -> None:
        """Set the positions that have changed; SUMO gives lengths of lanes with two decimals."""
        different = {key: place for key, place in now.items() if abs(place - (was[key] or 0.0)) > 0.005}
        for key, place in different.items():
            element.set(key, f"{place:.2f}")
        if different:
            self._carried.moved(element.tag)


def _key(element: Element) -> str:
    """Return the attribute in which an element names lanes; empty if it names none."""
    if element.tag == "closingLaneReroute":
        return "id"
    return next((key for key in ("lane", "lanes") if element.get(key)), "")


def _number(text: str | None) -> float | None:
    try:
        return None if text is None else float(text)
    except ValueError:
        return None


def _from_start(position: float | None, length: float) -> float:
    """Return a position counted from the start of the lane; the lane's end if none is given [m]."""
    if position is None:
        return length
    return position if position >= 0.0 else length + position
