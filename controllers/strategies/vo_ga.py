"""The velocity-obstacle paper with its own solver: least change of inputs, by a genetic algorithm.

Along: while pedestrians are in conflict, the plan that changes the speed least and keeps out of everybody's
collision cone, made by a genetic algorithm every ``replan_s`` and followed in between; otherwise what
leaders, signals, right of way, bends and limits allow, which the plan never exceeds either. Across: lane
keeping; lane changes that route and traffic require and, where the decision rules leave the choice, those
that are the cheaper way to avoid pedestrians. ``vo_paper`` solves the same problem by sequential quadratic
programs.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from controllers.interface import Controller
from controllers.optimisation.packages import require_pymoo
from controllers.prediction import by_name
from controllers.settings import AtLeastOne
from controllers.velocity_obstacle.paper.driver import AvoidanceDriver
from controllers.velocity_obstacle.paper.genetic_algorithm import GeneticBudget, GeneticOptimiser
from controllers.velocity_obstacle.paper.settings import PaperSettings


class Settings(PaperSettings):
    """The parameters of the controller."""

    generations: AtLeastOne = 50
    """Number of generations in one solve."""
    population: Annotated[int, Field(ge=4)] = 50
    """Number of plans in a generation."""


def build(settings: Settings) -> Controller:
    """Build the controller.

    Raises
    ------
    ValueError
        If pymoo is not installed.
    """
    require_pymoo()
    return AvoidanceDriver(
        settings.driver(),
        GeneticOptimiser(GeneticBudget(settings.generations, settings.population), settings.seed),
        by_name.sampled(settings.predictor, seed=settings.seed),
        settings.brake(),
    )
