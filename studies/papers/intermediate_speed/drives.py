"""Drives behind one obstacle on the road without SUMO, and their measures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from controllers import catalog
from controllers.arrays import FloatArray
from controllers.interface import Body, Command, Decision, Drive, Perception, Plan, constant_command
from controllers.speed_plans.jerk_limit import Planner
from controllers.speed_plans.trapezoid_profile import PlanningLimits, Situation
from cosim.step.loop import ToWorld
from cosim.step.loop import run as run_loop
from cosim.step.plant import CAR_DRIVE
from cosim.step.toy_road import Motion, ToyCrossing, ToyPedestrian, ToyRoad, ToyVehicle
from cosim.step.toy_world import ToyWorld
from cosim.step.world import Snapshot

IDEAL = replace(CAR_DRIVE, drive_lag=0.0)
"""Actuators that react without delay."""
SAMPLE = 0.01
"""Time between two samples of a drive [s]."""
STEP = 0.1
"""Time between two perceptions [s]."""
GAP = 200.0
"""Distance to the obstacle at the start [m]."""
LENGTH = 4.5
"""Length of the obstacle [m]."""
NO_LIMIT = 30.0
"""Speed limit of the road, above the planner's own top speed [m/s]."""
SETTLED = 0.1
"""A speed has settled if it differs from the obstacle's by at most this [m/s]."""


@dataclass(frozen=True, slots=True)
class Parameters:
    """One choice of the parameters that the paper does not give."""

    top_speed: float = 40.0 / 3.6
    """[m/s]"""
    acceleration: float = 1.723
    """[m/s^2]"""
    standoff: float = 2.5
    """[m]"""

    @property
    def deceleration(self) -> float:
        """Return the deceleration that leads from the top speed to a stop in the paper's 16 s [m/s^2]."""
        return self.top_speed / 16.0

    def limits(self) -> PlanningLimits:
        """Return the parameters as planning limits, with ideal actuators."""
        return PlanningLimits(
            acceleration=self.acceleration,
            deceleration=self.deceleration,
            top_speed=self.top_speed,
            actuator_delay=0.0,
            standoff=self.standoff,
        )

    def of_controller(self, actuator_delay: float) -> Mapping[str, Any]:
        """Return the parameters as those of a controller."""
        return {
            "acceleration_mps2": self.acceleration,
            "deceleration_mps2": self.deceleration,
            "max_speed_mps": self.top_speed,
            "standoff_m": self.standoff,
            "actuator_delay_s": actuator_delay,
            "emergency_brake": False,
        }


