"""The same plans by other means: CasADi with IPOPT on the non-linear problem, and pymoo's genetic algorithm.

All plan speed and steering for the passing class that was followed, one step after the other, in turns in one
process.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import gc
import importlib.util
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from measuring import results, tasks
from measuring.bars import Bar, show
from measuring.command import options
from measuring.perceptions import Case
from measuring.solvers import DEFAULT, SOLVERS
from measuring.tasks import Planner, Step

from controllers.velocity_obstacle.mpc.lateral import SteeringPlan
from controllers.velocity_obstacle.mpc.longitudinal import SpeedPlan

CASE = Case(30, 5)
CASADI, PYMOO = "CasADi/IPOPT", "pymoo GA"
PACKAGES = {CASADI: "casadi", PYMOO: "pymoo"}
LEAST = {CASADI: {"daqp": 10.0, "osqp": 10.0}, PYMOO: {"daqp": 100.0, "osqp": 100.0}}
SPEED_TOLERANCE, STEERING_TOLERANCE = 0.01, 1e-4
"""Largest difference of a planned speed [m/s] and of a steering angle [rad] from IPOPT's optimum."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How much is measured."""

    repetitions: int = 5
    steps: int = 32
    genetic_every: int = 16
    """Of these steps, every so many is planned by the genetic algorithm too."""


QUICK = Effort(1, 8, 4)


def installed() -> list[str]:
    """Return the other methods that are there; say which are not."""
    there = []
    for method, package in PACKAGES.items():
        if importlib.util.find_spec(package):
            there.append(method)
        else:
            print(f"skipped: {method}, as {package} is not installed (extra `bench`)")
    return there


class Contest:
    """Everybody plans the same steps."""

    def __init__(self, methods: list[str], effort: Effort) -> None:
        self.effort = effort
        self.layout, every = tasks.collect(CASE)
        self.runs = list(tasks.in_turn(every, effort.steps))
        self.ours = {solver: Planner.like(self.layout, solver) for solver in SOLVERS}
        self.exact = Planner.like(self.layout, DEFAULT)
        self.non_linear: Any = None
        self.genetic: Any = None
        if CASADI in methods:
            from measuring.non_linear import NonLinearProgram

            self.non_linear = NonLinearProgram(self.layout)
        if PYMOO in methods:
            from measuring.genetic import GeneticPlanner

            self.genetic = GeneticPlanner(Planner.like(self.layout, "osqp"))
        self.unsolved = 0
        self.iterations: list[int] = []

    def repetition(self) -> dict[str, list[float]]:
        """Return what each step took [s]; the steps are the same for all, but fewer for the slowest.

        They take turns run by run: step by step each would find the caches full of the others' data.
        """
        turn: dict[str, Callable[[Step], Any]] = {name: one.plan for name, one in self.ours.items()}
        if self.non_linear:
            turn[CASADI] = self._ipopt
        if self.genetic:
            turn[PYMOO] = self.genetic.plan
        times: dict[str, list[float]] = {name: [] for name in turn}
        for number, run in enumerate(self.runs):
            if self.non_linear:
                self.non_linear.forget()
            for name in turn if number % 2 else reversed(turn):
                gc.collect(0)
                if name != PYMOO:
                    # The first step of a run has nothing to begin with; the genetic algorithm never has.
                    turn[name](run[0])
                every = self.effort.genetic_every if name == PYMOO else 1
                for step in run[1::every]:
                    began = perf_counter()
                    turn[name](step)
                    times[name].append(perf_counter() - began)
        return times

    def _ipopt(self, step: Step) -> None:
        answer = self.non_linear.solve(step)
        self.iterations.append(answer.iterations)
        self.unsolved += not answer.found

    def agreement(self) -> dict[str, float]:
        """Return how far our plans, the braking distance settled, are from IPOPT's optima at most."""
        found = {"speed_mps": 0.0, "steering_rad": 0.0, "cost_relative": 0.0, "compared": 0.0}
        for run in self.runs:
            self.non_linear.forget()
            for step in run:
                ours, steering = self.exact.plan(step, firm=True)
                best = self.non_linear.solve(step)
                if not best.found:
                    continue
                cost = self._cost(step, ours, steering)
                found["compared"] += 1
                found["speed_mps"] = max(found["speed_mps"], float(abs(ours.speed - best.speed).max()))
                found["steering_rad"] = max(
                    found["steering_rad"], float(abs(steering.command - best.steering).max())
                )
                found["cost_relative"] = max(
                    found["cost_relative"], abs(cost - best.cost) / max(1.0, abs(best.cost))
                )
        return found

    def genetic_excess(self) -> float:
        """Return by how much the genetic algorithm's cost exceeds ours, median, relative."""
        excess = []
        for run in self.runs:
            plan, steering = self.exact.plan(run[-1])
            least = self.genetic.cost_of(run[-1], plan.inputs, steering.inputs)
            found, _ = self.genetic.plan(run[-1])
            excess.append((found - least) / self._cost(run[-1], plan, steering))
        return float(np.median(excess))

    def _cost(self, step: Step, speed: SpeedPlan, steering: SteeringPlan) -> float:
        """Return the objective of a plan, constants included."""
        task = Planner.along(step, speed)
        return speed.cost - speed.priced + steering.cost + self.exact.steering.build(task).cost


