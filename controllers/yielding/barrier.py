"""A control barrier function along the road, kept by a quadratic program close to what the driver wants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from controllers.arrays import FloatArray
from controllers.interface import Solves
from controllers.optimisation.problem import Problem, blank
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solve import Memory, solve
from controllers.yielding.facing import Answer, Facing

SLOTS = 8
"""Number of pedestrians, the nearest ones, that have a row in the program [-]."""
UNSOLVED = "fallback_full_braking"


@dataclass(frozen=True, slots=True)
class BarrierRule:
    """The barrier.

    Parameters
    ----------
    braking : c_d g, deceleration with which the ego can always stop [m/s^2]
    rate : γ, how fast the state may approach the barrier [1/s]
    time_margin : time gap between the ego and pedestrians who come later or have left before [s]
    slack_weight : cost of violating the barrier, relative to that of changing the acceleration
    """

    braking: float
    rate: float
    time_margin: float
    slack_weight: float

    def value(self, gap: FloatArray, speed: float) -> FloatArray:
        """Return h = D − v² / (2 c_d g), shape (n,) [m]."""
        return np.asarray(gap - speed**2 / (2.0 * self.braking))


class BarrierFilter:
    """Solves the program for one ego.

    Parameters
    ----------
    rule : the barrier
    solver : settings of the solver

    Notes
    -----
    The program of [Ames2017]_ finds the acceleration nearest to the wanted one with ḣ ≥ −γ h for every
    pedestrian whom the ego would meet, softened where braking is not enough. With ḣ = −v − v a / (c_d g), a
    row is v / (c_d g) · a − δ ≤ γ h − v. The paper's barrier keeps a distance to a leader; its use for
    pedestrians who will be in the way when the ego comes is our own.
    """

    def __init__(self, rule: BarrierRule, solver: SolverSettings) -> None:
        self._rule, self._solver, self._memory = rule, solver, Memory()

    def problem(self, facing: Facing, concerned: FloatArray) -> Problem:
        """Return the program for pedestrians with the gaps ``concerned`` [m], not solved yet."""
        ego, rule = facing.perception.ego, self._rule
        problem = blank(
            "(a - wanted)^2 + weight slack^2",
            {"acceleration [m/s^2]": 1, "slack [m/s]": 1},
            {"the barrier is approached no faster than allowed, softened": SLOTS},
        )
        problem.P[0, 0], problem.P[1, 1] = 2.0, 2.0 * rule.slack_weight
        problem.q[0] = -2.0 * facing.wanted
        count = min(len(concerned), SLOTS)
        gaps = np.sort(concerned)[:count]
        problem.G[:count, 0] = ego.speed / rule.braking
        problem.G[:count, 1] = -1.0
        problem.h[:count] = rule.rate * rule.value(gaps, ego.speed) - ego.speed
        problem.lower[:] = -ego.drive.max_deceleration, 0.0
        problem.upper[0] = max(ego.drive.max_acceleration, facing.wanted)
        return problem

    def allowed(self, facing: Facing) -> Answer:
        """Return the solution of the program; full braking if there is none."""
        met = np.flatnonzero(facing.meets(self._rule.time_margin))
        if not len(met):
            return Answer()
        gaps = facing.gaps[met]
        name = facing.people.names[int(met[np.argmin(gaps)])]
        solution = solve(self.problem(facing, gaps), self._solver, self._memory)
        solves = Solves(self._solver.name, *self._memory.tally.take())
        ego = facing.perception.ego
        if not solution.solved:
            full = -ego.drive.max_deceleration
            return Answer(full, True, name, False, UNSOLVED, overridden=True, solves=solves)
        most = float(solution.z[0])
        if ego.speed < 0.5 and float(gaps.min()) < 0.5:
            most = min(most, 0.0)  # at rest, the barrier does not prevent starting
        return Answer(most, True, name, slack=max(float(solution.z[1]), 0.0), solves=solves)
