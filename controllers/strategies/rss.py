"""Responsibility-sensitive safety: keeps distances that are safe whatever a pedestrian may reasonably do.

A filter of a driver blind to pedestrians. Along: where neither the distance along the road nor the one across
it is safe, the ego brakes with the least braking that the rules demand, and it never speeds up into such a
state. Across: lane keeping, and lane changes for the route.
"""

from __future__ import annotations

from controllers.driving.driving_style import DrivingStyle
from controllers.interface import Controller
from controllers.settings import ControllerSettings, NotNegative, Positive
from controllers.yielding.facing import PathWatch
from controllers.yielding.filtered_driver import BlindDriver, FilteredDriver
from controllers.yielding.responsibility import ResponsibilityFilter, ResponsibilityRule


class Settings(ControllerSettings):
    """The parameters of the controller.

    Notes
    -----
    The ego's values are the example values of Intel's library [AdRss]_, except for the acceleration and the
    response time. The latter is 1 s there, for an ego with a driver: a controller that plans every 0.1 s
    behind a lag of 0.3 s needs less. The library moves pedestrians on arcs; here, walking to the side has the
    library's values for vehicles. The response time of pedestrians is the one with which CARLA calls the
    library.
    """

    response_time_s: Positive = 0.5
    """ρ, time until the ego brakes; it may speed up meanwhile."""
    acceleration_mps2: NotNegative = 1.8
    """a_max, largest acceleration within that time; the library's example is 3.5, this is the driver's."""
    braking_mps2: Positive = 4.0
    """b_min, least braking of the ego in a dangerous situation."""
    pedestrian_response_s: NotNegative = 0.5
    """Response time ρ of pedestrians."""
    pedestrian_acceleration_mps2: NotNegative = 0.2
    """Largest acceleration of pedestrians across the road within that time."""
    pedestrian_braking_mps2: Positive = 0.8
    """Least deceleration of pedestrians across the road after that time."""
    side_margin_m: NotNegative = 0.1
    """μ, sideways movements up to this size mean nothing."""
    standoff_m: NotNegative = 1.0
    """Distance left to a pedestrian after a stop away from a crossing."""
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
