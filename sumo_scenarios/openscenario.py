"""Reads pedestrians' trajectories from OpenSCENARIO, so that recorded persons can walk in a scenario."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.xml_files import check_xml

ENDING = ".xosc"
Row = tuple[float, float, float]
"""Time [s], x and y [m]."""


def read_walks(path: Path) -> Mapping[str, list[Row]]:
    """Return the points of each pedestrian who follows a trajectory, by the entity's name.

    A trajectory is a polyline whose vertices have a time and a world position. Offset and scale of the time
    reference are applied to its times; the start of its event is ignored.

    Raises
    ------
    ScenarioError
        If the file is not OpenSCENARIO, no pedestrian has a trajectory, or one is described in another way.
    """
    if check_xml(path) != "OpenSCENARIO":
        raise ScenarioError(f"{path}: expected an OpenSCENARIO file")
    root = ElementTree.parse(path).getroot()
    entities = root.iter("ScenarioObject")
    people = [str(one.get("name")) for one in entities if one.find("Pedestrian") is not None]
    found: dict[str, list[Row]] = {}
    for group in root.iter("ManeuverGroup"):
        for actor in group.iterfind("Actors/EntityRef"):
            name = str(actor.get("entityRef"))
            action = next(group.iter("FollowTrajectoryAction"), None)
            if name in people and action is not None:
                if name in found:
                    raise ScenarioError(f"{path}: {name} follows two trajectories; expected one")
                found[name] = list(_rows(path, name, action))
    if not found:
        there = ", ".join(people) or "no pedestrian"
        raise ScenarioError(f"{path}: no pedestrian follows a trajectory; there is {there}")
    return found


def _rows(path: Path, name: str, action: Element) -> Iterator[Row]:
    timing = action.find("TimeReference/Timing")
    if timing is None:
        raise ScenarioError(f"{path}: the trajectory of {name} has no times (TimeReference/Timing)")
    scale, offset = _number(path, name, timing, "scale"), _number(path, name, timing, "offset")
    vertices = list(action.iterfind(".//Trajectory/Shape/Polyline/Vertex"))
    if not vertices:
        raise ScenarioError(f"{path}: the trajectory of {name} is no polyline")
    for vertex in vertices:
        place = vertex.find("Position/WorldPosition")
        if place is None:
            raise ScenarioError(f"{path}: the trajectory of {name} has a vertex without a WorldPosition")
        time = _number(path, name, vertex, "time")
        yield offset + scale * time, _number(path, name, place, "x"), _number(path, name, place, "y")


def _number(path: Path, name: str, element: Element, attribute: str) -> float:
    text = element.get(attribute)
    try:
        value = float(text or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ScenarioError(
            f"{path}: the trajectory of {name}: {attribute} of a {element.tag} is {text!r}; expected a number"
        )
    return value
