"""The vehicle that executes commands: a kinematic bicycle behind actuators with lag and limits.

Between two changes of the command, acceleration and front-wheel angle have closed forms, so the
longitudinal motion is exact for any sub-step and the path is exact wherever the wheel angle is constant.
"""

from __future__ import annotations

import math
from bisect import bisect_right

import numpy as np

from controllers.interface import Body, Command, Drive
from cosim.errors import SimulationError
from cosim.step.frames import front_of, rear_axle_of, wrapped

SUBSTEP = 0.05
"""Longest sub-step [s]."""

CAR_DRIVE = Drive(
    drive_lag=0.3,
    steering_lag=0.1,
    max_acceleration=2.6,
    max_deceleration=8.0,
    max_steering=0.6,
    max_steering_rate=0.6,
)
"""Actuators of the car that egos drive; its controller is told of them in ``EgoState.drive``."""

_CAR = Body()


def body_of(length: float, width: float) -> Body:
    """Return the body of a vehicle of which only length and width are known.

    Wheelbase and rear overhang are those of the default car, scaled with the length. SUMO knows no
    wheelbase, so this is assumed. For a long truck or a bus with a long overhang, it is a rough guess.

    Parameters
    ----------
    length, width : dimensions of the vehicle [m]

    Raises
    ------
    SimulationError
        If one of them is not positive.

    >>> round(body_of(9.0, 2.5).wheelbase, 3)
    5.2
    """
    if not (length > 0.0 and width > 0.0):
        raise SimulationError(
            f"a vehicle's length and width must be positive, found {length} m and {width} m"
        )
    scale = length / _CAR.length
    return Body(length, width, _CAR.wheelbase * scale, _CAR.rear_overhang * scale)


