"""Reader of a SUMO network file."""

from __future__ import annotations

import gzip
import zlib
from collections import defaultdict
from collections.abc import Iterator, Mapping, Set
from math import isfinite
from pathlib import Path
from typing import BinaryIO, cast
from xml.etree import ElementTree

import numpy as np

from controllers.interface import CrossingKind
from cosim.arrays import FloatArray
from cosim.errors import InputError
from cosim.sumo.network import (
    TURNAROUND,
    Connection,
    NetCrossing,
    NetLane,
    Network,
    Permissions,
    Requests,
    WalkingArea,
)

DEFAULT_LANE_WIDTH = 3.2
"""SUMO's own default [m]."""
STOP, ALLWAY_STOP = "s", "w"
"""States of connections without a traffic light at which vehicles have to stop."""


def read_network(path: Path) -> Network:
    """Return the network in a ``.net.xml`` or ``.net.xml.gz`` file.

    Raises
    ------
    InputError
        If the file cannot be read or is no SUMO network.
    """
    reader = _Reader()
    try:
        with opened(path) as source:
            for element in _elements(source):
                reader.take(element)
        found = reader.network()
    except OSError as error:
        reason = error.strerror or error
        raise InputError(f"cannot read the network {path}: {reason}") from error
    except (ElementTree.ParseError, zlib.error, EOFError) as error:
        raise InputError(f"{path} is not a SUMO network: {error}") from error
    except (LookupError, ValueError) as error:
        raise InputError(f"{path} is not a complete SUMO network: {error!r}") from error
    if not found.edges:
        raise InputError(f"{path} has no edges; expected a SUMO network (.net.xml)")
    return found


def opened(path: Path) -> BinaryIO:
    """Return a file open for reading, whether it is compressed or not."""
    with path.open("rb") as source:
        magic = source.read(2)
    return cast(BinaryIO, gzip.open(path, "rb")) if magic == b"\x1f\x8b" else path.open("rb")


def _elements(source: BinaryIO) -> Iterator[ElementTree.Element]:
    """Yield the root's children one after the other, and free each when it has been used."""
    depth = 0
    root: ElementTree.Element | None = None
    for event, element in ElementTree.iterparse(source, events=("start", "end")):
        if event == "start":
            depth += 1
            if root is None:
                root = element
            continue
        depth -= 1
        if depth == 1 and root is not None:
            yield element
            root.clear()


def _direction(letter: str) -> str:
    """Return a connection's direction; SUMO writes turnarounds of left-hand traffic as ``T``."""
    return TURNAROUND if letter == "T" else letter


def _classes(text: str | None) -> frozenset[str] | None:
    return None if text is None else frozenset(text.split())


def _permissions(element: ElementTree.Element) -> Permissions:
    return Permissions(_classes(element.get("allow")), _classes(element.get("disallow")) or frozenset())


def _number(text: str) -> float:
    number = float(text)
    if not isfinite(number):
        raise ValueError(f"{text!r} is not finite")
    return number


def _shape(text: str) -> FloatArray:
    points = np.array([[_number(value) for value in point.split(",")[:2]] for point in text.split()])
    if points.ndim != 2 or points.shape[1] != 2:
        raise ValueError(f"the shape {text!r} has no points of x and y")
    if len(points) < 2:
        return np.repeat(points, 2, axis=0)
    # Repeated points have no direction; one of them is enough.
    keep = np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 1e-6])
    return points[keep] if keep.sum() >= 2 else points[:2]


