"""The competent and careful driver of UN R157 as a reference: sees the risk, reacts with a delay, brakes.

Along: car-following that obeys leaders, signals, right of way, speed limits and bends. For a pedestrian
whose path leads in front of the ego, the driver brakes with 0.774 g, which builds up within 0.6 s and begins
0.75 s after the risk could be perceived. Across: as the road and its vehicles require.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from controllers.arrays import BoolArray, FloatArray
from controllers.driving.lane_keeping import instants
from controllers.driving.standing import HOLDING, STANDING
from controllers.driving.traffic_driver import TrafficDriver
from controllers.geometry.contact_times import disc_contact_times
from controllers.interface import Command, Controller, Decision, EgoState, Perception, Plan
from controllers.own_part import OwnPart, differ
from controllers.safety.emergency_braking import GRAVITY
from controllers.settings import ControllerSettings, NotNegative, Positive

START_SPEED = 2.0
"""A standing driver does not start if they would meet a pedestrian at this speed [m/s]."""
WALKING = 0.5
"""Pedestrians who move across the road faster than this when they come into view are crossing it [m/s]."""


@dataclass(frozen=True, slots=True)
class Reaction:
    """What the driver perceives, and how they brake."""

    delay: float
    """Time from the perception of the risk to the beginning of braking [s]."""
    deceleration: float
    """[m/s^2]"""
    ramp: float
    """Time from the beginning of braking to its full value [s]."""
    wander: float
    """Pedestrians who have moved less than this across the road are not perceived as a risk yet [m]."""
    horizon: float
    """Contacts later than this are not a risk yet [s]."""


class CarefulDriver:
    """Perceives risks of contact with pedestrians, and reacts to the first of them as one driver does."""

    def __init__(self, reaction: Reaction) -> None:
        self._reaction = reaction
        self._traffic = TrafficDriver()
        self._moved: dict[str, float] = {}
        """How far each pedestrian in view has moved across the road since coming into view [m]."""
        self._time: float | None = None
        self._since: float | None = None
        self._speed = 0.0

    def decide(self, perception: Perception) -> Decision:
        """Return which lane to be in, and for whom the ego brakes or waits."""
        risk = self._risk(perception)
        ego = perception.ego
        if not risk:
            self._since = None
        elif self._since is None:
            self._since, self._speed = ego.time, ego.speed
        return self._traffic.decide(perception, risk)

    def plan(self, perception: Perception, decision: Decision) -> Plan:
        """Drive towards the target lane; the reaction has the last word on the acceleration."""
        times = instants(perception.ego)
        allowed = self._traffic.accelerations(perception, decision)
        acceleration = np.minimum(allowed, self._braking(perception.ego, times))
        command = Command(times, acceleration, self._traffic.steering(perception, decision, acceleration))
        risk = self._since is not None
        return Plan(command, own=OwnPart(risk, risk, risk and differ(acceleration, allowed)))

    def _risk(self, perception: Perception) -> str:
        """Return the pedestrian whom the ego would meet first, among those perceived as a risk."""
        ego, them = perception.ego, perception.pedestrians
        speeds = [START_SPEED] if ego.speed < STANDING else [ego.speed]
        if self._since is not None:
            speeds.append(self._speed)  # a risk is over when the ego, going on as before, would meet nobody
        perceived = self._perceived(perception)
        met = np.min([self._met(perception, speed) for speed in speeds], axis=0)
        met = np.where(perceived & (met <= self._reaction.horizon), met, np.inf)
        return them.names[int(np.argmin(met))] if np.isfinite(met).any() else ""

    def _met(self, perception: Perception, speed: float) -> FloatArray:
        """Return when the ego would meet each of them at constant velocities; inf for never or abeam [s]."""
        ego, them = perception.ego, perception.pedestrians
        body, across = ego.body, them.across - ego.across
        x_speed = them.along_speed - speed
        times = disc_contact_times(
            *(-body.rear_overhang, body.front, 0.5 * body.width),
            *(them.along, across, x_speed, them.across_speed, them.radius),
        )
        return np.where(them.along > body.front, times, np.inf)

    def _perceived(self, perception: Perception) -> BoolArray:
        """Return who is in the ego's path, or has moved farther across the road than people wander."""
        ego, them = perception.ego, perception.pedestrians
        elapsed = 0.0 if self._time is None else ego.time - self._time
        self._time = ego.time
        ways = [
            self._moved.get(name, self._came(float(speed))) + abs(float(speed)) * elapsed
            for name, speed in zip(them.names, them.across_speed, strict=True)
        ]
        self._moved = dict(zip(them.names, ways, strict=True))
        inside = np.abs(them.across - ego.across) < 0.5 * ego.body.width + them.radius
        return np.asarray(inside | (np.array(ways) >= self._reaction.wander))

    def _came(self, across_speed: float) -> float:
        """Return the distance credited to a pedestrian who comes into view: one who walks does not wander."""
        return self._reaction.wander if abs(across_speed) > WALKING else 0.0

    def _braking(self, ego: EgoState, times: FloatArray) -> FloatArray:
        """Return the largest accelerations that the reaction allows in steps from ``times`` on [m/s^2]."""
        if self._since is None:
            return np.full(len(times), np.inf)
        if ego.speed < STANDING:
            return np.full(len(times), HOLDING)
        rule, drive = self._reaction, ego.drive
        step = float(times[1] - times[0]) if len(times) > 1 else ego.plan_interval
        # The model gives the braking of the car itself: the command is what makes its lagging brake do it.
        lags = 1.0 - math.exp(-step / drive.drive_lag) if drive.drive_lag > 0.0 else 1.0
        elapsed = ego.time - self._since + times + step - rule.delay
        wanted = np.clip(elapsed / max(rule.ramp, 1e-9), 0.0, 1.0) * rule.deceleration
        asked = np.full(len(times), np.inf)
        reached = max(-ego.acceleration, 0.0)
        for k in np.flatnonzero(elapsed > 0.0).tolist():
            command = min(max(reached + (wanted[k] - reached) / lags, 0.0), drive.max_deceleration)
            reached += (command - reached) * lags
            asked[k] = -command
        return asked


class Settings(ControllerSettings):
    """The parameters of the controller.

    Notes
    -----
    Delay, deceleration, ramp and wander are those of the performance model of [R157]_, after a
    transcription. That model is for a vehicle that cuts in. Our own assumptions are that the driver perceives
    pedestrians who have moved as far like such a vehicle, and at once if they come into view walking; the
    condition of a contact at constant velocities; and the horizon. The 0.4 s in which the model's driver
    evaluates the risk are left out, as in the metric preventable_r157; ``delay_s=1.15`` includes them.
    """

    delay_s: NotNegative = 0.75
    """Time from the perception of the risk until braking begins."""
    deceleration_g: Positive = 0.774
    """Full braking, in g, or what the drive can do if that is less."""
    ramp_s: NotNegative = 0.6
    """Time from then until full braking; the deceleration grows linearly."""
    wander_m: NotNegative = 0.375
    """Pedestrians beside the ego's path are a risk once they have moved this far across the road."""
    horizon_s: Positive = 4.0
    """A contact later than this, if everybody goes on, is not a risk yet."""


def build(settings: Settings) -> Controller:
    """Build the controller."""
    return CarefulDriver(
        Reaction(
            delay=settings.delay_s,
            deceleration=settings.deceleration_g * GRAVITY,
            ramp=settings.ramp_s,
            wander=settings.wander_m,
            horizon=settings.horizon_s,
        )
    )
