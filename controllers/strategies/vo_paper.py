"""The velocity-obstacle paper's own formulation: least change of inputs, by sequential quadratic programs.

Along: while pedestrians are in conflict, the plan that changes the speed least and keeps out of everybody's
collision cone, made every ``replan_s`` and followed in between; else, and never exceeded, what leaders,
signals, right of way, bends and limits allow. Across: lane keeping; where the decision rules leave the
choice, a change of lane that is the cheaper way to avoid somebody, and those that route and traffic ask
for. The same problem by the paper's solver is ``vo_ga``; what holds in closed loop is ``vo_mpc``.
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
    """What can be set."""

    euler_passes: AtLeastOne = 5
    """Quadratic programs per passing class at most."""
    max_classes: AtLeastOne = 3
    """Passing classes solved per plan."""
    solver: str = "osqp"
    """A solver that qpsolvers knows and that is installed; run.json says which one ran."""
    tolerance: Positive = 2e-4
    """Of OSQP; other solvers keep their own."""


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
