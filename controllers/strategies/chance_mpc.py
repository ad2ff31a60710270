"""Model predictive control with chance constraints: a bound on the probability of a contact within a plan.

Along: a quadratic program over 5 s for each way to pass ahead of or behind pedestrians. Their positions are
normally distributed with a deviation that grows with time, and the margin follows from the accepted risk.
Across: lane keeping, and lane changes for the route. A car-following driver handles vehicles and road.
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
    """The parameters of the controller.

    Notes
    -----
    The form of the constraint is that of [Blackmore2011]_. Spreading the risk of a plan evenly over its
    times, and the deviation of the position, are taken from the code of [Lew2023]_ for a car and a
    pedestrian, which tries risks of 0.01 to 0.1. The scatter of the pace is about that of walking speeds in
    [Knoblauch1996]_. The margins and weights are our choices.
    """

    risk: Annotated[float, Field(gt=0.0, lt=0.5)] = 0.05
    """Δ, accepted probability of a contact with each pedestrian within a plan of 5 s."""
    pace_deviation_mps: NotNegative = 0.3
    """Standard deviation of pedestrians' velocity along either axis."""
    place_deviation_m: NotNegative = 0.1
    """Standard deviation of their present position, in addition to what the sensors report."""
    side_margin_m: NotNegative = 0.3
    """Distance by which a pedestrian's disc is enlarged across the ego's way."""
    standoff_m: NotNegative = 1.0
    """Distance left to a pedestrian after a stop away from a crossing."""
    hardest_braking_mps2: Positive = 8.0
    """Hardest braking that a plan may use."""
    speed_weight: Positive = WEIGHTS.speed
    """Weight of the deviation from the driver's speed."""
    acceleration_weight: Positive = WEIGHTS.acceleration
    """Weight of the acceleration."""
    change_weight: NotNegative = WEIGHTS.change
    """Weight of the change of acceleration."""
    solver: str = "daqp"
    """Solver of the programs, by its name in qpsolvers."""
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
