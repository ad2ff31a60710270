"""A control barrier function: the acceleration nearest to a driver's from which the ego can always stop.

A filter of a driver blind to pedestrians. Along: a quadratic program keeps the braking distance below the
distance to everybody who would be met. Across: lane keeping, and lane changes for the route.
"""

from __future__ import annotations

from controllers.driving.driving_style import DrivingStyle
from controllers.interface import Controller
from controllers.optimisation.settings import SolverSettings
from controllers.safety.emergency_braking import GRAVITY
from controllers.settings import ControllerSettings, NotNegative, Positive
from controllers.yielding.barrier import BarrierFilter, BarrierRule
from controllers.yielding.facing import PathWatch
from controllers.yielding.filtered_driver import BlindDriver, FilteredDriver


class Settings(ControllerSettings):
    """What can be set.

    Notes
    -----
    ``braking_g`` is that of the cruise control of [Ames2014]_, as public code quotes its Table 1; the
    others are our assumptions. ``rate_per_s`` is a choice: public code takes 1 or 5.
    """

    braking_g: Positive = 0.3
    """c_d, the braking with which the ego can always stop."""
    rate_per_s: Positive = 1.0
    """γ, how fast the ego may come to the barrier; larger means later."""
    time_margin_s: NotNegative = 1.0
    """Pedestrians who come, or have left, this much after or before the ego passes are met as well."""
    side_margin_m: NotNegative = 0.6
    """What a pedestrian's disc is grown by across the way."""
    standoff_m: NotNegative = 1.0
    """Distance to a pedestrian away from a crossing that is left after a stop."""
    slack_weight: Positive = 100.0
    """Price of a barrier that is not kept, where braking is not enough."""
    solver: str = "daqp"
    """Of the program, by its name in qpsolvers."""
    headway_s: NotNegative = 1.0
    """Time gap to a leader."""


def build(settings: Settings) -> Controller:
    """Build the controller.

    Raises
    ------
    ValueError
        If the solver is not installed or not known.
    """
    rule = BarrierRule(
        settings.braking_g * GRAVITY, settings.rate_per_s, settings.time_margin_s, settings.slack_weight
    )
    driver = BlindDriver(DrivingStyle(headway=settings.headway_s))
    watch = PathWatch(settings.side_margin_m, settings.standoff_m)
    return FilteredDriver(driver, BarrierFilter(rule, SolverSettings(settings.solver)), watch)