class Plant:
    """A vehicle's state and how commands change it.

    The rear axle moves along the heading; the heading turns by speed · tan(steering) / wheelbase.
    Acceleration follows its command with lag ``drive_lag``, the front-wheel angle with lag
    ``steering_lag`` and at a rate of at most ``max_steering_rate``; both commands are clipped to the drive's
    limits. The speed never goes below zero: a braking vehicle stops, and then its acceleration is zero.

    Parameters
    ----------
    body, drive : dimensions and actuators
    x, y : centre of the rear axle [m]
    heading : initial heading [rad]
    speed : initial speed [m/s]
    """

    def __init__(self, body: Body, drive: Drive, x: float, y: float, heading: float, speed: float) -> None:
        self.body = body
        self.drive = drive
        self.x = x
        self.y = y
        self.heading = wrapped(heading)
        self.speed = max(0.0, speed)
        self.acceleration = 0.0
        self.steering = 0.0
        self._command: Command | None = None
        self._entries: tuple[list[float], list[float], list[float]] = ([], [], [])
        """Times, accelerations and angles of the last command, read and checked when it was given."""

    @property
    def front(self) -> tuple[float, float]:
        """Centre of the front bumper [m]."""
        return front_of(self.x, self.y, self.heading, self.body.front)

    def adopt(
        self, front_x: float, front_y: float, heading: float, speed: float, acceleration: float
    ) -> None:
        """Take over the state from another driver, with the wheels straight ahead.

        Parameters
        ----------
        front_x, front_y : centre of the front bumper [m]
        heading : heading of the vehicle [rad]
        speed : speed of the vehicle [m/s]
        acceleration : acceleration of the vehicle [m/s^2]
        """
        self.x, self.y = rear_axle_of(front_x, front_y, heading, self.body.front)
        self.heading = wrapped(heading)
        self.speed = max(0.0, speed)
        self.acceleration = acceleration if speed > 0.0 else max(0.0, acceleration)
        self.steering = 0.0

    def follow(self, command: Command, elapsed: float, duration: float) -> None:
        """Follow a command for ``duration``, which begins ``elapsed`` after the command was given.

        Parameters
        ----------
        command : piecewise constant over its ``times``, held before the first and after the last of them
        elapsed, duration : [s]

        Raises
        ------
        SimulationError
            If the command has no entries, unequal numbers of entries or a value that is not finite.
        """
        if command is not self._command or elapsed == 0.0:
            self._entries = _entries(command)
            self._command = command
        times, accelerations, angles = self._entries
        end = elapsed + duration
        now = elapsed
        while now < end - 1e-12:
            # 1e-9: a breakpoint counts as reached if rounding put it slightly after the step's beginning.
            entry = max(0, bisect_right(times, now + 1e-9) - 1)
            until = end if entry + 1 >= len(times) else min(end, times[entry + 1])
            self._hold(accelerations[entry], angles[entry], until - now)
            now = until

    def _hold(self, acceleration: float, steering: float, duration: float) -> None:
        drive = self.drive
        target = min(max(acceleration, -drive.max_deceleration), drive.max_acceleration)
        angle = min(max(steering, -drive.max_steering), drive.max_steering)
        count = max(1, math.ceil(duration / SUBSTEP - 1e-9))
        for _ in range(count):
            self._substep(target, angle, duration / count)

    def _substep(self, target: float, angle: float, duration: float) -> None:
        """Hold both targets for a short time; if the vehicle stops within it, stop exactly there."""
        slowest = self._slowest_time(target, duration)
        motion = _longitudinal(self.speed, self.acceleration, target, self.drive.drive_lag, slowest)
        speed, acceleration, _ = motion
        stops = speed < 0.0 or (speed == 0.0 and acceleration <= 0.0 and target <= 0.0)
        if not stops and slowest == duration:
            self._roll(target, angle, duration, motion)
            return
        moving = self._stopping_time(target, slowest) if stops else duration
        if moving > 0.0:
            self._roll(target, angle, moving)
        if stops:
            self.speed = 0.0
            self.acceleration = 0.0
        standing = duration - moving
        if standing <= 0.0:
            return
        if target > 0.0:  # an old braking command stopped it, the present one drives it off
            self._roll(target, angle, standing)
        else:
            self.steering = self._steering_after(angle, standing)

    def _roll(
        self, target: float, angle: float, duration: float, motion: tuple[float, float, float] | None = None
    ) -> None:
        """Advance by the closed forms, for a time in which the speed stays non-negative.

        ``motion`` is what `_longitudinal` returns for this time, if that is known already.
        """
        lag = self.drive.drive_lag
        middle_speed, _, _ = _longitudinal(self.speed, self.acceleration, target, lag, 0.5 * duration)
        if motion is None:
            motion = _longitudinal(self.speed, self.acceleration, target, lag, duration)
        speed, acceleration, distance = motion
        middle = self._steering_after(angle, 0.5 * duration)
        steering = self._steering_after(angle, duration)
        bend = [math.tan(value) / self.body.wheelbase for value in (self.steering, middle, steering)]
        # Mean curvature by Simpson's rule over time, weighted with speed: exact where it is constant.
        weight = self.speed + 4.0 * middle_speed + speed
        if weight > 0.0:
            mean = (self.speed * bend[0] + 4.0 * middle_speed * bend[1] + speed * bend[2]) / weight
        else:
            mean = bend[1]
        turn = mean * distance
        # The chord of an arc; the last term is what a linearly changing curvature adds to its direction.
        direction = self.heading + 0.5 * turn - (bend[2] - bend[0]) * distance / 12.0
        chord = distance * (math.sin(0.5 * turn) / (0.5 * turn) if abs(turn) > 1e-9 else 1.0)
        self.x += chord * math.cos(direction)
        self.y += chord * math.sin(direction)
        self.heading = wrapped(self.heading + turn)
        self.speed = max(0.0, speed)
        self.acceleration = acceleration
        self.steering = steering

    def _steering_after(self, angle: float, duration: float) -> float:
        """Return the front-wheel angle [rad] after holding its target: rate-limited first, then the lag."""
        rate, lag = self.drive.max_steering_rate, self.drive.steering_lag
        error = angle - self.steering
        fast = max(0.0, abs(error) / rate - lag)  # how long the lag alone would ask for more than the rate
        if duration <= fast:
            return self.steering + math.copysign(rate * duration, error)
        rest = math.copysign(abs(error) - rate * fast, error)
        return angle - rest * (math.exp(-(duration - fast) / lag) if lag > 0.0 else 0.0)

    def _slowest_time(self, target: float, duration: float) -> float:
        """Return the time within ``duration``, after its beginning, at which the speed is lowest [s]."""
        lag = self.drive.drive_lag
        if self.acceleration < 0.0 < target and lag > 0.0:
            return min(duration, lag * math.log1p(-self.acceleration / target))
        return duration

    def _stopping_time(self, target: float, duration: float) -> float:
        """Return the time within ``duration`` at which the speed reaches zero [s]."""
        if self.speed <= 0.0 and self.acceleration <= 0.0:
            return 0.0
        # The speed at the end is negative, at the beginning it is not: bisection cannot fail.
        low, high = 0.0, duration
        while high - low > 1e-13:
            middle = 0.5 * (low + high)
            speed, _, _ = _longitudinal(self.speed, self.acceleration, target, self.drive.drive_lag, middle)
            low, high = (middle, high) if speed > 0.0 else (low, middle)
        return low


def _longitudinal(
    speed: float, acceleration: float, target: float, lag: float, duration: float
) -> tuple[float, float, float]:
    """Return speed [m/s], acceleration [m/s^2] and distance [m] after holding a target acceleration.

    The acceleration is target + (a0 − target) · exp(−t / lag); speed and distance are its integrals.
    """
    if lag <= 0.0:
        return (
            speed + target * duration,
            target,
            speed * duration + 0.5 * target * duration * duration,
        )
    excess = acceleration - target
    decayed = -math.expm1(-duration / lag)
    return (
        speed + target * duration + excess * lag * decayed,
        target + excess * (1.0 - decayed),
        speed * duration + 0.5 * target * duration**2 + excess * lag * (duration - lag * decayed),
    )


def _entries(command: Command) -> tuple[list[float], list[float], list[float]]:
    """Return the times, accelerations and angles of a command; raise `SimulationError` if it is invalid."""
    count = len(command.times)
    if count == 0 or len(command.acceleration) != count or len(command.steering) != count:
        raise SimulationError(
            f"a command needs as many accelerations and steering angles as times, at least one; found "
            f"{len(command.acceleration)}, {len(command.steering)} and {count}"
        )
    times, accelerations, angles = (
        np.asarray(column).tolist() for column in (command.times, command.acceleration, command.steering)
    )
    if not all(map(math.isfinite, [*accelerations, *angles])):
        raise SimulationError("a command's accelerations and steering angles must be finite numbers")
    return times, accelerations, angles
