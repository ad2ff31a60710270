"""The search near the last active rows against exact solvers, on drawn and on recorded programs."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
import qpsolvers

from controllers.interface import FloatArray
from controllers.programs.active_set import ActiveSet
from controllers.programs.qp import Program, Solution
from cosim.toy_world import ToyCrossing, ToyRoad, walk
from tests.controllers.toy_runs import ride

VARIABLES, ROWS = 8, 24
NOBODY = np.empty(0, dtype=np.int64)
MANY = 200

Drawn = tuple[FloatArray, FloatArray, FloatArray, FloatArray]


def _drawn(seed: int) -> Drawn:
    """Return a strictly convex program with a solution, some of its rows without bound."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(VARIABLES, VARIABLES))
    A = rng.normal(size=(ROWS, VARIABLES))
    b = A @ rng.uniform(-0.5, 0.5, VARIABLES) + rng.uniform(0.0, 0.5, ROWS)
    b[rng.random(ROWS) < 0.2] = np.inf
    return root @ root.T + 0.3 * np.eye(VARIABLES), 5.0 * rng.normal(size=VARIABLES), A, b


def _exact(program: Drawn, solver: str) -> FloatArray:
    P, q, A, b = program
    kept = np.isfinite(b)
    answer = qpsolvers.solve_problem(qpsolvers.Problem(P, q, A[kept], b[kept]), solver=solver)
    assert answer.found
    assert answer.x is not None
    return np.asarray(answer.x)


@pytest.mark.parametrize("seed", range(100))
def test_from_any_guess_it_is_the_optimum(seed: int) -> None:
    pytest.importorskip("daqp")
    program = _drawn(seed)
    rng = np.random.default_rng(seed)
    guesses = (NOBODY, rng.choice(ROWS, 3, replace=False), rng.permutation(ROWS)[:VARIABLES])
    for guess in guesses:
        found = ActiveSet().resume(*program, guess, MANY)
        assert found is not None
        assert np.allclose(found.z, _exact(program, "daqp"), atol=1e-7)
        P, q, A, b = program
        assert (A @ found.z - b).max() < 1e-7
        assert (found.multipliers >= 0.0).all()
        assert np.abs(P @ found.z + q + A[found.active].T @ found.multipliers).max() < 1e-7


def test_the_right_guess_needs_no_change() -> None:
    for seed in range(20):
        program, near = _drawn(seed), ActiveSet()
        found = near.resume(*program, NOBODY, MANY)
        assert found is not None
        again = near.resume(*program, found.active, 0)
        assert again is not None
        assert np.allclose(again.z, found.z, atol=1e-10)


def test_it_gives_up_after_as_many_changes_as_it_may_make() -> None:
    program = _drawn(3)
    found = ActiveSet().resume(*program, NOBODY, MANY)
    assert found is not None
    # Rows enter one by one, so fewer changes than active rows cannot be enough.
    assert len(found.active) >= 3
    for most in range(len(found.active)):
        assert ActiveSet().resume(*program, NOBODY, most) is None


def test_rows_that_exclude_each_other_have_no_optimum() -> None:
    A, b = np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([-0.2, -0.2])
    assert ActiveSet().resume(np.eye(2), np.zeros(2), A, b, NOBODY, MANY) is None


def test_a_guess_of_rows_that_depend_on_each_other_is_no_answer_and_does_no_harm() -> None:
    A, b = np.array([[1.0, 0.0], [2.0, 0.0], [0.0, 1.0]]), np.array([1.0, 2.0, 5.0])
    near, cost = ActiveSet(), -np.array([2.0, 1.0])
    near.resume(np.eye(2), cost, A, b, np.array([0, 1]), MANY)
    found = near.resume(np.eye(2), cost, A, b, NOBODY, MANY)
    assert found is not None
    assert np.allclose(found.z, [1.0, 1.0])


def test_a_new_cost_matrix_is_noticed() -> None:
    near, A, b = ActiveSet(), np.array([[1.0, 0.0]]), np.array([np.inf])
    q = np.array([-4.0, -4.0])
    for scale in (1.0, 2.0, 4.0):
        found = near.resume(scale * np.eye(2), q, A, b, NOBODY, 0)
        assert found is not None
        assert np.allclose(found.z, 4.0 / scale)


def _recorded(solver: str, tolerance: float) -> list[tuple[qpsolvers.Problem, Solution]]:
    """Return every program that an ego solves on its way past five pedestrians, with what it found."""
    kept: list[tuple[qpsolvers.Problem, Solution]] = []
    solve = Program.solve

    def keep(program: Program, *args: Any, **kwargs: Any) -> Solution:
        solution = solve(program, *args, **kwargs)
        kept.append((copy.deepcopy(program.problem()), solution))
        return solution

    people = [walk(62.0 + 0.4 * i, -6.0 + 3.0 * i, 0.0, (-1.0) ** i * (1.1 + 0.1 * i)) for i in range(5)]
    parameters = {"solver": solver, "tolerance": tolerance}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Program, "solve", keep)
        ride(ToyRoad(crossings=(ToyCrossing(60.0),)), people, duration=14.0, parameters=parameters)
    return kept


@pytest.mark.parametrize(
    ("solver", "tolerance", "error"),
    [("daqp", 1e-4, 1e-6), ("osqp", 1e-8, 1e-5)],
)
def test_a_drive_s_programs_have_the_optimum_of_the_full_problem(
    solver: str, tolerance: float, error: float
) -> None:
    pytest.importorskip("daqp")
    recorded = _recorded(solver, tolerance)
    assert len(recorded) > 300
    tight = dict.fromkeys(("eps_abs", "eps_rel", "eps_duality_gap_abs", "eps_duality_gap_rel"), 1e-12)
    for problem, solution in recorded:
        exact = qpsolvers.solve_problem(problem, solver="piqp", **tight)  # type: ignore[arg-type]
        assert solution.found
        assert exact.x is not None
        assert abs(solution.z[0] - exact.x[0]) < error
