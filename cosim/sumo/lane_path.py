"""A lane and its continuation: crossings, signals, limits and neighbouring lanes along it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from analysis.polylines import arc_lengths, crossing_point
from controllers.interface import CrossingKind
from cosim.arrays import FloatArray
from cosim.sumo.bends import BEFORE, CAR, Bend, Turning, highest_speed, widened
from cosim.sumo.lane_chain import Piece, without_jogs
from cosim.sumo.network import Connection, NetCrossing
from cosim.sumo.path import Path

STOP_MARGIN = 1.0
"""Distance from a stop line to the crossing behind it [m]."""
SAME_APPROACH = 8.0
"""Vehicles stop at a lane's end for a crossing that begins at most this far behind it [m].

In a small junction, this includes the second crossing of a turn: a car that waited between the two would
stand on the first one, with people on all sides.
"""
PASSED_AXIS = 6.0
"""A crossing is on the path if its axis ends nearer to the path than this [m]."""
LEFT_BEHIND = 30.0
"""If a path meets a crossing twice, a meeting further than this before its edge counts as passed [m]."""
DIVERGED = 12.0
"""Lanes further apart than this do not count as beside each other [m]."""
WIDE = 2.0
"""A redrawn bend that gets further than this from the middle of its lanes is in the way of others [m]."""
WAY_SPACING = 0.5
"""[m]"""


@dataclass(frozen=True, slots=True)
class PathCrossing:
    """A crossing where a path meets it; distances along the path."""

    source: NetCrossing
    middle: float
    entry: float
    exit: float
    stop_line: float
    origin: FloatArray
    """World position of the meeting point [m]."""
    heading: float
    """Heading of the path there [rad]."""
    right: float
    left: float

    @property
    def kind(self) -> CrossingKind:
        """Kind of the crossing, which gives the right of way."""
        return self.source.kind


@dataclass(frozen=True, slots=True)
class PathSignal:
    """A traffic light on a path."""

    name: str
    index: int
    stop_line: float


@dataclass(frozen=True, slots=True)
class PathStopSign:
    """A stop sign on a path, named after the lane that ends there."""

    name: str
    stop_line: float


@dataclass(frozen=True, slots=True)
class DrawnWay:
    """A way through a junction that leaves the lanes, such as that of a car that turns round."""

    begins: float
    """Where its first point lies, from the end of the lane before the junction [m]."""
    points: FloatArray
    """Points of the rear axle, `WAY_SPACING` apart, (n, 2) [m]."""
    ahead: FloatArray
    """Where the front bumper is then, (n, 2) [m]."""
    front: float
    """Distance from the rear axle to the front bumper [m]."""


@dataclass(frozen=True, slots=True)
class PathJunction:
    """The passage of a path through a junction."""

    connection: Connection
    start: float
    """End of the lane before it; also the stop line [m]."""
    end: float
    waiting_place: float | None = None
    """Where SUMO's vehicles wait in the middle of the junction; ``None`` if they do not [m]."""
    drawn: DrawnWay | None = field(default=None, compare=False)
    """The way through it if it leaves the lanes widely; ``None`` if it follows them."""


@dataclass(frozen=True, slots=True)
class PathBend:
    """A bend in which the lanes turn more tightly than the vehicle can, so that the path is drawn wider."""

    lane: str
    """Lane that bends: of those inside junctions, the one nearest to the middle of the bend."""
    start: float
    """Where the path leaves the lanes, and where it returns to them [m]."""
    end: float
    off: float
    """How far the vehicle gets from the middle of the lanes [m]."""


