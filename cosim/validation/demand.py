"""Rebuilds the demand of a recording: departure, origin, destination and mode, but not how people moved."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import pandas as pd
import shapely

from analysis.files import write_text
from analysis.trajectories.table import PEDESTRIAN
from cosim.sumo.network import NetLane, Network
from cosim.tracks.lanes import SUMO_CLASS

LEAST_WAY_M = 10.0
"""Vehicles that move less than this are left out, as parked or queueing throughout the recording [m]."""
LEAST_WALK_M = 3.0
AHEAD_M, DIRECTION_SAMPLES = 4.0, 20
"""The sidewalk of a pedestrian is searched this far ahead [m], in the direction over this many samples."""
FROM_END_M = 0.5
"""Vehicles depart at least this far from the end of a lane [m]."""
Types = Mapping[str, Mapping[str, str]]
"""Attributes of the SUMO types of road users, by class."""


@dataclass(frozen=True, slots=True)
class Rebuilt:
    """The rebuilt demand."""

    routes: Path
    departed: Mapping[str, int]
    """Number of road users in the demand, by class."""
    left_out: Mapping[str, int]
    """Number of road users of the recording who have no way from origin to destination, or who hardly moved,
    by class."""


@dataclass(frozen=True, slots=True)
class _Place:
    edge: str
    lane: int
    at: float


def rebuild(
    frame: pd.DataFrame, network: Network, path: Path, begin_s: float, types: Types, with_speeds: bool = False
) -> Rebuilt:
    """Write the demand of a recording as a route file.

    Parameters
    ----------
    frame : placed samples, as `cosim.tracks.fit.placed` returns them
    network
    path : file to write to
    begin_s : simulated time of the beginning of the recording [s]
    types : further attributes of the types; classes without an entry use SUMO's own types
    with_speeds : whether vehicles depart at their recorded speed, however near others are; otherwise they
        depart at a speed that SUMO finds safe, and only where it does
    """
    ways = _Ways(network, with_speeds)
    lines: list[tuple[float, str]] = []
    departed: dict[str, int] = {}
    left_out: dict[str, int] = {}
    named: set[str] = set()
    for recorded, track in frame.groupby("id", sort=True):
        kind = str(track["kind"].iloc[0])
        name = allowed_name(str(recorded), named)
        line = ways.walk(name, track, begin_s) if kind == PEDESTRIAN else ways.trip(name, track, begin_s)
        counts = left_out if line is None else departed
        counts[kind] = counts.get(kind, 0) + 1
        if line is not None:
            lines.append((begin_s + float(track["time_s"].iloc[0]), line))
    lines.sort()
    declared = [_type(kind, types.get(kind, {})) for kind in sorted({*departed, *types})]
    write_text(path, "\n".join(["<routes>", *declared, *(line for _, line in lines), "</routes>", ""]))
    return Rebuilt(path, departed, left_out)


def allowed_name(name: str, taken: set[str]) -> str:
    """Return a unique name that SUMO accepts, without blanks and most signs, and add it to ``taken``."""
    plain = made = re.sub(r"[^A-Za-z0-9_.-]", "_", name)
    number = 1
    while made in taken:
        number += 1
        made = f"{plain}_{number}"
    taken.add(made)
    return made


def type_name(kind: str) -> str:
    """Return the id of the SUMO type of a class of road users."""
    return f"recorded_{kind}"


def _type(kind: str, attributes: Mapping[str, str]) -> str:
    values = {"id": type_name(kind), "vClass": SUMO_CLASS[kind], **attributes}
    return "    <vType " + " ".join(f"{key}={quoteattr(value)}" for key, value in values.items()) + "/>"


class _Ways:
    """Finds the edges from which road users came and to which they went."""

    def __init__(self, network: Network, with_speeds: bool) -> None:
        self._network = network
        self._with_speeds = with_speeds
        self._next: dict[str, dict[str, list[str]]] = {}
        self._sidewalks = [
            lane
            for lane in network.lanes.values()
            if lane.permissions.allows("pedestrian")
            and not lane.internal
            and not lane.permissions.allows("passenger")
        ]
        self._lines = np.array([shapely.LineString(lane.shape) for lane in self._sidewalks], dtype=object)

    def trip(self, name: str, track: pd.DataFrame, begin_s: float) -> str | None:
        """Return the trip of a vehicle; ``None`` if it has no way or hardly moved."""
        x, y = track["x_m"].to_numpy(), track["y_m"].to_numpy()
        if np.hypot(x - x[0], y - y[0]).max() < LEAST_WAY_M:
            return None
        kind = str(track["kind"].iloc[0])
        places = track["place"].to_list()
        along = track["along_m"].to_numpy() + 0.5 * float(track["length_m"].iloc[0])
        start, end = self._start(places, along), self._end(places)
        if start is None or end is None or not self._leads(start.edge, end, SUMO_CLASS[kind]):
            return None
        if self._with_speeds:
            # Real drivers are nearer to each other than SUMO's insertion checks allow.
            departure = {"departSpeed": f"{float(track['speed_mps'].iloc[0]):.2f}", "insertionChecks": "none"}
        else:
            departure = {"departSpeed": "max"}
        return "    <trip " + _attributes(
            {
                "id": name,
                "type": type_name(kind),
                "depart": f"{begin_s + float(track['time_s'].iloc[0]):.2f}",
                "from": start.edge,
                "to": end,
                # SUMO's bicycles never leave a cycle lane that leads elsewhere.
                "departLane": "best" if kind == "bicycle" else str(start.lane),
                "departPos": f"{start.at:.2f}",
                **departure,
                "arrivalPos": "max",
            }
        )

    def _start(self, places: Sequence[str], along: np.ndarray) -> _Place | None:
        """Return where a vehicle came into view: on its first lane, or before the junction it was in."""
        for place, way in zip(places, along.tolist(), strict=True):
            lane = self._network.lanes.get(place)
            if lane is None:
                continue
            if lane.internal:
                source = self._network.through.get(place)
                if source is None:
                    continue
                before = self._network.lanes[source.source]
                return _Place(before.edge, before.index, max(before.length - FROM_END_M, 0.0))
            at = min(way / max(lane.shape_length, 1e-6) * lane.length, lane.length - FROM_END_M)
            return _Place(lane.edge, lane.index, max(at, 0.0))
        return None

    def _end(self, places: Sequence[str]) -> str | None:
        """Return the edge on which a vehicle was last, or into which it was turning."""
        for place in reversed(places):
            lane = self._network.lanes.get(place)
            if lane is None:
                continue
            if not lane.internal:
                return lane.edge
            through = self._network.through.get(place)
            if through is not None:
                return self._network.lanes[through.target].edge
        return None

    def _leads(self, start: str, end: str, vehicle_class: str) -> bool:
        """Return whether a class of vehicles can drive from one edge to another."""
        if start == end:
            return True
        onward = self._next.setdefault(vehicle_class, {})
        seen, waiting = {start}, deque([start])
        while waiting:
            edge = waiting.popleft()
            if edge not in onward:
                lanes = self._network.edges[edge]
                onward[edge] = sorted(
                    {
                        self._network.lanes[one.target].edge
                        for lane in lanes
                        for one in self._network.connections.get(lane, ())
                        if self._network.passable(one, vehicle_class)
                    }
                )
            for other in onward[edge]:
                if other == end:
                    return True
                if other not in seen:
                    seen.add(other)
                    waiting.append(other)
        return False

    def walk(self, name: str, track: pd.DataFrame, begin_s: float) -> str | None:
        """Return the walk of a pedestrian from sidewalk to sidewalk; ``None`` if there is none."""
        x, y = track["x_m"].to_numpy(), track["y_m"].to_numpy()
        if not self._sidewalks or np.hypot(x - x[0], y - y[0]).max() < LEAST_WALK_M:
            return None
        count = min(len(x) - 1, DIRECTION_SAMPLES)
        places = track["place"].to_list()
        start = self._sidewalk(places[0], x[0], y[0], x[0] - x[count], y[0] - y[count])
        end = self._sidewalk(places[-1], x[-1], y[-1], x[-1] - x[-1 - count], y[-1] - y[-1 - count])
        if start.edge == end.edge and abs(start.at - end.at) < LEAST_WALK_M:
            return None
        person = _attributes(
            {
                "id": name,
                "type": type_name(PEDESTRIAN),
                "depart": f"{begin_s + float(track['time_s'].iloc[0]):.2f}",
                "departPos": f"{start.at:.2f}",
            }
        ).removesuffix("/>")
        stage = _attributes({"from": start.edge, "to": end.edge, "arrivalPos": f"{end.at:.2f}"})
        return f"    <person {person}><walk {stage}</person>"

    def _sidewalk(self, place: str, x: float, y: float, way_x: float, way_y: float) -> _Place:
        """Return the sidewalk from or to which a pedestrian walked, even if seen only on a crossing."""
        length = float(np.hypot(way_x, way_y))
        direction = np.array([way_x, way_y]) / length if length > 0.0 else np.zeros(2)
        at_place = np.array([x, y])
        crossing = self._network.crossings.get(place)
        if crossing is not None:
            ends = crossing.axis[[0, -1]]
            at_place = ends[int(np.argmax((ends - at_place) @ direction))]
        point = shapely.Point(*(at_place + AHEAD_M * direction))
        best = int(np.argmin(shapely.distance(self._lines, point)))
        lane: NetLane = self._sidewalks[best]
        at = float(shapely.line_locate_point(self._lines[best], point))
        return _Place(lane.edge, lane.index, min(at / max(lane.shape_length, 1e-6), 1.0) * lane.length)


def _attributes(values: Mapping[str, str]) -> str:
    return " ".join(f"{key}={quoteattr(value)}" for key, value in values.items()) + "/>"
