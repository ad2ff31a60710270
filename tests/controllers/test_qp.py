"""The persistent workspace against an exact solver, and what happens when a problem has no solution."""

from __future__ import annotations

import numpy as np
import pytest
import qpsolvers

from controllers.interface import FloatArray
from controllers.programs.osqp_workspace import PERSISTENT_OSQP
from controllers.programs.qp import Program

VARIABLES, ROWS = 12, 20


def _program(solver: str = "osqp", tolerance: float = 1e-7, changes: int | None = -1) -> Program:
    pattern = np.tril(np.ones((ROWS, VARIABLES), dtype=bool), 4)
    return Program(np.ones((VARIABLES, VARIABLES), dtype=bool), pattern, solver, tolerance, changes)


def _fill(program: Program, seed: int, bounded_rows: int = ROWS) -> None:
    """Write a strictly convex problem that has a solution."""
    drawn = np.random.default_rng(seed)
    root = drawn.normal(size=(VARIABLES, VARIABLES))
    program.P[:] = root @ root.T + 0.5 * np.eye(VARIABLES)
    program.q[:] = drawn.normal(size=VARIABLES) * 5.0
    program.G[:] = np.where(program.row_pattern, drawn.normal(size=(ROWS, VARIABLES)), 0.0)
    inside = drawn.uniform(-0.4, 0.4, VARIABLES)
    program.h[:] = program.G @ inside + drawn.uniform(0.0, 0.4, ROWS)
    program.h[bounded_rows:] = np.inf
    program.lower[:], program.upper[:] = -0.5, 0.5


def _exact(program: Program) -> FloatArray:
    """Return the solution of an active-set solver."""
    answer = qpsolvers.solve_problem(program.problem(), solver="daqp")
    assert answer.found
    assert answer.x is not None
    return np.asarray(answer.x)


def _spoil(program: Program, how: str) -> None:
    if how == "nan in the objective":
        program.q[3] = np.nan
    elif how == "nan in a row":
        program.G[2, 1] = np.nan
    elif how == "nan in a bound":
        program.h[0] = np.nan
    elif how == "infinite cost":
        program.P[0, 0] = np.inf
    else:
        program.G[0], program.G[1] = 0.0, 0.0
        program.G[0, 0], program.G[1, 0] = 1.0, -1.0
        program.h[0], program.h[1] = -0.2, -0.2  # z0 <= -0.2 and z0 >= 0.2


def test_one_workspace_solves_a_sequence_of_problems_as_an_exact_solver_does() -> None:
    pytest.importorskip("daqp")
    program = _program()
    warm = None
    for seed in range(30):
        _fill(program, seed, bounded_rows=ROWS - seed % 7)
        solution = program.solve(warm)
        exact = _exact(program)
        assert solution.found
        assert np.allclose(solution.z, exact, atol=1e-4)
        assert solution.cost == pytest.approx(program.cost(exact), abs=1e-3)
        warm = solution.z


def test_a_solver_by_name_gives_the_same_solution_and_certificate() -> None:
    pytest.importorskip("daqp")
    ours, other = _program(), _program("daqp")
    for seed in range(5):
        _fill(ours, seed, 15)
        _fill(other, seed, 15)
        a, b = ours.solve(), other.solve()
        assert np.allclose(a.z, b.z, atol=1e-4)
        assert np.allclose(a.dual, b.dual, atol=1e-2)
        assert b.stationarity(other) < 1e-6


def test_a_solution_meets_the_optimality_conditions() -> None:
    program = _program()
    for seed in range(20):
        _fill(program, seed)
        solution = program.solve()
        room = program.h - program.G @ solution.z
        assert solution.violation < 1e-5
        assert solution.stationarity(program) < 1e-4
        assert (solution.dual >= 0.0).all()
        assert np.abs(solution.dual * room).max() < 1e-4
        at_upper = solution.box_dual * (program.upper - solution.z)
        at_lower = solution.box_dual * (solution.z - program.lower)
        assert np.abs(np.where(solution.box_dual > 0.0, at_upper, at_lower)).max() < 1e-4


@pytest.mark.parametrize("solver", ["osqp", "daqp"])
@pytest.mark.parametrize(
    "how", ["nan in the objective", "nan in a row", "nan in a bound", "infinite cost", "no solution"]
)
def test_a_problem_that_cannot_be_solved_is_not_found_and_the_next_one_is_right_again(
    solver: str, how: str
) -> None:
    pytest.importorskip("daqp")
    program = _program(solver)
    _fill(program, 1)
    assert program.solve().found
    _spoil(program, how)
    nothing = program.solve()
    assert not nothing.found
    assert np.isfinite(nothing.z).all()
    _fill(program, 2)
    again = program.solve()
    assert again.found
    assert np.allclose(again.z, _exact(program), atol=1e-4)


def test_the_iteration_limit_is_not_a_solution_and_leaves_no_trace(monkeypatch: pytest.MonkeyPatch) -> None:
    program, fresh = _program(), _program()
    monkeypatch.setattr("controllers.programs.osqp_workspace.MAX_ITERATIONS", 1)
    _fill(program, 3)
    assert not program.solve().found
    monkeypatch.undo()
    _fill(fresh, 3)
    assert np.array_equal(program.solve().z, fresh.solve().z)


def test_the_problem_can_be_looked_at_without_its_unbounded_rows() -> None:
    program = _program()
    _fill(program, 4, bounded_rows=7)
    problem = program.problem()
    assert np.array_equal(np.asarray(problem.G), program.G[:7])
    assert np.array_equal(np.asarray(problem.h), program.h[:7])


def test_cost_and_violation_are_those_of_the_formula() -> None:
    program = _program()
    program.P[:] = 2.0 * np.eye(VARIABLES)
    program.q[0] = 1.0
    program.G[0, 0], program.h[0] = 1.0, 0.25
    program.lower[:], program.upper[:] = -1.0, 1.0
    z = np.zeros(VARIABLES)
    z[0] = 2.0
    assert program.cost(z) == pytest.approx(4.0 + 2.0)
    assert program.violation(z) == pytest.approx(1.75)
    assert program.violation(0.0 * z) == 0.0


def test_an_unknown_solver_is_refused_with_those_that_exist() -> None:
    with pytest.raises(ValueError, match=r"unknown solver 'no such'; installed are: .*osqp") as caught:
        _program("no such")
    assert PERSISTENT_OSQP not in str(caught.value)
