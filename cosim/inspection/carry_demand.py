"""Adapts the lane numbers and positions at which vehicles and people begin and end to a mended network."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree import ElementTree

from cosim.inspection.carried import Carried
from cosim.inspection.lane_shift import LaneShift

Element = ElementTree.Element

VEHICLES = ("vehicle", "trip", "flow")
ON_FOOT = ("person", "personFlow", "container", "containerFlow")
_STAGES = ("walk", "personTrip", "ride", "transport", "tranship")
_UNKNOWN = "only SUMO knows which edge it is on"
_SEVERAL = "it is on several edges, whose lanes are numbered differently now"


class Ends:
    """Carries over departLane, arrivalLane, departPos and arrivalPos.

    A lane number refers to a lane of the first or last edge, so routes are remembered by their ids.
    """

    def __init__(self, shift: LaneShift, carried: Carried) -> None:
        self._shift = shift
        self._carried = carried
        self._routes: dict[str, list[list[str]]] = {}

    def remember(self, element: Element) -> None:
        """Remember the routes in an element."""
        for route in element.iter("route"):
            if route.get("id"):
                self._routes[route.get("id", "")] = [route.get("edges", "").split()]
        for choice in element.iter("routeDistribution"):
            if choice.get("id"):
                self._routes[choice.get("id", "")] = self._choices(choice)

    def carry_vehicle(self, element: Element, on: str = "") -> None:
        """Change the lane numbers and positions of a vehicle, a trip or a flow.

        Parameters
        ----------
        on : edge to which they refer, if the route does not give it
        """
        routes = [[on]] if on else self._ways(element)
        for end, default in (("depart", 0), ("arrival", -1)):
            at = _edge_number(element.get(f"{end}Edge"), default)
            edges = {route[at] for route in routes if at is not None and -len(route) <= at < len(route)}
            self._lane(element, f"{end}Lane", edges)
            self._position(element, f"{end}Pos", edges)

    def carry_person(self, element: Element) -> None:
        """Change the positions of a person or a container, and of their stages."""
        stages = list(element)
        self._position(
            element, "departPos", {edge for stage in stages[:1] for edge in self._stage(stage)[:1]}
        )
        for stage in stages:
            if stage.tag in _STAGES:
                edges = self._stage(stage)
                self._position(stage, "departPos", set(edges[:1]))
                self._position(stage, "arrivalPos", set(edges[-1:]))

    def _lane(self, element: Element, key: str, edges: set[str]) -> None:
        text = element.get(key, "")
        if not text.isdecimal():
            return
        numbers = {self._shift.index(edge, int(text)) for edge in edges}
        kind = f"{key} of {element.tag}"
        if len(numbers) != 1 or None in numbers:
            # SUMO then chooses a lane, not always the one that was meant.
            del element.attrib[key]
            self._carried.left_out(kind, element.get("id", "?"), _SEVERAL if len(numbers) > 1 else _UNKNOWN)
        elif numbers != {int(text)}:
            element.set(key, str(numbers.pop()))
            self._carried.renumbered(kind)

    def _position(self, element: Element, key: str, edges: Iterable[str]) -> None:
        try:
            was = float(element.get(key, ""))
        except ValueError:
            return
        places = [self._shift.place_on_edge(edge, was) for edge in edges]
        if places and abs(min(places) - was) > 0.005:
            element.set(key, f"{min(places):.2f}")
            self._carried.moved(f"{key} of {element.tag}")

    def _ways(self, element: Element) -> list[list[str]]:
        """Return the possible routes of a vehicle, or the ends of a trip."""
        if element.get("route"):
            return self._routes.get(element.get("route", ""), [])
        choice = element.find("routeDistribution")
        if choice is not None:
            return self._choices(choice)
        route = element.find("route")
        if route is not None:
            return [route.get("edges", "").split()]
        if element.get("from") and element.get("to"):
            return [[element.get("from", ""), *element.get("via", "").split(), element.get("to", "")]]
        return []

    def _choices(self, choice: Element) -> list[list[str]]:
        named = [*choice.get("routes", "").split(), *(one.get("refId", "") for one in choice.iter("route"))]
        given = [route.get("edges", "").split() for route in choice.iter("route") if route.get("edges")]
        return given + [way for name in named for way in self._routes.get(name, [])]

    def _stage(self, stage: Element) -> list[str]:
        """Return the edges of a stage of a plan, as far as they are given."""
        if stage.get("route"):
            return [edge for route in self._routes.get(stage.get("route", ""), []) for edge in route]
        edge = stage.get("edge") or stage.get("lane", "").rpartition("_")[0]
        return stage.get("edges", "").split() or [
            name for name in (stage.get("from"), edge, stage.get("to")) if name
        ]


def _edge_number(text: str | None, default: int) -> int | None:
    """Return the index of an edge in a route; ``None`` for a word such as ``random``."""
    if text is None:
        return default
    return int(text) if text.isdecimal() else None
