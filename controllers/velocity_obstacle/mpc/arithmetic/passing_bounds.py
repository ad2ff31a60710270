"""Bounds of passing classes on the position, and how far out of reach a class is; see ``passing_classes``."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray


def straight_on(
    along: FloatArray, speed: FloatArray, reach: FloatArray, times: FloatArray, until: float
) -> tuple[FloatArray, FloatArray]:
    """Return where people are who keep their speed until a time, and how far to keep away, shape (n, N)."""
    kept = np.empty((len(along), len(times)))
    kept[:] = reach.reshape(-1, 1)
    return along.reshape(-1, 1) + speed.reshape(-1, 1) * np.minimum(times, until), kept


def class_bounds(
    enter: FloatArray,
    leave: FloatArray,
    stop_line: FloatArray,
    x: FloatArray,
    reach: FloatArray,
    times: FloatArray,
    speed: FloatArray,
    front: float,
    rear: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the bounds of all passing classes: upper, lower and freeze, shape (n + 1, N) each.

    Parameters
    ----------
    enter, leave, stop_line
        As in ``Conflicts``, shape (n,).
    x, reach
        Position of each pedestrian along the road, and how far to keep away from it, shape (n, N) [m].
    times, speed
        Horizon and expected speed, shape (N,).
    front, rear
        Distances from the rear axle to the front bumper and to the rear bumper (positive) [m].
    """
    n, count = len(enter), len(times)
    upper = np.full((n + 1, count), np.inf)
    lower = np.full((n + 1, count), -np.inf)
    freeze = np.full((n + 1, count), np.inf)
    previous = np.append(0.0, times[:-1])
    following = np.append(times[1:], np.inf)
    enters, leaves, line = enter.reshape(-1, 1), leave.reshape(-1, 1), stop_line.reshape(-1, 1)
    # Once the bumper is past the stop line, only the pedestrian counts.
    before = x - reach
    limit = np.where(front <= line + 0.3, np.minimum(before, np.maximum(line, front)), before)
    active = previous < leaves
    late = np.where(active, speed * np.maximum(times - leaves, 0.0), 0.0)
    upper[1:] = np.where(active, limit - front + late, np.inf)
    freeze[1:] = np.where(active & (following > enters), limit - 0.25 - front, np.inf)
    late = np.where(previous < enters, speed * np.maximum(times - enters, 0.0), 0.0)
    lower[:-1] = np.where((times >= enters) & active, x + reach + rear + late, -np.inf)
    for j in range(1, n + 1):
        upper[j] = np.minimum(upper[j], upper[j - 1])
        freeze[j] = np.minimum(freeze[j], freeze[j - 1])
        lower[n - j] = np.maximum(lower[n - j], lower[n - j + 1])
    return upper, lower, freeze


def straight_class_bounds(
    enter: FloatArray,
    leave: FloatArray,
    stop_line: FloatArray,
    along: FloatArray,
    along_speed: FloatArray,
    until: float,
    reach: FloatArray,
    times: FloatArray,
    speed: FloatArray,
    front: float,
    rear: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return :func:`class_bounds` for people who keep their speed along the road until a time."""
    x, kept = straight_on(along, along_speed, reach, times, until)
    return class_bounds(enter, leave, stop_line, x, kept, times, speed, front, rear)


def shortfalls(
    lower: FloatArray,
    upper: FloatArray,
    largest: FloatArray,
    times: FloatArray,
    speed: float,
    reference: FloatArray,
    acceleration: float,
    braking: float,
) -> FloatArray:
    """Return how far each class is out of reach, shape (n + 1,) [m].

    Parameters
    ----------
    lower, upper : bounds of the classes, shape (n + 1, N) [m]
    largest : largest position that everything else allows, shape (N,) [m]
    times : horizon, shape (N,) [s]
    speed : present speed [m/s]
    reference : wanted speeds, shape (N,) [m/s]
    acceleration, braking : comfortable values [m/s^2]
    """
    top = max(reference.max(), speed)
    t = np.minimum(times, (top - speed) / acceleration)
    farthest = np.minimum(speed * t + 0.5 * acceleration * t**2 + (times - t) * top, largest)
    t = np.minimum(times, speed / braking)
    nearest = speed * t - 0.5 * braking * t**2
    late, soon = (lower - farthest).max(axis=1), (nearest - upper).max(axis=1)
    return np.asarray(np.maximum(late, 0.0) + np.maximum(soon, 0.0))
