"""Roadside units that see pedestrians and tell egos by radio: message rate, latency, losses."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pydantic import field_validator

from controllers.settings import NotNegative, Positive
from cosim.arrays import BoolArray, FloatArray, IntArray
from cosim.sensing import lines_of_sight
from cosim.sensing.interface import FARTHEST_UNIT, Belief, Scene, Site, State
from cosim.sensing.noise import Noise
from cosim.sensing.settings import FullAngle, Probability, Settings
from cosim.sensing.tracks import AGILITY

AT_CROSSINGS = "crossings"
_REACH = 100.0
"""Units further from an ego than this plus their range are skipped: they see no pedestrian near it [m]."""
_UNIT = re.compile(r"[^\s,]+(?:,[^\s,]+){1,2}")


class RadioSettings(Settings):
    """What the units and the radio are like; all defaults are assumed."""

    units: str = AT_CROSSINGS
    """``crossings``: one at an end of each; or places ``x,y`` or ``x,y,heading_deg``, separated by blanks."""
    unit_range_m: Positive = 40.0
    """Range, to the middle of a pedestrian."""
    unit_field_of_view_deg: FullAngle = 360.0
    """Full angle of the field of view, centred on the unit's heading."""
    unit_sees_over_vehicles: bool = True
    """Whether the unit is mounted high enough to see over vehicles; buildings still hide pedestrians from
    it."""
    unit_position_noise_m: NotNegative = 0.2
    """Standard deviation along either axis."""
    unit_velocity_noise_mps: NotNegative = 0.2
    """Standard deviation along either axis."""
    unit_miss_probability: Probability = 0.02
    """Probability that a pedestrian in view is missing from a message."""
    message_rate_hz: Positive = 10.0
    """Rate of messages, each with everybody in view; at most one for each look of the ego."""
    latency_ms: NotNegative = 50.0
    """Smallest time from the measurement until the ego has it."""
    latency_jitter_ms: NotNegative = 0.0
    """Mean of the exponentially distributed time added to the latency."""
    loss_probability: Probability = 0.0
    """Probability that a message never arrives."""
    message_hold_s: NotNegative = 1.0
    """Time after the measurement for which the ego extrapolates what it was told."""

    @field_validator("units")
    @classmethod
    def are_places(cls, text: str) -> str:
        """Check that each unit has two or three finite numbers."""
        if text.strip() == AT_CROSSINGS:
            return AT_CROSSINGS
        words = text.split()
        for word in words:
            try:
                right = _UNIT.fullmatch(word) and all(math.isfinite(float(one)) for one in word.split(","))
            except ValueError:
                right = False
            if not right:
                raise ValueError(
                    f"expected 'crossings' or places such as '120,-4' or '120,-4,90', got {word!r}"
                )
        if not words:
            raise ValueError("expected 'crossings' or at least one place such as '120,-4'")
        return " ".join(words)


@dataclass(frozen=True, slots=True)
class Unit:
    """A sensor beside the road."""

    name: str
    place: FloatArray
    heading: float
    noise: Noise


@dataclass(frozen=True, slots=True)
class _Message:
    arrival: float
    stamp: float
    names: tuple[str, ...]
    motion: FloatArray
    """(n, 4) position and velocity as measured at the stamp."""


@dataclass(slots=True)
class _Sent:
    """The last measurement of a unit."""

    stamp: float
    state: dict[str, int]


def units_of(settings: RadioSettings, site: Site, seed: int) -> list[Unit]:
    """Return the units of a site.

    Raises
    ------
    ValueError
        If there is no crossing for a unit, or a unit is outside the network.
    """
    if settings.units == AT_CROSSINGS:
        if not site.crossings:
            raise ValueError(
                "units = crossings: the network has none; expected places such as '120,-4 320,-4'"
            )
        places = [(f"unit at {name}", *axis[0].tolist()) for name, axis in site.crossings.items()]
    else:
        places = [(f"unit at {word}", *map(float, word.split(","))) for word in settings.units.split()]
    found = []
    for name, x, y, *heading in places:
        if len(site.lanes) and lines_of_sight.distance_to_pieces(x, y, site.lanes) > FARTHEST_UNIT:
            raise ValueError(
                f"units: the {name} is outside the network: no lane within {FARTHEST_UNIT:g} m of it"
            )
        turned = math.radians(heading[0]) if heading else 0.0
        # What a unit measures is the same for every ego.
        found.append(Unit(name, np.array([x, y]), turned, Noise(seed, name)))
    return found