def ratios(repeats: list[dict[str, list[float]]], method: str, solver: str) -> dict[str, float]:
    """Return the other's time over ours: medians, of the median repetition, least and most."""
    values = [float(np.median(one[method]) / np.median(one[solver])) for one in repeats]
    return {"median": float(np.median(values)), "least": min(values), "most": max(values)}


def main() -> None:
    """Measure, print and publish."""
    given = options(__doc__)
    effort = QUICK if given.quick else Effort()
    methods = installed()
    if not methods:
        return
    warnings.simplefilter("ignore")
    gc.disable()
    contest = Contest(methods, effort)
    repeats = [contest.repetition() for _ in range(effort.repetitions)]
    names = (*contest.ours, *methods)
    times = {name: 1e3 * float(np.median([np.median(one[name]) for one in repeats])) for name in names}
    found: dict[str, Any] = {
        "case": str(CASE),
        "steps": len(repeats[0]["osqp"]),
        "repetitions": effort.repetitions,
        "median_ms": times,
        "ratio": {m: {solver: ratios(repeats, m, solver) for solver in contest.ours} for m in methods},
    }
    bars = []
    if CASADI in methods:
        agreed = found["agreement"] = contest.agreement()
        found["ipopt_unsolved"], found["ipopt_iterations"] = (
            contest.unsolved,
            float(np.median(contest.iterations)),
        )
        bars.append(
            Bar(
                what="planned speed against IPOPT's optimum, largest difference",
                measured=agreed["speed_mps"],
                at_most=SPEED_TOLERANCE,
                unit="m/s",
                note=f"{agreed['compared']:.0f} plans",
            )
        )
        bars.append(
            Bar(
                what="planned steering against IPOPT's optimum, largest difference",
                measured=agreed["steering_rad"],
                at_most=STEERING_TOLERANCE,
                unit="rad",
            )
        )
    if PYMOO in methods:
        found["genetic_excess"] = contest.genetic_excess()
    for method in methods:
        for solver, ratio in found["ratio"][method].items():
            bars.append(
                Bar(
                    what=f"plan of one class against {method}, {solver}",
                    measured=ratio["median"],
                    at_least=LEAST[method][solver],
                    note=f"{ratio['least']:.0f} to {ratio['most']:.0f}",
                )
            )
    print("  ".join(f"{name} {value:.2f} ms" for name, value in times.items()))
    show(bars)
    results.publish("other_methods", found, bars, given.folder)


if __name__ == "__main__":
    main()