@dataclass(slots=True)
class SampledRoad(ToyWorld):
    """The road without SUMO, recorded between the steps, where commands take effect with a delay."""

    dead_time: float = 0.0
    """Time from a command until the drive begins to follow it [s]."""
    samples: list[tuple[float, float, float, float]] = field(init=False, default_factory=list)
    """Time, position of the front bumper, speed and acceleration [s, m, m/s, m/s^2]."""
    _given: list[tuple[float, Command]] = field(init=False, default_factory=list)

    def act(self, name: str, command: Command) -> None:
        """Follow a command after the dead time."""
        ToyWorld.act(self, name, command)
        self._given.append((self.time, command))

    def advance(self) -> None:
        """Advance by one step."""
        for part in range(round(self.step / SAMPLE)):
            now = self.time + part * SAMPLE
            given, command = self._in_effect(now - self.dead_time)
            self.plant.follow(command, now - self.dead_time - given, SAMPLE)
            plant = self.plant
            self.samples.append((now + SAMPLE, plant.front[0], plant.speed, plant.acceleration))
        self.time = round(self.time + self.step, 9)

    def _in_effect(self, time: float) -> tuple[float, Command]:
        """Return the last command given up to a time, and when it was given."""
        while len(self._given) > 1 and self._given[1][0] <= time + 1e-9:
            del self._given[0]
        if self._given[0][0] <= time + 1e-9:
            return self._given[0]
        return time, constant_command(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Driven:
    """Samples of one drive."""

    time: FloatArray
    gap: FloatArray
    """Gap from bumper to bumper [m]."""
    speed: FloatArray
    acceleration: FloatArray
    obstacle_speed: FloatArray
    planned: tuple[tuple[float, FloatArray], ...] = ()
    """Some of the speed plans: the time of planning, and the speeds at ``plan_times`` after it."""
    plan_times: FloatArray = field(default_factory=lambda: np.zeros(0))

    def first_braking(self) -> float:
        """Return when the ego first slows down [s]."""
        return float(self.time[np.argmax(self.acceleration < -0.05)]) - SAMPLE

    def stands_from(self) -> float:
        """Return when the ego stops for the last time [s]."""
        return float(self.time[np.flatnonzero(self.speed > 1e-6)[-1]])

    def settles(self) -> float:
        """Return when the speed last differs from the obstacle's [s]; inf if it still does at the end."""
        off = np.flatnonzero(np.abs(self.speed - self.obstacle_speed) > SETTLED)
        return float(self.time[off[-1]]) if off[-1] + 1 < len(self.time) else float("inf")

    def at(self, time: float) -> float:
        """Return the speed at a time [m/s]."""
        return float(self.speed[np.searchsorted(self.time, time - 1e-6)])

    def after(self, time: float) -> Driven:
        """Return the part of the drive after a time."""
        late = self.time > time
        return Driven(
            self.time[late],
            self.gap[late],
            self.speed[late],
            self.acceleration[late],
            self.obstacle_speed[late],
        )

    def rms_acceleration(self) -> float:
        """Return the root mean square of the acceleration [m/s^2]."""
        return float(np.sqrt(np.mean(self.acceleration**2)))

    def range_of_speed(self) -> float:
        """Return the highest minus the lowest speed [m/s]."""
        return float(np.ptp(self.speed))

    def switches(self) -> int:
        """Return how often the ego switches between speeding up and slowing down."""
        signs = np.sign(np.where(np.abs(self.acceleration) > 0.05, self.acceleration, 0.0))
        signs = signs[signs != 0.0]
        return int(np.count_nonzero(np.diff(signs)))

    def largest_jerk(self) -> float:
        """Return the largest jerk, averaged over a plan interval [m/s^3]."""
        apart = round(STEP / SAMPLE)
        return float(np.abs(self.acceleration[apart:] - self.acceleration[:-apart]).max() / STEP)


@dataclass(slots=True)
class _Plans:
    """Record of some of the plans."""

    every: float = 5.0
    kept: list[tuple[float, FloatArray]] = field(default_factory=list)
    times: FloatArray = field(default_factory=lambda: np.zeros(0))

    def planned(
        self, perception: Perception, decision: Decision, plan: Plan, compute_s: float, to_world: ToWorld
    ) -> None:
        """Keep a plan if enough time has passed since the last one."""
        if not self.kept or perception.ego.time >= self.kept[-1][0] + self.every - 1e-9:
            self.kept.append((perception.ego.time, plan.speed))
            self.times = plan.times

    def stepped(self, snapshot: Snapshot) -> None:
        """Do nothing: the road samples itself."""


def steady(place: float, speed: float) -> Motion:
    """Return a motion at constant speed."""
    return lambda time: (place + speed * time, 0.0, speed, 0.0)


def slowing(place: float, speed: float, deceleration: float, begin: float) -> Motion:
    """Return a motion that brakes to a stop from the time ``begin`` on."""

    def at(time: float) -> tuple[float, float, float, float]:
        braked = min(max(time - begin, 0.0), speed / deceleration)
        way = speed * (min(time, begin) + braked) - 0.5 * deceleration * braked**2
        return place + way, 0.0, speed - deceleration * braked, 0.0

    return at


def driven(
    controller: str,
    motion: Callable[[float], Motion],
    parameters: Mapping[str, Any],
    *,
    speed: float = 0.0,
    duration: float = 90.0,
    drive: Drive | None = None,
    dead_time: float = 0.0,
    gap: float = GAP,
    limit: float = NO_LIMIT,
) -> Driven:
    """Drive behind an obstacle.

    Parameters
    ----------
    controller : name of the controller
    motion : function from the obstacle's start to the motion of its front bumper
    parameters : parameters of the controller
    speed : speed of the ego at the start [m/s]
    duration, dead_time : duration of the drive, and dead time of the actuators [s]
    drive : actuators; ideal by default
    gap : gap at the start [m]
    limit : speed limit of the road [m/s]
    """
    moves = motion(Body().front + gap + LENGTH)
    road = SampledRoad(
        ToyRoad(speed_limit=limit),
        vehicles=(ToyVehicle("obstacle", moves, LENGTH),),
        speed=speed,
        duration=duration,
        step=STEP,
        drive=drive or IDEAL,
        dead_time=dead_time,
    )
    plans = _Plans()
    run_loop(road, {"ego": catalog.build(controller, **parameters)}, plans)
    time, front, mine, acceleration = np.array(road.samples).T
    rear, other = np.array([(moves(float(now))[0] - LENGTH, moves(float(now))[2]) for now in time]).T
    return Driven(time, rear - front, mine, acceleration, other, tuple(plans.kept), plans.times)


def past_pedestrian(controller: str, parameters: Mapping[str, Any]) -> Driven:
    """Drive towards a pedestrian who uses a zebra crossing; the gap is the distance to the stop line [m]."""
    place = 60.0

    def walks(time: float) -> tuple[float, float, float, float]:
        return place + 2.0, -6.0 + time, 0.0, 1.0

    road = SampledRoad(
        ToyRoad(crossings=(ToyCrossing(place),)),
        pedestrians=(ToyPedestrian("pedestrian", walks),),
        speed=12.0,
        duration=25.0,
        step=STEP,
        drive=IDEAL,
    )
    plans = _Plans()
    run_loop(road, {"ego": catalog.build(controller, **parameters)}, plans)
    time, front, mine, acceleration = np.array(road.samples).T
    return Driven(time, place - 1.0 - front, mine, acceleration, 0.0 * time, tuple(plans.kept), plans.times)


def planned_through(
    planner: Planner, limits: PlanningLimits, obstacle_speed: float, period: float, duration: float = 90.0
) -> Driven:
    """Drive the planner's speed profiles with ideal actuators and no controller, replanned every period.

    Parameters
    ----------
    planner, limits : planner and its limits
    obstacle_speed : speed of the obstacle [m/s]
    period, duration : period of replanning, and duration of the drive [s]
    """
    inside = SAMPLE * np.arange(1, round(period / SAMPLE) + 1)
    way, speed = 0.0, 0.0
    times, gaps, speeds, accelerations = [], [], [], []
    for step in range(round(duration / period)):
        now = step * period
        gap = GAP + obstacle_speed * now - way
        profile = planner(Situation(gap, speed, obstacle_speed), limits).profile
        moved, driven_speed, acceleration = profile.sampled(inside)
        times.append(now + inside)
        gaps.append(gap + obstacle_speed * inside - moved)
        speeds.append(driven_speed)
        accelerations.append(acceleration)
        way, speed = way + float(moved[-1]), float(driven_speed[-1])
    time = np.concatenate(times)
    return Driven(
        time,
        np.concatenate(gaps),
        np.concatenate(speeds),
        np.concatenate(accelerations),
        np.full(len(time), obstacle_speed),
    )