class Radio:
    """Messages that one ego receives by radio.

    A unit puts all pedestrians that it detects into one message, with the time of the measurement. The ego
    keeps the newest measurement of each pedestrian from any unit, and extrapolates it at the measured
    velocity.
    """

    def __init__(self, settings: RadioSettings, site: Site, seed: int, ego: str) -> None:
        self._settings = settings
        self._walls = site.walls
        self._units = units_of(settings, site, seed)
        self._places = np.array([unit.place for unit in self._units])
        self._channel = Noise(seed, f"radio:{ego}")
        self._sent: dict[str, _Sent] = {}
        self._on_the_way: list[_Message] = []
        self._known: dict[str, tuple[float, FloatArray]] = {}

    def look(self, scene: Scene) -> Belief:
        """Return what the ego has been told so far, extrapolated to now."""
        settings = self._settings
        units = list(self._near(scene))
        for unit in units:
            self._measure(unit, scene)
        self._receive(scene.time)
        self._known = {name: self._known[name] for name in scene.names if name in self._known}
        stamp = np.array([self._known[n][0] if n in self._known else -np.inf for n in scene.names])
        nothing = np.full(4, np.nan)
        motion = np.array(
            [self._known[name][1] if name in self._known else nothing for name in scene.names],
            dtype=np.float64,
        ).reshape(-1, 4)
        age = scene.time - stamp
        told = age <= settings.message_hold_s + 1e-9
        age[~told] = motion[~told] = np.nan
        velocity = motion[:, 2:].copy()
        position = motion[:, :2] + age[:, None] * velocity
        variance = settings.unit_position_noise_m**2 + (settings.unit_velocity_noise_mps * age) ** 2
        deviation = np.sqrt(variance + AGILITY * age**3 / 3.0)
        return Belief(told, position, velocity, deviation, age, self._states(scene, units, stamp))

    def _near(self, scene: Scene) -> Iterator[Unit]:
        away = np.hypot(self._places[:, 0] - scene.x, self._places[:, 1] - scene.y)
        for index in np.flatnonzero(away <= _REACH + self._settings.unit_range_m).tolist():
            yield self._units[index]

    def _measure(self, unit: Unit, scene: Scene) -> None:
        """Let a unit measure and send its next message, if it is due; its clock is the same for every ego."""
        settings = self._settings
        now, before = scene.time * settings.message_rate_hz, scene.interval * settings.message_rate_hz
        if math.floor(now + 1e-6) == math.floor(now - before + 1e-6):
            return
        within, seen = self._view(unit, scene)
        draws = unit.noise.draw(scene.names, scene.tick)
        detected = seen & (draws.uniform >= settings.unit_miss_probability)
        channel = self._channel.draw((unit.name,), scene.tick)
        lost = bool(channel.uniform[0] < settings.loss_probability)
        state = lines_of_sight.states(within, seen, detected)
        state[detected] = State.LOST if lost else State.LATE
        self._sent[unit.name] = _Sent(scene.time, dict(zip(scene.names, state.tolist(), strict=True)))
        if lost or not detected.any():
            return
        noise = np.repeat([settings.unit_position_noise_m, settings.unit_velocity_noise_mps], 2)
        motion = np.concatenate([scene.position, scene.velocity], axis=1) + draws.normal * noise
        delay = settings.latency_ms + settings.latency_jitter_ms * float(channel.exponential[0])
        self._on_the_way.append(
            _Message(
                scene.time + 1e-3 * delay,
                scene.time,
                tuple(name for name, one in zip(scene.names, detected.tolist(), strict=True) if one),
                motion[detected],
            )
        )

    def _view(self, unit: Unit, scene: Scene) -> tuple[BoolArray, BoolArray]:
        settings = self._settings
        field_of_view = math.radians(settings.unit_field_of_view_deg)
        within = lines_of_sight.in_view(
            unit.place, unit.heading, scene.position, settings.unit_range_m, field_of_view
        )
        boxes = lines_of_sight.with_ego(scene)
        if settings.unit_sees_over_vehicles:
            boxes = boxes.near(unit.place, -np.inf)
        seen = np.zeros(len(within), dtype=np.bool_)
        seen[within] = lines_of_sight.visible(
            unit.place, scene.position[within], scene.radius[within], boxes, self._walls
        )
        return within, seen

    def _receive(self, time: float) -> None:
        arrived = [message for message in self._on_the_way if message.arrival <= time + 1e-9]
        if not arrived:
            return
        self._on_the_way = [message for message in self._on_the_way if message.arrival > time + 1e-9]
        for message in arrived:
            for name, motion in zip(message.names, message.motion, strict=True):
                known = self._known.get(name)
                # If two units measured at the same instant, the first one counts.
                if known is None or message.stamp > known[0]:
                    self._known[name] = (message.stamp, motion)

    def _states(self, scene: Scene, units: list[Unit], stamp: FloatArray) -> IntArray:
        """Return the state of each pedestrian, from the newest measurements of all nearby units."""
        best = np.full(len(scene.names), int(State.OUT_OF_RANGE), dtype=np.int64)
        for unit in units:
            sent = self._sent.get(unit.name)
            if sent is None:  # the ego has come after its last message
                continue
            state = np.array(
                [sent.state.get(name, State.OUT_OF_RANGE) for name in scene.names], dtype=np.int64
            )
            measured = state <= State.LOST
            state[measured & (stamp >= sent.stamp - 1e-9)] = State.VISIBLE
            best = np.minimum(best, state)
        return best
