"""A pedestrian who waits at the beginning of a line, walks along it and disappears at its end."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from cosim.arrays import FloatArray
from cosim.pedestrians.behaviour import Leg, Scene, State, duration_of, paused, travelled
from cosim.pedestrians.line import Line
from cosim.pedestrians.manner import Manner, Pace, soonest_arrival
from cosim.pedestrians.start import Start

COMES_INTO_VIEW_M = 120.0
"""A pedestrian whose start depends on an ego appears when the ego is this near [m]."""
COMES_INTO_VIEW_S = 5.0
"""... or when the ego would make them set off within this time [s]."""
STOPS_BEFORE = 0.3
"""A watchful pedestrian stops this long before entering a vehicle's path [s]."""
ASIDE = 8.0
"""Vehicles that cannot come nearer than this in time are not examined in detail [m]."""


@dataclass(frozen=True, slots=True)
class Walker:
    """A walk along a line.

    Parameters
    ----------
    line : the line to walk along
    pace, manner : how the pedestrian walks
    start : when they set off
    length : length of the walk; at most that of the line [m]
    stay : time that they stand at the end [s]
    appears : earliest time of appearance; with ``ego``, they wait until that ego is near [s]
    ego : name of the ego whose approach triggers the start; empty for none
    watches : gap needed to step in front of a vehicle; ``None`` if they do not look again on the way [s]
    """

    line: Line
    pace: Pace
    manner: Manner
    start: Start
    length: float
    stay: float = 0.0
    appears: float = 0.0
    ego: str = ""
    watches: float | None = None

    def first(self, scene: Scene) -> State | None:
        """Return the pedestrian standing at the start, once present."""
        if scene.time < self.appears - 1e-9 or (self.ego and not self._is_near(scene)):
            return None
        return State(self.line.x, self.line.y)

    def next(self, state: State, scene: Scene, until: float) -> State | None:
        """Return a later state; exact even for starts and speed changes between two steps."""
        if state.started is None:
            instant = self.start.instant(scene, until)
            if instant is None:
                return state
            legs = self.manner.legs(self.pace, self.length)
            state = replace(state, started=instant, legs=legs)
        started = scene.time if state.started is None else state.started
        legs, stands = state.legs, False
        if started < scene.time:
            changed = self.manner.react(
                legs, scene.time - started, self.length, soonest_arrival(self.line, scene.ego(self.ego))
            )
            legs = legs if changed is None else changed
            paused = self._paused(legs, scene, scene.time - started, until - scene.time)
            legs, stands = paused, paused is not legs
        elapsed = until - started
        if elapsed > duration_of(legs) + self.stay:
            return None
        way, speed = travelled(legs, elapsed)
        if stands:
            speed = 0.0  # at the end of a pause, ``travelled`` gives the speed of the next part
        (x, y), (east, north) = self.line.point(way), self.line.direction
        return State(x, y, speed * east, speed * north, started, legs)

    def onward(self, state: State, time: float) -> FloatArray:
        """Return the next metres of the walk, towards the start after turning back."""
        if state.started is None:
            return self.line.onward(0.0)
        way, speed = travelled(state.legs, time - state.started)
        goal, _ = travelled(state.legs, duration_of(state.legs))
        if speed < 0.0 or goal < way:
            return Line(state.x, state.y, self.line.x, self.line.y).onward(0.0)
        return Line(self.line.x, self.line.y, *self.line.point(max(goal, 1e-3))).onward(way)

    def _paused(self, legs: tuple[Leg, ...], scene: Scene, elapsed: float, step: float) -> tuple[Leg, ...]:
        """Return the plan, with a pause of one step if the walk would enter an approaching vehicle's path."""
        way, speed = travelled(legs, elapsed)
        later = travelled(legs, elapsed + step + STOPS_BEFORE)[0]
        if self.watches is None or later == way:
            return legs
        x, y = self.line.point(way)
        for vehicle in scene.vehicles:
            reach = vehicle.speed * (self.watches + STOPS_BEFORE + step) + vehicle.length + ASIDE
            if math.dist((x, y), (vehicle.x, vehicle.y)) > reach:
                continue
            meeting = self.line.meeting(vehicle)
            if meeting is None:
                continue
            # On the way back, they enter the vehicle's path from the other side.
            missing = meeting.enters - way if later > way else way - meeting.leaves
            if not 0.0 < missing <= abs(later - way):
                continue
            enters = missing / max(abs(speed), self.pace.speed)
            if not meeting.leaves_gap(vehicle, enters, self.watches):
                return paused(legs, elapsed, step)
        return legs

    def _is_near(self, scene: Scene) -> bool:
        near = any(
            0.0 <= vehicle.ahead(self.line.x, self.line.y)[0] <= COMES_INTO_VIEW_M
            for vehicle in scene.ego(self.ego)
        )
        return near or self.start.instant(scene, scene.time + COMES_INTO_VIEW_S) is not None