class LanePath:
    """One lane of one edge of a route and the lanes that continue it, with the objects along them.

    ``along`` is 0 where the edge begins and negative before it.
    """

    def __init__(
        self,
        polyline: FloatArray,
        origin: float,
        pieces: Sequence[Piece],
        leads_to_end: bool,
        step: int,
        turning: Turning = CAR,
        vehicle_class: str = "passenger",
    ) -> None:
        self._class = vehicle_class
        self.curve, drawn_anew = widened(Path.rounded(*without_jogs(polyline, origin, pieces)), turning)
        knots = arc_lengths(polyline) + origin

        def along(station: float) -> float:
            if any(bend.start < station < bend.end for bend in drawn_anew):
                return self.curve.station_along(station)
            # The curve may differ from the lanes: search for their ends near the points where they are drawn.
            x, y = (float(np.interp(station, knots, polyline[:, axis])) for axis in (0, 1))
            return self.curve.place_near(x, y, self.curve.station_along(station))[0]

        self.pieces = tuple(
            Piece(piece.lane, piece.step, along(piece.start), along(piece.end)) for piece in pieces
        )
        self.bends = tuple(self._path_bend(bend) for bend in drawn_anew)
        ahead = self.pieces[next(number for number, piece in enumerate(pieces) if piece.start > -1e-6) :]
        self.own = ahead[0]
        self.edge_end = self.own.end
        following = [piece for piece in ahead if piece.step > step and not piece.lane.internal]
        self.next_start = following[0].start if following else math.inf
        """Where the next edge of the route begins [m]; inf if this lane does not lead there."""
        self.chain_end = ahead[-1].end
        """Where the lanes that were followed end [m]."""
        self.leads_to_end = leads_to_end
        """Whether the chain ends because the route does."""
        self._front = turning.front
        self._slow = tuple(self._slow_stretch(bend, turning) for bend in self.bends)
        self._limits = self._speed_limits({})
        self.crossings: tuple[PathCrossing, ...] = ()
        self.signals: tuple[PathSignal, ...] = ()
        self.stop_signs: tuple[PathStopSign, ...] = ()
        self.junctions: tuple[PathJunction, ...] = ()
        self.signals_beside: tuple[PathSignal, ...] = ()
        self.junctions_beside: tuple[PathJunction, ...] = ()
        self._offsets: dict[int, FloatArray] = {}

    @property
    def limits(self) -> tuple[FloatArray, FloatArray]:
        """Where speed limits begin [m], and the limits [m/s]; redrawn bends have one for the vehicle."""
        return self._limits

    def limits_with(self, changed: Mapping[str, float]) -> tuple[FloatArray, FloatArray]:
        """Return the `limits` while some lanes have other limits than in the network.

        Parameters
        ----------
        changed : present limits of those lanes, by lane [m/s]
        """
        if changed and any(piece.lane.name in changed for piece in self.pieces):
            return self._speed_limits(changed)
        return self._limits

    @cached_property
    def widths(self) -> FloatArray:
        """Lane width at each sample of the curve [m]."""
        starts = np.array([piece.start for piece in self.pieces])
        index = np.clip(np.searchsorted(starts, self.curve.along, side="right") - 1, 0, None)
        return np.array([piece.lane.width for piece in self.pieces])[index]

    def between(self, start: float, end: float) -> list[Piece]:
        """Return the parts of the path between two places [m]."""
        return [piece for piece in self.pieces if piece.start < end and piece.end > start]

    def piece_at(self, along: float) -> Piece:
        """Return the piece at a place [m]; beyond the ends, the first or last one."""
        for piece in self.pieces:
            if along < piece.end:
                return piece
        return self.pieces[-1]

    def bend_at(self, along: float, length: float = 0.0) -> PathBend | None:
        """Return the redrawn bend at a place or within ``length`` before it [m], or ``None``."""
        for bend in self.bends:
            if bend.start < along and along - length < bend.end:
                return bend
        return None

    def _path_bend(self, bend: Bend) -> PathBend:
        start, end = self.curve.station_along(bend.start), self.curve.station_along(bend.end)
        on_it = self.between(start, end) or [self.piece_at(start)]
        inside = [piece for piece in on_it if piece.lane.internal]
        middle = 0.5 * (start + end)
        nearest = min(inside or on_it, key=lambda piece: max(piece.start - middle, middle - piece.end))
        return PathBend(nearest.lane.name, start, end, bend.off)

    def beside(self, other: LanePath) -> FloatArray:
        """Return how far left of this path another lies, at each sample [m]; nan where it is not beside."""
        key = id(other)
        if key not in self._offsets:
            # Both start where their edge begins, so that on a way round a block the same lap is compared.
            along, across, _ = other.curve.project(self.curve.points, near=self.curve.along)
            # `across` is this curve seen from the other one: the offset has the other sign.
            gone = (np.abs(across) > DIVERGED) | (along > other.chain_end + 5.0)
            self._offsets[key] = np.where(gone, np.nan, -across)
        return self._offsets[key]

    def _slow_stretch(self, bend: PathBend, turning: Turning) -> tuple[float, float, float]:
        """Return where a bend slows the vehicle down [m], and how fast it can steer through it [m/s]."""
        start, end = max(bend.start - BEFORE, self.pieces[0].start), bend.end + BEFORE
        return start, end, highest_speed(self.curve, start, end, turning)

    def _speed_limits(self, changed: Mapping[str, float]) -> tuple[FloatArray, FloatArray]:
        given: list[tuple[float, float]] = []
        for piece in self.pieces:
            limit = piece.lane.limit(self._class, changed.get(piece.lane.name))
            if not given or limit != given[-1][1]:
                given.append((piece.start, limit))
        starts, limits = (np.array(column) for column in zip(*given, strict=True))
        for start, end, speed in self._slow:
            places = np.union1d(starts, [start, end])
            limits = limits[np.searchsorted(starts, places, side="right") - 1]
            limits = np.where((places >= start) & (places < end), np.minimum(limits, speed), limits)
            starts = places
        return starts, limits

    def meet(self, crossings: Sequence[NetCrossing], connections: Sequence[Connection]) -> None:
        """Find the crossings, signals, stop signs and junctions along the path.

        Parameters
        ----------
        crossings : crossings that may be on the path
        connections : connections between its lanes, in driving order
        """
        sources = [number for number, piece in enumerate(self.pieces) if not piece.lane.internal]
        ends = [self.pieces[number].end for number in sources]
        found = [self._meeting(crossing, ends) for crossing in crossings]
        self.crossings = tuple(sorted((c for c in found if c is not None), key=lambda c: c.entry))
        # Matched by place, not by name: on a way round a block, the same lane comes again.
        left = [
            (connection, end, self.pieces[number + 1 : number + 1 + len(connection.via)])
            for connection, end, number in zip(connections, ends, sources, strict=False)
        ]
        self.signals = tuple(
            PathSignal(connection.signal, connection.signal_index, end)
            for connection, end, _ in left
            if connection.signal
        )
        self.stop_signs = tuple(
            PathStopSign(connection.source, end) for connection, end, _ in left if connection.stop_sign
        )
        self.junctions = tuple(
            PathJunction(
                connection,
                end,
                via[-1].end,
                via[0].end if len(via) > 1 else None,
                self._drawn_between(end, via[-1].end),
            )
            for connection, end, via in left
            if via
        )

    def _drawn_between(self, start: float, end: float) -> DrawnWay | None:
        """Return the way between two places [m] and through the wide bends there; ``None`` without one."""
        wide = [bend for bend in self.bends if bend.off > WIDE and bend.start < end and start < bend.end]
        if not wide:
            return None
        first, last = min(start, *(bend.start for bend in wide)), max(end, *(bend.end for bend in wide))
        along = np.arange(first, last + WAY_SPACING, WAY_SPACING)
        points = self.curve.at(along, np.zeros(len(along)))
        heading = np.interp(along, self.curve.along, self.curve.heading)
        ahead = points + self._front * np.column_stack((np.cos(heading), np.sin(heading)))
        return DrawnWay(first - start, points, ahead, self._front)

    def leave_beside(self, way: Connection, length: float) -> None:
        """Note a way beside the end of these lanes by which a vehicle may still follow its route.

        A vehicle that changes lanes at the very end obeys the light of that way, and yields where it has to.

        Parameters
        ----------
        way : connection of a lane beside the last one
        length : length of the way through the junction [m]
        """
        if way.signal:
            self.signals_beside = (PathSignal(way.signal, way.signal_index, self.chain_end),)
        if way.via:
            self.junctions_beside = (PathJunction(way, self.chain_end, self.chain_end + length),)

    def _meeting(self, crossing: NetCrossing, ends: Sequence[float]) -> PathCrossing | None:
        axis = _lengthened(crossing.axis, 0.5)
        meeting = crossing_point(self.curve.points, axis, -LEFT_BEHIND - float(self.curve.along[0]))
        if meeting is not None:
            station, _, axis_direction = meeting
            middle = float(self.curve.along[0]) + station
        else:
            passed = self._passing(crossing.axis)
            if passed is None:
                return None
            middle, axis_direction = passed
        heading = self.curve.heading_at(middle)
        forward = np.array([math.cos(heading), math.sin(heading)])
        leftward = np.array([-forward[1], forward[0]])
        # Rounding may leave a unit vector a little longer than 1.
        sine = abs(float(forward[0] * axis_direction[1] - forward[1] * axis_direction[0]))
        sine = min(max(sine, 0.3), 1.0)
        half = 0.5 * crossing.width / sine
        entry = middle - half
        # An oblique crossing begins earlier for a corner of the car than for its centre line.
        skew = min(0.9 * math.sqrt(1.0 - sine * sine) / sine, 3.0)
        stop_line = entry - STOP_MARGIN - skew
        for end in ends:
            if entry - SAME_APPROACH <= end <= middle + half:
                stop_line = min(stop_line, end)
        origin = self.curve.at(np.array([middle]), np.zeros(1))[0]
        sides = (crossing.axis[[0, -1]] - origin) @ leftward
        return PathCrossing(
            crossing, middle, entry, middle + half, stop_line, origin, heading, sides.min(), sides.max()
        )

    def _passing(self, axis: FloatArray) -> tuple[float, FloatArray] | None:
        """Return where the path passes an axis that it does not meet [m], and the axis' direction there.

        Where SUMO draws a crossing shorter than the road is wide, pedestrians on it are in the way all the
        same.
        """
        distance, nearest = float("inf"), None
        for start, end in pairwise(axis):
            way = end - start
            length = float(np.hypot(*way))
            if length == 0.0:
                continue
            share = np.clip((self.curve.points - start) @ way / length**2, 0.0, 1.0)
            away = np.hypot(*(self.curve.points - start - share[:, None] * way).T)
            number = int(away.argmin())
            first = int(self.curve.along.searchsorted(-LEFT_BEHIND))
            again = first + int(away[first:].argmin())
            # If this is the first sample of the part searched, the crossing lies still farther behind.
            if again > first and away[again] <= PASSED_AXIS:
                number = again
            if away[number] < distance:
                distance, nearest = float(away[number]), (float(self.curve.along[number]), way / length)
        return nearest if distance <= PASSED_AXIS else None


def _lengthened(line: FloatArray, by: float) -> FloatArray:
    first, last = line[0] - line[1], line[-1] - line[-2]
    return np.concatenate(
        [[line[0] + by * first / np.hypot(*first)], line[1:-1], [line[-1] + by * last / np.hypot(*last)]]
    )