class _Reader:
    def __init__(self) -> None:
        self.lanes: dict[str, NetLane] = {}
        self.edges: dict[str, tuple[str, ...]] = {}
        self.crossing_edges: dict[str, frozenset[str]] = {}
        self.walking_areas: dict[str, WalkingArea] = {}
        self.links: defaultdict[str, list[ElementTree.Element]] = defaultdict(list)
        self.junctions: dict[str, frozenset[str]] = {}
        self.requests: list[Requests] = []
        self.unregulated: set[str] = set()
        self.entries: defaultdict[str, list[ElementTree.Element]] = defaultdict(list)
        self.beside_area: defaultdict[str, set[str]] = defaultdict(set)
        self.geographic = False
        self.class_speeds: dict[str, dict[str, float]] = {}
        """By type of edge: the limits of vehicle classes that have one of their own [m/s]."""

    def take(self, element: ElementTree.Element) -> None:
        if element.tag == "edge":
            self._edge(element)
        elif element.tag == "type":
            self.class_speeds[element.attrib["id"]] = {
                one.attrib["vClass"]: _number(one.attrib["speed"]) for one in element.iter("restriction")
            }
        elif element.tag == "connection":
            self._connection(element)
        elif element.tag == "junction" and not element.attrib["id"].startswith(":"):
            self._junction(element)
        elif element.tag == "location":
            self.geographic = element.get("projParameter", "!") not in ("!", "-", ".")

    def _junction(self, element: ElementTree.Element) -> None:
        lanes = tuple(element.get("intLanes", "").split())
        rows = sorted(element.iter("request"), key=lambda row: int(row.attrib["index"]))
        if not rows:
            # In such a junction, SUMO's drivers and pedestrians yield to nobody. Which ways meet is left to
            # geometry.
            self.unregulated.add(element.attrib["id"])
            rows_of_everybody = ("1" * len(lanes),) * len(lanes)
            self.requests.append(Requests(lanes, rows_of_everybody, rows_of_everybody))
        elif len(rows) == len(lanes):
            response = tuple(row.attrib["response"] for row in rows)
            self.requests.append(Requests(lanes, response, tuple(row.attrib["foes"] for row in rows)))

    def _edge(self, element: ElementTree.Element) -> None:
        function = element.get("function", "")
        if function == "connector":
            return
        name = element.attrib["id"]
        class_speeds = self.class_speeds.get(element.get("type", ""), {})
        lanes = [self._lane(name, lane, class_speeds) for lane in element.iter("lane")]
        if not lanes:
            raise ValueError(f"the edge {name!r} has no lanes")
        if function == "walkingarea":
            self.walking_areas[name] = WalkingArea(name, lanes[0].shape)
            return
        for lane in lanes:
            self.lanes[lane.name] = lane
        inside = name[1:].rpartition("_")[0]  # SUMO names what is inside a junction ":JUNCTION_NUMBER"
        ends = (inside,) if name.startswith(":") else (element.get("from", ""), element.get("to", ""))
        self.junctions[name] = frozenset(ends)
        if function == "crossing":
            self.crossing_edges[name] = frozenset(element.get("crossingEdges", "").split())
        else:
            self.edges[name] = tuple(lane.name for lane in lanes)

    def _lane(self, edge: str, element: ElementTree.Element, class_speeds: Mapping[str, float]) -> NetLane:
        return NetLane(
            element.attrib["id"],
            edge,
            int(element.attrib["index"]),
            _number(element.attrib["length"]),
            _number(element.get("width", str(DEFAULT_LANE_WIDTH))),
            _number(element.attrib["speed"]),
            _shape(element.attrib["shape"]),
            _permissions(element),
            class_speeds,
        )

    def _connection(self, element: ElementTree.Element) -> None:
        source, target = element.attrib["from"], element.attrib["to"]
        if target in self.crossing_edges:
            self.entries[target].append(element)
        for area, other in ((source, target), (target, source)):
            if area in self.walking_areas:
                self.beside_area[area].add(other)
        if source in self.edges and target in self.edges:
            self.links[self._name(source, element.attrib["fromLane"])].append(element)

    def _name(self, edge: str, index: str) -> str:
        names = self.edges[edge]
        if not 0 <= int(index) < len(names):
            raise ValueError(f"a connection names lane {index} of {edge!r}, which has {len(names)}")
        return names[int(index)]

    def _via(self, element: ElementTree.Element) -> tuple[str, ...]:
        """Return the chain of internal lanes: one internal lane may continue in another."""
        chain: list[str] = []
        target = (element.attrib["to"], element.attrib["toLane"])
        via = element.get("via")
        while via and via in self.lanes and via not in chain:
            chain.append(via)
            via = next(
                (
                    link.get("via")
                    for link in self.links.get(via, ())
                    if (link.attrib["to"], link.attrib["toLane"]) == target
                ),
                None,
            )
        return tuple(chain)

    def _crossing(self, name: str, islands: Set[str]) -> NetCrossing:
        lane = self.lanes[f"{name}_0"]
        entries = self.entries[name]
        signal = next((entry.attrib["tl"] for entry in entries if entry.get("tl")), "")
        indices = {
            int(entry.attrib[key])
            for entry in entries
            for key in ("linkIndex", "linkIndex2")
            if entry.get("tl") and int(entry.get(key, "-1")) >= 0
        }
        # Where nothing is regulated, SUMO's pedestrians cross without waiting, as they do at a zebra.
        unregulated = self.junctions[name] <= self.unregulated
        zebra = unregulated or any(entry.get("state") == "M" for entry in entries)
        kind = CrossingKind.SIGNAL if signal else CrossingKind.ZEBRA if zebra else CrossingKind.UNMARKED
        edges = self.crossing_edges[name]
        numbers = tuple(sorted(indices))
        return NetCrossing(name, lane.shape, lane.width, edges, kind, signal, numbers, name in islands)

    def _at_islands(self) -> set[str]:
        """Return the crossings at a walking area from which several crossings, and nothing else, lead on."""
        crossings = self.crossing_edges.keys()
        islands = (beside for beside in self.beside_area.values() if len(beside) > 1 and beside <= crossings)
        return set().union(*islands)

    def network(self) -> Network:
        connections = {
            source: tuple(
                Connection(
                    source,
                    self._name(link.attrib["to"], link.attrib["toLane"]),
                    self._via(link),
                    _direction(link.get("dir", "s")),
                    link.get("tl", ""),
                    int(link.get("linkIndex", "-1")),
                    link.get("state") == ALLWAY_STOP,
                    link.get("state") in (STOP, ALLWAY_STOP) and "tl" not in link.attrib,
                    _permissions(link),
                )
                for link in links
            )
            for source, links in self.links.items()
            if not source.startswith(":")
        }
        islands = self._at_islands()
        crossings = {name: self._crossing(name, islands) for name in self.crossing_edges}
        lanes = {name: lane for name, lane in self.lanes.items() if lane.edge in self.edges}
        return Network(
            lanes,
            self.edges,
            connections,
            crossings,
            self.walking_areas,
            self.requests,
            self.geographic,
            self.junctions,
        )
