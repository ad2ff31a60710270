"""Whether the naive programs are the same optimisation problems: exact optima of both, side by side."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import qpsolvers
from naive import twin
from numpy.typing import NDArray

from controllers.interface import Drive
from controllers.optimisation.settings import SolverSettings
from controllers.velocity_obstacle.mpc.lateral import LateralProgram
from controllers.velocity_obstacle.mpc.longitudinal import LongitudinalProgram
from measuring import perceptions
from measuring.perceptions import Case
from measuring.solvers import DEFAULT

FloatArray = NDArray[np.float64]

OBJECTIVE_TOLERANCE = 1e-5
"""Largest difference of the two exact optima, relative to max(1, optimum)."""
COMMAND_TOLERANCE = 1e-4
"""Largest difference of the two first commands [m/s^2, rad]."""
EXACT = "daqp"
COMMAND = 3
"""Variable of the naive programs that is commanded at the end of the first interval."""
EVERY = 5
"""Every fifth control step is looked at."""


@dataclass(slots=True)
class Differences:
    """Collected over the programs of one kind, one entry each."""

    objective: list[float] = field(default_factory=list)
    """Relative difference of the exact optima."""
    first_command: list[float] = field(default_factory=list)
    """Difference of the exact first commands."""
    ours: list[float] = field(default_factory=list)
    """Error of OSQP's first command, the controller's own program."""
    naive: list[float] = field(default_factory=list)
    """The same, the naive program."""
    unsolved: int = 0
    """Naive programs that OSQP gave up."""

    def summary(self) -> dict[str, float]:
        """Return the largest differences of the exact optima and the 99th percentiles of OSQP's errors."""
        return {
            "programs": len(self.objective),
            "objective_difference": max(self.objective, default=0.0),
            "first_command_difference": max(self.first_command, default=0.0),
            "osqp_error_p99": float(np.percentile(self.ours, 99)) if self.ours else 0.0,
            "naive_osqp_error_p99": float(np.percentile(self.naive, 99)) if self.naive else 0.0,
            "naive_unsolved": self.unsolved,
        }


class Comparison:
    """Solves each program that a naive controller builds in four ways: in both forms, exactly and by OSQP."""

    def __init__(self, original: Any, drive: Drive) -> None:
        self.speed, self.steering = Differences(), Differences()
        speed, steering = original._speed.program, original._steering
        self._speed = _speed(speed, drive, EXACT), _speed(speed, drive, "osqp")
        self._steering = _steering(steering, drive, EXACT), _steering(steering, drive, "osqp")

    def watch(self, naive: Any) -> None:
        """Look at every program that this controller solves from now on."""
        naive._speed.program.solve = self._comparing(naive._speed.program, *self._speed, self.speed)
        naive._steering.solve = self._comparing(naive._steering, *self._steering, self.steering)

    def _comparing(
        self,
        naive: Any,
        exact: LongitudinalProgram | LateralProgram,
        osqp: LongitudinalProgram | LateralProgram,
        into: Differences,
    ) -> Any:
        def solve(task: Any, **_: Any) -> Any:
            arrays = naive.build(task)
            dense = {name: value.toarray() if name in "PGA" else value for name, value in arrays.items()}
            # Positions cost nothing, so the naive form needs DAQP's proximal term, which vanishes at the end.
            z = qpsolvers.solve_qp(**dense, solver=EXACT, eps_prox=1e-4)
            reference: Any = exact.solve(task)
            if z is None or not reference.found:
                raise SystemExit(f"{EXACT} found no optimum of a program: agreement cannot be shown")
            optimum = reference.cost
            if isinstance(exact, LateralProgram):
                optimum += exact.build(task).cost
            else:
                optimum -= reference.priced
            first = float(reference.command[0])
            into.objective.append(abs(naive.cost(task, z) - optimum) / max(1.0, abs(optimum)))
            into.first_command.append(abs(float(z[COMMAND]) - first))
            into.ours.append(abs(float(osqp.solve(task).command[0]) - first))
            plain = type(naive).solve(naive, task)
            if plain.found:
                into.naive.append(abs(float(plain.command[0]) - first))
            else:
                into.unsolved += 1
            return plain if plain.found else reference

        return solve


def compare(case: Case) -> tuple[Differences, Differences]:
    """Return the differences of all speed and all steering programs of some control steps."""
    comparison: Comparison | None = None
    for approach in perceptions.record(case):
        driver: Any = perceptions.controller(case, DEFAULT)
        for i, perception in enumerate(approach):
            if i and i % EVERY == 0:
                comparison = comparison or Comparison(driver, perception.ego.drive)
                naive = twin(driver, perception)
                comparison.watch(naive)
                naive.plan(perception, naive.decide(perception))
            driver.plan(perception, driver.decide(perception))
    if comparison is None:
        raise SystemExit(f"no control step of case {case} was recorded")
    return comparison.speed, comparison.steering


def agrees(summary: dict[str, float]) -> bool:
    """Return whether both forms have the same optimum within the stated tolerances."""
    return (
        summary["objective_difference"] <= OBJECTIVE_TOLERANCE
        and summary["first_command_difference"] <= COMMAND_TOLERANCE
    )


def check(cases: tuple[Case, ...]) -> dict[str, dict[str, float]]:
    """Print and return the agreement, by case and kind of program.

    Raises
    ------
    SystemExit
        If any two optima differ by more than the tolerances.
    """
    print(
        f"exact optima of both forms ({EXACT}): objective within {OBJECTIVE_TOLERANCE:g} relative, "
        f"first command within {COMMAND_TOLERANCE:g}; OSQP's errors of the first command, 99th percentile"
    )
    print(f"{'N/peds':8}{'program':10}{'count':>6}{'objective':>11}{'command':>10}{'osqp':>10}{'naive':>10}")
    found = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # OSQP's hint that it stopped early; such programs are counted
        for case in cases:
            for kind, differences in zip(("speed", "steering"), compare(case), strict=True):
                s = found[f"{case} {kind}"] = differences.summary()
                print(
                    f"{case!s:8}{kind:10}{s['programs']:6.0f}{s['objective_difference']:11.1e}"
                    f"{s['first_command_difference']:10.1e}{s['osqp_error_p99']:10.1e}"
                    f"{s['naive_osqp_error_p99']:10.1e}"
                    + (f"  naive unsolved {s['naive_unsolved']:.0f}" if s["naive_unsolved"] else "")
                )
    for name, summary in found.items():
        if not agrees(summary):
            raise SystemExit(f"the two forms of {name} are not the same problem: {summary}")
    print("agreement: yes, both forms are the same problem")
    return found


def _speed(like: LongitudinalProgram, drive: Drive, solver: str) -> LongitudinalProgram:
    how = SolverSettings(solver, like.solver.tolerance)
    return LongitudinalProgram(like.dt, drive.drive_lag, like.weights, like.limits, how)


def _steering(like: LateralProgram, drive: Drive, solver: str) -> LateralProgram:
    return LateralProgram(
        like.dt,
        drive.steering_lag,
        like.wheelbase,
        like.front,
        drive.max_steering,
        drive.max_steering_rate,
        like.weights,
        SolverSettings(solver, like.solver.tolerance),
    )
