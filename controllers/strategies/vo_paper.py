"""The velocity-obstacle paper's own formulation: least change of inputs, by sequential quadratic programs.

Along: while pedestrians are in conflict, the plan that changes the speed least and keeps out of everybody's
collision cone, made every ``replan_s`` and followed in between; otherwise what leaders, signals, right of
way, bends and limits allow, which the plan never exceeds either. Across: lane keeping; lane changes that
route and traffic require and, where the decision rules leave the choice, those that are the cheaper way to
avoid pedestrians. ``vo_ga`` solves the same problem by the paper's solver; ``vo_mpc`` is the formulation that
holds in closed loop.
"""

from __future__ import annotations

from controllers.interface import Controller
from controllers.optimisation.settings import SolverSettings
from controllers.prediction import by_name
from controllers.settings import AtLeastOne, Positive
from controllers.velocity_obstacle.paper.driver import AvoidanceDriver
from controllers.velocity_obstacle.paper.passing_classes import QuadraticOptimiser
from controllers.velocity_obstacle.paper.settings import PaperSettings


class Settings(PaperSettings):
    """The parameters of the controller."""

    euler_passes: AtLeastOne = 5
    """Largest number of quadratic programs per passing class."""
    max_classes: AtLeastOne = 3
    """Largest number of passing classes solved per plan."""
    solver: str = "osqp"
    """A solver that qpsolvers knows and that is installed; run.json says which one ran."""
    tolerance: Positive = 2e-4
    """Tolerance of OSQP; other solvers keep their own."""


def build(settings: Settings) -> Controller:
    """Build the controller.

    Raises
    ------
    ValueError
        If there is no such solver.
    """
    solver = SolverSettings(settings.solver, settings.tolerance)
    return AvoidanceDriver(
        settings.driver(),
        QuadraticOptimiser(settings.euler_passes, settings.max_classes, solver),
        by_name.sampled(settings.predictor, seed=settings.seed),
        settings.brake(),
    )
