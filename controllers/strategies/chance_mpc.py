"""Model predictive control with chance constraints: a bound on the probability of a contact within a plan.

Along: a quadratic program over 5 s for each way to pass pedestrians ahead or behind; their places are normal
variables whose deviation grows with time, and the margin follows from the accepted risk. Across: lane
keeping, and lane changes for the route. Vehicles and road are those of a car-following driver.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from controllers.driving.driving_style import DrivingStyle
from controllers.interface import Controller
from controllers.optimisation.settings import SolverSettings
from controllers.settings import ControllerSettings, NotNegative, Positive
from controllers.yielding.chance import WalkingUncertainty
from controllers.yielding.chance_filter import ChanceFilter
from controllers.yielding.chance_program import ChanceProgram, ChanceWeights
from controllers.yielding.facing import PathWatch
from controllers.yielding.filtered_driver import BlindDriver, FilteredDriver

STEP, STEPS = 0.2, 25
WEIGHTS = ChanceWeights()


class Settings(ControllerSettings):
    """What can be set.

    Notes
    -----
    The form of the constraint is that of [Blackmore2011]_. That the risk of a plan is spread evenly over its
    times, and the deviation of the place, are from the code of [Lew2023]_ for a car and a pedestrian, which
    tries risks of 0.01 to 0.1. The scatter of the pace is about that of walking speeds in
    [Knoblauch1996]_. The margins and weights are our choices.
    """

    risk: Annotated[float, Field(gt=0.0, lt=0.5)] = 0.05
    """Δ, accepted probability of a contact with each pedestrian within a plan of 5 s."""
    pace_deviation_mps: NotNegative = 0.3
    """Standard deviation of pedestrians' velocity along either axis."""
    place_deviation_m: NotNegative = 0.1
    """Standard deviation of their place now, beside what the sensors tell."""
    side_margin_m: NotNegative = 0.3
    """What a pedestrian's disc is grown by across the way."""
    standoff_m: NotNegative = 1.0
    """Distance to a pedestrian away from a crossing that is left after a stop."""
    hardest_braking_mps2: Positive = 8.0
    """The most that a plan may brake."""
    speed_weight: Positive = WEIGHTS.speed
    """Of the deviation from the driver's speed."""
    acceleration_weight: Positive = WEIGHTS.acceleration
    """Of the acceleration."""
    change_weight: NotNegative = WEIGHTS.change
    """Of its change."""
    solver: str = "daqp"
    """Of the programs, by its name in qpsolvers."""
    headway_s: NotNegative = 1.0
    """Time gap to a leader."""


def build(settings: Settings) -> Controller:
    """Build the controller.

    Raises
    ------
    ValueError
        If the solver is not installed or not known.
    """
    solver = SolverSettings(settings.solver)
    weights = ChanceWeights(settings.speed_weight, settings.acceleration_weight, settings.change_weight)
    program = ChanceProgram(STEP, STEPS, weights, settings.hardest_braking_mps2, solver)
    unsure = WalkingUncertainty(settings.pace_deviation_mps, settings.place_deviation_m)
    driver = BlindDriver(DrivingStyle(headway=settings.headway_s))
    watch = PathWatch(settings.side_margin_m, settings.standoff_m)
    each = settings.risk / STEPS
    chance = ChanceFilter(program, unsure, each, settings.side_margin_m, solver)
    return FilteredDriver(driver, chance, watch)
