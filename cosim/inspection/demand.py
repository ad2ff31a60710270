"""Counts the vehicles and pedestrians of route and additional files, without simulating them."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from cosim.errors import InputError
from cosim.inspection.references import References
from cosim.inspection.source import Source
from cosim.inspection.xml_elements import elements

DEFAULT_CLASSES = {
    "DEFAULT_VEHTYPE": "passenger",
    "DEFAULT_PEDTYPE": "pedestrian",
    "DEFAULT_BIKETYPE": "bicycle",
    "DEFAULT_TAXITYPE": "taxi",
}
"""Vehicle types that SUMO defines itself."""
CAR = "passenger"
_RIDERS = ("vehicle", "trip", "flow")
_WALKERS = ("person", "personFlow")
_SUBLANE_MODELS = ("SL2015", "default")
_POISSON = re.compile(r"exp\(([^)]+)\)")


class Way(NamedTuple):
    """The given edges of vehicles."""

    edges: tuple[str, ...]
    """A whole route, or its ends with what lies between them."""
    whole: bool = False
    """Whether these are all edges, so that each has to lead to the next one."""
    kind: str = CAR
    """Vehicle class."""


@dataclass(slots=True)
class Demand:
    """Content of the files, as expected numbers over the simulated time."""

    vehicles: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    """Expected number by vehicle class."""
    persons: float = 0.0
    ways: defaultdict[Way, float] = field(default_factory=lambda: defaultdict(float))
    """Expected number of passenger cars, and of other vehicles with a whole route, by their given edges."""
    walked: dict[str, str] = field(default_factory=dict)
    """Edges that persons walk on, begin at or go to, with the first who does, in words."""
    ignored: dict[Path, list[str]] = field(default_factory=dict)
    """Ids that SUMO ignores because an earlier entry departs later, by route file."""
    closed: dict[str, None] = field(default_factory=dict)
    """Lanes that rerouters close in the simulated time, in the order of the files."""
    lane_change_models: dict[str, str] = field(default_factory=dict)
    """Lane-change models of vehicle types in use, by type, if they are not those of the sublane model."""
    unknown: list[str] = field(default_factory=list)
    """Who has a type or route that is not defined, in words."""


def read_demand(source: Source) -> Demand:
    """Return the demand of a configuration; empty for a network alone.

    Raises
    ------
    InputError
        If a rate of a flow is not a number.
    """
    reader = _Reader(source.begin_s, math.inf if source.end_s is None else source.end_s)
    for path in source.additional_files:
        reader.read(path, sorted_by_time=False)
    for path in source.route_files:
        reader.read(path, sorted_by_time=True)
    return reader.demand()


def names_files(path: Path) -> bool:
    """Return whether an additional file names further files."""
    return any(
        "file" in key.lower() for _, one in elements(path) for part in one.iter() for key in part.attrib
    )


def seconds(text: str) -> float | None:
    """Return a time given as seconds or as h:m:s; ``None`` for words such as ``triggered``.

    >>> seconds("1:00:30"), seconds("triggered")
    (3630.0, None)
    """
    try:
        numbers = [float(part) for part in text.split(":")]
    except ValueError:
        return None
    scales = (1.0, 60.0, 3600.0, 86400.0)
    return sum(number * scale for number, scale in zip(reversed(numbers), scales, strict=False))


class _Reader:
    def __init__(self, begin_s: float, end_s: float) -> None:
        self._begin_s = begin_s
        self._end_s = end_s
        self._classes: dict[str, str] = dict(DEFAULT_CLASSES)
        self._models: dict[str, str] = {}
        self._members: defaultdict[str, list[str]] = defaultdict(list)
        self._routes: dict[str, list[tuple[tuple[str, ...], float]]] = {}
        self._references = References()
        self._found: list[tuple[ElementTree.Element, float]] = []
        self._demand = Demand()

    def read(self, path: Path, sorted_by_time: bool) -> None:
        latest = -math.inf
        ignored: list[str] = []
        for _, element in elements(path):
            self._define(element)
            self._references.note(element, path, element.tag in (*_RIDERS, *_WALKERS))
            if element.tag == "rerouter":
                self._close(element)
            if element.tag not in (*_RIDERS, *_WALKERS):
                continue
            depart = seconds(element.get("depart", element.get("begin", "0")))
            if sorted_by_time and depart is not None:
                if depart < latest:
                    ignored.append(element.get("id", "?"))
                    continue
                latest = depart
            try:
                self._found.append((element, self._count(element, depart)))
            except ValueError as error:
                what = f"{element.tag} {element.get('id', '?')!r}"
                raise InputError(f"{path}: {what} has something that is not a number: {error}") from error
        if ignored:
            self._demand.ignored[path] = ignored

    def demand(self) -> Demand:
        for element, count in self._found:
            if element.tag in _WALKERS:
                self._demand.persons += count
                for edge in _walked(element):
                    self._demand.walked.setdefault(edge, f"{element.tag} {element.get('id', '?')!r}")
                continue
            name = element.get("type", "DEFAULT_VEHTYPE")
            kind = self._class(name)
            self._demand.lane_change_models |= {
                one: self._models[one] for one in (name, *self._members.get(name, ())) if one in self._models
            }
            self._demand.vehicles[kind] += count
            for edges, share, whole in self._ways(element):
                if edges and (whole or kind == CAR):
                    self._demand.ways[Way(edges, whole, kind)] += count * share
        self._demand.unknown = self._references.unknown()
        return self._demand

    def _define(self, element: ElementTree.Element) -> None:
        for kind in element.iter("vType"):
            self._classes[kind.get("id", "")] = kind.get("vClass", CAR)
            if kind.get("laneChangeModel", "default") not in _SUBLANE_MODELS:
                self._models[kind.get("id", "")] = kind.get("laneChangeModel", "")
        if element.tag == "vTypeDistribution":
            names = [kind.get("id", "") for kind in element.iter("vType")]
            self._members[element.get("id", "")] += names + element.get("vTypes", "").split()
        for route in element.iter("route"):
            if route.get("id"):
                self._routes[route.get("id", "")] = [(_edges(route), 1.0)]
        if element.tag == "routeDistribution":
            self._routes[element.get("id", "")] = self._alternatives(element)

    def _close(self, rerouter: ElementTree.Element) -> None:
        for interval in rerouter.iter("interval"):
            begin, end = seconds(interval.get("begin", "")), seconds(interval.get("end", ""))
            if (begin or 0.0) < self._end_s and (math.inf if end is None else end) > self._begin_s:
                lanes = interval.iter("closingLaneReroute")
                self._demand.closed |= dict.fromkeys(lane.get("id", "?") for lane in lanes)

    def _class(self, name: str) -> str:
        if name in self._classes:
            return self._classes[name]
        members = {self._classes.get(member, CAR) for member in self._members.get(name, ())}
        return members.pop() if len(members) == 1 else CAR

    def _alternatives(self, distribution: ElementTree.Element) -> list[tuple[tuple[str, ...], float]]:
        """Return the routes of a distribution with their shares."""
        given = [
            (_edges(route), float(route.get("probability", "1"))) for route in distribution.iter("route")
        ]
        names = distribution.get("routes", "").split()
        weights = [float(one) for one in distribution.get("probabilities", "").split()]
        for name, weight in zip(names, weights or [1.0] * len(names), strict=False):
            given += [(edges, share * weight) for edges, share in self._routes.get(name, ())]
        total = sum(weight for _, weight in given)
        return [(edges, weight / total) for edges, weight in given if weight > 0.0]

    def _ways(self, element: ElementTree.Element) -> list[tuple[tuple[str, ...], float, bool]]:
        """Return the given edges of a vehicle, their shares, and whether they are a whole route."""
        if element.get("route"):
            return [(*one, True) for one in self._routes.get(element.get("route", ""), ())]
        inner = element.find("route")
        if inner is not None:
            return [(_edges(inner), 1.0, True)]
        if element.get("from") and element.get("to"):
            via = element.get("via", "").split()
            return [((element.get("from", ""), *via, element.get("to", "")), 1.0, False)]
        return []

    def _count(self, element: ElementTree.Element, depart: float | None) -> float:
        """Return how many vehicles or persons are expected to depart in the simulated time."""
        if element.tag in ("vehicle", "trip", "person"):
            return float(depart is None or self._begin_s <= depart < self._end_s)
        begins, ends, rate = depart or 0.0, seconds(element.get("end", "")) or math.inf, _rate(element)
        number = float(element.get("number") or "inf")
        if math.isfinite(number):
            if math.isinf(ends):
                # Without an end of its own, a flow without a rate is spread until the simulation ends.
                ends = begins + number / rate if rate > 0.0 else self._end_s
            if not 0.0 < ends - begins < math.inf:
                return number * float(self._begin_s <= begins < self._end_s)
            rate = number / (ends - begins)
        duration = max(min(ends, self._end_s) - max(begins, self._begin_s), 0.0)
        # If neither the flow nor the run has an end, count one hour of the flow.
        return rate * (3600.0 if math.isinf(duration) else duration)


def _walked(person: ElementTree.Element) -> Iterator[str]:
    """Yield the edges that the plan of a person names."""
    for stage in person:
        for key in ("from", "edges", "to"):
            yield from stage.get(key, "").split()


def _edges(route: ElementTree.Element) -> tuple[str, ...]:
    return tuple(route.get("edges", "").split())


def _rate(element: ElementTree.Element) -> float:
    """Return the rate of departures of a flow [1/s]."""
    for key in ("vehsPerHour", "perHour"):
        if element.get(key):
            return float(element.get(key, "0")) / 3600.0
    if element.get("probability"):
        return float(element.get("probability", "0"))
    period = element.get("period", "")
    poisson = _POISSON.fullmatch(period.strip())
    if poisson:
        return float(poisson.group(1))
    interval = seconds(period) if period else None
    return 1.0 / interval if interval else 0.0
