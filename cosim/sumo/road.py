"""The road that one ego is told of: its lanes, limits, crossings and signals, in its route frame."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from controllers.interface import Crossing, JunctionFoe, Lane, RoadAhead, Signal, SignalState, StopSign
from cosim.sumo.gaps import LaneLine
from cosim.sumo.lane_path import PathCrossing, PathSignal
from cosim.sumo.lights import Lights
from cosim.sumo.path import interpolated
from cosim.sumo.route import VIEW
from cosim.sumo.track import Track
from cosim.sumo.view import Frame

CURVATURE_STEP = 1.0
"""Distance between values of the curvature [m]."""
_CURVATURE_GRID = CURVATURE_STEP * np.arange(151)

_STATES = {
    "r": SignalState.RED,
    "u": SignalState.RED,
    "y": SignalState.AMBER,
    "Y": SignalState.AMBER,
}
"""States that SUMO's letters stand for; all other letters let vehicles pass, perhaps after yielding."""


def road_ahead(
    frame: Frame,
    track: Track,
    crossings: Sequence[PathCrossing],
    signals: Sequence[PathSignal],
    lights: Lights,
    foes: Sequence[JunctionFoe],
    own_limit: float,
    changed_limits: Mapping[str, float],
) -> tuple[RoadAhead, dict[int, LaneLine]]:
    """Return the road and the lines of its lanes: 0 for the ego's, 1 for the one to its left, −1 right.

    Parameters
    ----------
    frame, track : frame and track of the ego
    crossings, signals : crossings and signals that the ego is told of
    lights : traffic lights at this instant
    foes : vehicles whose ways cross the ego's
    own_limit : highest speed of the ego's type of vehicle, told as a speed limit [m/s]
    changed_limits : limits of lanes where they now differ from those of the network, by lane [m/s]
    """
    path, origin = frame.path, frame.origin
    route, step = track.route, track.step
    own_width = path.piece_at(origin).lane.width
    lanes = [Lane(track.number, 0.0, own_width, _leads(route.reach(step, track.index) - origin))]
    lines = {0: LaneLine(own_width)}
    right, left = -0.5 * own_width, 0.5 * own_width
    for others in route.beside(step, track.index):
        nearest = True
        for index, other in others:
            offsets = path.beside(other)
            offset = interpolated(origin, path.curve.along, offsets)
            if math.isnan(offset):
                break
            width = other.piece_at(origin).lane.width
            right, left = min(right, offset - 0.5 * width), max(left, offset + 0.5 * width)
            if nearest:
                side = 1 if offset > 0.0 else -1
                leads = _leads(route.reach(step, index) - origin)
                lanes.append(Lane(track.number + side, offset, width, leads))
                lines[side] = LaneLine(width, path.curve.along, offsets, origin)
            nearest = False
    lanes.sort(key=lambda lane: lane.number)
    starts, limits = path.limits_with(changed_limits)
    first = max(int(starts.searchsorted(origin, "right")) - 1, 0)
    limit_along = starts[first:] - origin
    limit_along[0] = min(limit_along[0], 0.0)
    road = RoadAhead(
        lanes=tuple(lanes),
        reference=track.number,
        right_edge=right,
        left_edge=left,
        curvature=np.interp(origin + _CURVATURE_GRID, path.curve.along, path.curve.curvature),
        curvature_step=CURVATURE_STEP,
        limit_along=limit_along,
        limit=np.minimum(limits[first:], own_limit),
        crossings=tuple([_crossing(crossing, origin, lights) for crossing in crossings]),
        signals=tuple([_signal(signal, origin, lights) for signal in signals]),
        stop_signs=tuple([StopSign(sign.name, sign.stop_line - origin) for sign in frame.stop_signs()]),
        foes=tuple(foes),
        route_end=path.chain_end - origin if path.leads_to_end else math.inf,
    )
    return road, lines


def _leads(distance: float) -> float:
    return distance if distance < VIEW else math.inf


def _crossing(crossing: PathCrossing, origin: float, lights: Lights) -> Crossing:
    source = crossing.source
    return Crossing(
        source.name,
        lights.kind(source),
        crossing.entry - origin,
        crossing.exit - origin,
        crossing.stop_line - origin,
        crossing.right,
        crossing.left,
        lights.pedestrians_have_green(source),
    )


def _signal(signal: PathSignal, origin: float, lights: Lights) -> Signal:
    letter = lights.letter(signal.name, signal.index)
    return Signal(signal.name, signal.stop_line - origin, _STATES.get(letter, SignalState.GREEN))
