"""The velocity-obstacle paper with its own solver: least change of inputs, by a genetic algorithm.

Along: while pedestrians are in conflict, the plan that changes the speed least and keeps out of everybody's
collision cone, made by a genetic algorithm every ``replan_s`` and followed in between; else, and never
exceeded, what leaders, signals, right of way, bends and limits allow. Across: lane keeping; where the
decision rules leave the choice, a change of lane that is the cheaper way to avoid somebody, and those that
route and traffic ask for. The sequential quadratic programs for the same problem are ``vo_paper``.
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
    """What can be set."""

    generations: AtLeastOne = 50
    """Of one solve: so many generations of so many plans are valued."""
    population: Annotated[int, Field(ge=4)] = 50
    """Plans of a generation."""


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
