"""Responsibility-sensitive safety: keeps distances that are safe whatever a pedestrian may reasonably do.

A filter of a driver blind to pedestrians. Along: where neither the distance along nor the one across is
safe, it brakes with the least braking of the rules, and it never speeds up into such a state. Across: lane
keeping, and lane changes for the route.
"""

from __future__ import annotations

from controllers.driving.driving_style import DrivingStyle
from controllers.interface import Controller
from controllers.settings import ControllerSettings, NotNegative, Positive
from controllers.yielding.facing import PathWatch
from controllers.yielding.filtered_driver import BlindDriver, FilteredDriver
from controllers.yielding.responsibility import ResponsibilityFilter, ResponsibilityRule


class Settings(ControllerSettings):
    """What can be set.

    Notes
    -----
    The ego's values are the example values of Intel's library [AdRss]_, except for the response time, which
    there is 1 s for the ego of a driver: a controller that plans every 0.1 s behind a lag of 0.3 s needs
    less. The library moves pedestrians on arcs; walking to the side has its values for vehicles here, and
    the response time of pedestrians is that with which CARLA calls it.
    """

    response_time_s: Positive = 0.5
    """ρ, until the ego brakes; it may speed up meanwhile."""
    acceleration_mps2: NotNegative = 1.8
    """a_max, the most within that time; the library's example is 3.5, this is what the driver does."""
    braking_mps2: Positive = 4.0
    """b_min, with which the ego brakes at least in a dangerous situation."""
    pedestrian_response_s: NotNegative = 0.5
    """ρ of pedestrians."""
    pedestrian_acceleration_mps2: NotNegative = 0.2
    """How much faster they may come within that time, across the road."""
    pedestrian_braking_mps2: Positive = 0.8
    """With which they stop at least, across the road."""
    side_margin_m: NotNegative = 0.1
    """μ, movements to the side that mean nothing."""
    standoff_m: NotNegative = 1.0
    """Distance to a pedestrian away from a crossing that is left after a stop."""
    headway_s: NotNegative = 1.0
    """Time gap to a leader."""


def build(settings: Settings) -> Controller:
    """Build the controller."""
    rule = ResponsibilityRule(
        settings.response_time_s,
        settings.acceleration_mps2,
        settings.braking_mps2,
        settings.pedestrian_response_s,
        settings.pedestrian_acceleration_mps2,
        settings.pedestrian_braking_mps2,
        settings.side_margin_m,
    )
    driver = BlindDriver(DrivingStyle(headway=settings.headway_s))
    watch = PathWatch(settings.side_margin_m, settings.standoff_m)
    return FilteredDriver(driver, ResponsibilityFilter(rule), watch)
