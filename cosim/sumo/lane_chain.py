"""Lanes laid end to end: one polyline without sudden side steps, and where each lane lies on it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis.polylines import arc_lengths
from cosim.arrays import FloatArray
from cosim.sumo.network import NetLane

STRAIGHT_ON = 60.0
"""How far a path continues straight where its lanes end [m]."""
JOG_LENGTH = 10.0
"""An internal lane longer than this is a bend, not a side step [m]."""
JOG_REACH = 10.0
"""A side step is drawn out to this far before and behind it [m]."""
JOG_TURN = math.radians(25.0)
"""Edges are in line if their directions differ by less than this [rad]."""
JOG_ANGLE = math.radians(8.0)
"""A side step deviates from the direction of its edge by more than this [rad]."""


@dataclass(frozen=True, slots=True)
class Piece:
    """The part of a path that belongs to one lane."""

    lane: NetLane
    step: int
    """Index of the route's edge that the lane belongs to, or that its junction follows.

    All lanes before the path's own edge have the number of the edge before it.
    """
    start: float
    end: float


def joined(
    before: Sequence[tuple[NetLane, int]], ahead: Sequence[tuple[NetLane, int]], shift: FloatArray
) -> tuple[FloatArray, float, list[Piece]]:
    """Return one polyline over all lanes, the station of its first point, and where each lane lies.

    Station 0 is where the first lane of ``ahead`` begins. The lanes of ``before`` are moved by ``shift``.
    Gaps between lanes are bridged by straight lines.
    """
    points: list[FloatArray] = []
    spans: list[tuple[NetLane, int, float, float]] = []
    length, origin = 0.0, 0.0
    everything = [*before, *ahead]
    for number, (lane, step) in enumerate(everything):
        if number == len(before):
            origin = length
        shape = lane.shape + shift if number < len(before) else lane.shape
        if points:
            jump = float(np.hypot(*(shape[0] - points[-1][-1])))
            if jump < 0.05:
                shape = shape[1:]
                jump = 0.0
            length += jump
            if number == len(before):
                origin = length
        spans.append((lane, step, length, length + lane.shape_length))
        points.append(shape)
        length += lane.shape_length
    polyline = np.concatenate([part for part in points if len(part)])
    first, last = polyline[0] - polyline[1], polyline[-1] - polyline[-2]
    head = polyline[0] + STRAIGHT_ON * first / np.hypot(*first)
    tail = polyline[-1] + STRAIGHT_ON * last / np.hypot(*last)
    polyline = np.concatenate([[head], polyline, [tail]])
    pieces = [Piece(lane, step, start - origin, end - origin) for lane, step, start, end in spans]
    return polyline, -origin - STRAIGHT_ON, pieces


def without_jogs(
    polyline: FloatArray, origin: float, pieces: Sequence[Piece]
) -> tuple[FloatArray, float, FloatArray]:
    """Return points, origin and knots of a polyline whose sudden side steps are drawn out.

    Where a network shifts lanes sideways between two edges in line, SUMO's cars slide across within a few
    metres. No real car can do so. Therefore the side step becomes a cubic that begins and ends `JOG_REACH`
    away from it. Stations do not change.
    """
    knots = arc_lengths(polyline)
    end = knots[-1]
    for piece in pieces:
        shape = piece.lane.shape
        start, stop = piece.start - origin, piece.end - origin
        low, high = start - JOG_REACH, stop + JOG_REACH
        if not piece.lane.internal or stop - start > JOG_LENGTH or low <= 0.0 or high >= end:
            continue
        ends = np.column_stack([np.interp([low, start, stop, high], knots, polyline[:, i]) for i in (0, 1)])
        inward, outward = (_unit(ends[1] - ends[0]), _unit(ends[3] - ends[2]))
        middle = _unit(shape[-1] - shape[0])
        if inward @ outward < math.cos(JOG_TURN) or inward @ middle > math.cos(JOG_ANGLE):
            continue
        share = np.linspace(0.0, 1.0, int(high - low) + 1)[:, None]
        reach = float(np.hypot(*(ends[3] - ends[0])))
        cubic = (
            (2 * share**3 - 3 * share**2 + 1) * ends[0]
            + (share**3 - 2 * share**2 + share) * reach * inward
            + (3 * share**2 - 2 * share**3) * ends[3]
            + (share**3 - share**2) * reach * outward
        )
        before, after = knots < low, knots > high
        polyline = np.concatenate([polyline[before], cubic, polyline[after]])
        knots = np.concatenate([knots[before], low + share[:, 0] * (high - low), knots[after]])
    return polyline, origin, knots


def _unit(vector: FloatArray) -> FloatArray:
    return vector / max(float(np.hypot(*vector)), 1e-9)
