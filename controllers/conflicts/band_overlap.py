"""When pedestrians are in a band of the road, at constant speed or according to a forecast."""

from __future__ import annotations

import numpy as np

from controllers.arrays import FloatArray, IntArray
from controllers.prediction.forecast import Forecast


def straight_overlap(
    across: FloatArray, speed: FloatArray, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return when points that move at constant speed enter and leave [low, high]; inf for never [s]."""
    moving = np.abs(speed) > 1e-6
    safe = np.where(moving, speed, 1.0)
    first = (np.where(safe > 0.0, low, high) - across) / safe
    last = (np.where(safe > 0.0, high, low) - across) / safe
    inside = (across >= low) & (across <= high)
    past = last < 0.0
    stands = np.where(inside, 0.0, np.inf)
    enter = np.where(moving, np.where(past, np.inf, np.maximum(first, 0.0)), stands)
    leave = np.where(moving & ~past, last, np.inf)
    return enter, leave


def sampled_overlap(forecast: Forecast, low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return when forecasts first enter [low, high] and when they leave it for good; inf for never [s]."""
    times = forecast.times
    outside = np.maximum(low[:, None] - forecast.across, forecast.across - high[:, None]) - forecast.reach
    inside = outside <= 0.0
    each = np.arange(len(inside))
    first = np.argmax(inside, axis=1)
    after_last = inside.shape[1] - np.argmax(inside[:, ::-1], axis=1)

    def border(index: IntArray) -> FloatArray:
        """Return when the border is crossed in the interval that ends at the sample ``index``."""
        ends = np.clip(index, 1, len(times) - 1)
        before, after = outside[each, ends - 1], outside[each, ends]
        change = np.where(before == after, 1.0, before - after)
        share = np.clip(before / change, 0.0, 1.0)
        return np.asarray(times[ends - 1] + share * (times[ends] - times[ends - 1]))

    somewhere = inside.any(axis=1)
    enter = np.where(first == 0, times[0], border(first))
    leave = np.where(after_last == len(times), np.inf, border(after_last))
    return np.where(somewhere, enter, np.inf), np.where(somewhere, leave, np.inf)


def speed_across(forecast: Forecast, times: FloatArray) -> FloatArray:
    """Return the speed across of each pedestrian at one time each; after the forecast, its last one [m/s]."""
    known = np.searchsorted(forecast.times, times, side="right")
    interval = np.clip(known, 1, len(forecast.times) - 1)
    each = np.arange(len(times))
    moved = forecast.across[each, interval] - forecast.across[each, interval - 1]
    return np.asarray(moved / (forecast.times[interval] - forecast.times[interval - 1]))
