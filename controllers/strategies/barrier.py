"""A control barrier function: the acceleration nearest to a driver's from which the ego can always stop.

A filter of a driver blind to pedestrians. Along: a quadratic program keeps the braking distance below the
distance to everybody whom the ego would meet. Across: lane keeping, and lane changes for the route.
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
    """The parameters of the controller.

    Notes
    -----
    ``braking_g`` is the value for the cruise control of [Ames2014]_, as public code quotes its Table 1; the
    other values are our assumptions. ``rate_per_s`` is a choice: public code uses 1 or 5.
    """

    braking_g: Positive = 0.3
    """c_d, braking that is always enough for the ego to stop."""
    rate_per_s: Positive = 1.0
    """γ, rate at which the ego may approach the barrier; with a larger one it brakes later."""
    time_margin_s: NotNegative = 1.0
    """Pedestrians count if they come less than this after the ego passes, or leave less than this before."""
    side_margin_m: NotNegative = 0.6
    """Distance by which a pedestrian's disc is enlarged across the ego's way."""
    standoff_m: NotNegative = 1.0
    """Distance left to a pedestrian after a stop away from a crossing."""
    slack_weight: Positive = 100.0
    """Price of violating the barrier where braking is not enough."""
    solver: str = "daqp"
    """Solver of the program, by its name in qpsolvers."""
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
