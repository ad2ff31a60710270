"""Quadratic programs: solutions and their certificates, with other programs and known optima as judges."""

from __future__ import annotations

import numpy as np
import osqp
import pytest
import qpsolvers

from controllers.arrays import FloatArray
from controllers.optimisation import warm_osqp
from controllers.optimisation.problem import Problem, blank
from controllers.optimisation.settings import SolverSettings
from controllers.optimisation.solution import CLOSED, FEASIBLE, STATIONARY, Rows, certify
from controllers.optimisation.solve import Memory, Tally, solve
from tests.controllers.faulty_solvers import FAULTS, Answer, fails, installed

VARIABLES, ROWS = 12, 20
OURS = ("daqp", "osqp", "piqp")
"""Solvers that every installation has, and the exact reference of the tests."""


def _problem(seed: int, bounded_rows: int = ROWS) -> Problem:
    """Return a strictly convex problem that has a solution, in two blocks of rows."""
    drawn = np.random.default_rng(seed)
    p = blank("x'Px", {"inputs [m/s]": VARIABLES}, {"near [m]": 8, "far [m]": ROWS - 8})
    root = drawn.normal(size=(VARIABLES, VARIABLES))
    p.P[:] = root @ root.T + 0.5 * np.eye(VARIABLES)
    p.q[:] = drawn.normal(size=VARIABLES) * 5.0
    p.G[:] = np.tril(drawn.normal(size=(ROWS, VARIABLES)), 4)
    p.h[:] = p.G @ drawn.uniform(-0.4, 0.4, VARIABLES) + drawn.uniform(0.0, 0.4, ROWS)
    p.h[bounded_rows:] = np.inf
    p.lower[:], p.upper[:] = -0.5, 0.5
    return p


def bounded(problem: Problem) -> Rows:
    """Return all rows of a problem that has no others."""
    return Rows(np.arange(len(problem.h)), problem.G, problem.h)


def _spoil(problem: Problem, how: str) -> None:
    if how == "nan in the objective":
        problem.q[3] = np.nan
    elif how == "nan in a row":
        problem.G[2, 1] = np.nan
    elif how == "nan in a row's bound":
        problem.h[0] = np.nan
    elif how == "nan in a variable's bound":
        problem.lower[5] = np.nan
    elif how == "infinite cost":
        problem.P[0, 0] = np.inf
    elif how == "bounds that cross":
        problem.lower[2] = 0.7
    else:
        problem.G[:2] = 0.0
        problem.G[0, 0], problem.G[1, 0] = 1.0, -1.0
        problem.h[:2] = -0.2  # z0 <= -0.2 and z0 >= 0.2


def _reference(problem: Problem) -> FloatArray:
    """Return what PIQP finds when it is asked directly."""
    rows = np.isfinite(problem.h)
    answer = qpsolvers.solve_qp(
        problem.P,
        problem.q,
        problem.G[rows],
        problem.h[rows],
        lb=problem.lower,
        ub=problem.upper,
        solver="piqp",
    )
    assert answer is not None
    return answer


@pytest.mark.parametrize("name", OURS)
def test_a_sequence_of_problems_is_solved_as_another_program_solves_it(name: str) -> None:
    memory = Memory()
    for seed in range(30):
        problem = _problem(seed, ROWS - seed % 7)
        solution = solve(problem, SolverSettings(name, 1e-7), memory)
        reference = _reference(problem)
        assert solution.solved
        assert solution.status == "solved"
        assert solution.z == pytest.approx(reference, abs=1e-4)
        assert solution.cost == pytest.approx(problem.cost(reference), abs=1e-3)
    assert memory.tally.take() == (30, 0)


@pytest.mark.parametrize("name", OURS)
def test_the_certificate_is_that_of_qpsolvers(name: str) -> None:
    for seed in range(10):
        problem = _problem(seed)
        solution = solve(problem, SolverSettings(name, 1e-6))
        theirs = qpsolvers.Solution(
            qpsolvers.Problem(problem.P, problem.q, problem.G, problem.h, lb=problem.lower, ub=problem.upper),
            found=True,
            x=solution.z,
            z=solution.multipliers,
            z_box=solution.bound_multipliers,
        )
        ours = solution.certificate
        assert ours.primal_residual == pytest.approx(theirs.primal_residual(), abs=1e-9)
        # Ours are relative to terms of at least 1.
        assert ours.dual_residual <= theirs.dual_residual() + 1e-12
        assert ours.duality_gap <= theirs.duality_gap() + 1e-12


def test_the_certificate_of_a_hand_made_problem_is_what_one_gets_by_hand() -> None:
    """Minimise ``(v - 8)^2`` below 7: at 7 the limit pulls with a multiplier of 2."""
    problem = blank("(v - 8)^2", {"speed [m/s]": 1}, {"limit [m/s]": 1})
    problem.P[0, 0], problem.q[0], problem.G[0, 0], problem.h[0] = 2.0, -16.0, 1.0, 7.0
    rows = bounded(problem)
    best = certify(problem, rows, np.array([7.0]), np.array([2.0]), np.zeros(1))
    assert best.solved
    assert best.cost == pytest.approx(49.0 - 112.0)
    assert (best.certificate.dual_residual, best.certificate.duality_gap) == (0.0, 0.0)
    free = certify(problem, rows, np.array([8.0]), np.zeros(1), np.zeros(1))
    assert not free.solved
    assert free.certificate.primal_residual == 1.0
    assert free.status == f"primal residual 1 above {FEASIBLE:g}"
    short = certify(problem, rows, np.array([6.0]), np.zeros(1), np.zeros(1))
    # The gradient there is 12 - 16 = -4, beside terms of up to 16.
    assert short.certificate.dual_residual == pytest.approx(0.25)
    assert "dual residual 0.25" in short.status


@pytest.mark.parametrize("by", ["z", "y", "box"])
def test_a_solution_that_is_moved_away_is_no_solution_any_more(by: str) -> None:
    problem = _problem(3)
    good = solve(problem, SolverSettings())
    parts = {"z": good.z, "y": good.multipliers, "box": good.bound_multipliers}
    assert certify(problem, good.rows, **parts).solved
    for seed in range(5):
        moved = parts | {by: parts[by] + np.random.default_rng(seed).choice((-0.3, 0.3), len(parts[by]))}
        assert not certify(problem, good.rows, **moved).solved


def test_multipliers_of_bounds_that_do_not_exist_prove_nothing() -> None:
    problem = _problem(4, bounded_rows=5)
    problem.upper[:] = np.inf
    good = solve(problem, SolverSettings())
    assert good.rows.numbers.tolist() == [0, 1, 2, 3, 4]
    box = good.bound_multipliers.copy()
    box[np.argmax(box == 0.0)] = 50.0
    again = certify(problem, good.rows, good.z, good.multipliers, box)
    assert again.solved
    assert again.certificate == good.certificate


@pytest.mark.parametrize("fault", FAULTS)
def test_what_a_faulty_solver_says_is_not_used(fault: Answer, monkeypatch: pytest.MonkeyPatch) -> None:
    name = installed(monkeypatch, "faulty", fault)
    memory = Memory()
    solution = solve(_problem(1), SolverSettings(name), memory)
    assert not solution.solved
    assert solution.status != "solved"
    assert np.isfinite(solution.z).all()
    assert memory.tally == Tally(1, 1)


@pytest.mark.parametrize("name", OURS)
@pytest.mark.parametrize(
    "how",
    [
        "nan in the objective",
        "nan in a row",
        "nan in a row's bound",
        "nan in a variable's bound",
        "infinite cost",
        "bounds that cross",
        "no solution",
    ],
)
def test_a_problem_that_cannot_be_solved_is_unsolved_and_the_next_one_is_right_again(
    name: str, how: str
) -> None:
    settings, memory = SolverSettings(name, 1e-6), Memory()
    assert solve(_problem(1), settings, memory).solved
    spoiled = _problem(1)
    _spoil(spoiled, how)
    nothing = solve(spoiled, settings, memory)
    assert not nothing.solved
    assert not nothing.z.any()
    again = solve(_problem(2), settings, memory)
    assert again.solved
    assert again.z == pytest.approx(_reference(_problem(2)), abs=1e-4)
    assert memory.tally == Tally(3, 1)


def test_the_iteration_limit_is_no_solution_and_leaves_no_trace(monkeypatch: pytest.MonkeyPatch) -> None:
    settings, memory = SolverSettings("osqp", 1e-7), Memory()
    monkeypatch.setattr(warm_osqp, "MAX_ITERATIONS", 1)
    assert not solve(_problem(3), settings, memory).solved
    monkeypatch.undo()
    fresh = solve(_problem(3), settings)
    np.testing.assert_array_equal(solve(_problem(3), settings, memory).z, fresh.z)


def test_osqp_is_set_up_once_for_problems_whose_values_change(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[int] = []
    original = osqp.OSQP

    def counted() -> object:
        made.append(1)
        return original()

    monkeypatch.setattr(osqp, "OSQP", counted)
    memory, settings = Memory(), SolverSettings("osqp", 1e-6)
    for seed in range(20):
        assert solve(_problem(seed, ROWS - seed % 7), settings, memory).solved
    assert len(made) == 1
    denser = _problem(20)
    denser.G[0, VARIABLES - 1] = 0.1
    assert solve(denser, settings, memory).z == pytest.approx(_reference(denser), abs=1e-4)
    assert len(made) == 2


def test_osqp_is_asked_for_more_digits_where_a_loose_answer_is_not_good_enough() -> None:
    problem = _problem(6)
    np.multiply(problem.q, 1000.0, out=problem.q)
    np.multiply(problem.P, 1000.0, out=problem.P)
    problem.lower[:], problem.upper[:] = -np.inf, np.inf
    solution = solve(problem, SolverSettings("osqp", 1e-1))
    assert solution.solved
    assert solution.z == pytest.approx(_reference(problem), abs=0.01)
    held = solution.certificate
    assert held.primal_residual <= FEASIBLE
    assert held.dual_residual <= STATIONARY
    assert held.duality_gap <= CLOSED


def test_a_problem_without_any_row_is_solved_too() -> None:
    for name in OURS:
        problem = _problem(5, bounded_rows=0)
        solution = solve(problem, SolverSettings(name, 1e-6))
        assert solution.solved
        assert solution.z == pytest.approx(_reference(problem), abs=1e-4)


def test_a_problem_can_be_looked_at_in_words() -> None:
    problem = _problem(4, bounded_rows=7)
    assert str(problem).splitlines() == [
        "minimise x'Px",
        "over",
        "    12 x inputs [m/s], -0.5 to 0.5",
        "subject to",
        "     7 x near [m]",
        "     0 x far [m]",
    ]
    z = np.zeros(VARIABLES)
    z[0] = 2.0
    problem.G[3], problem.h[3] = 0.0, 0.25
    problem.G[3, 0] = 1.0
    found = problem.violations(z)
    assert found["inputs [m/s]"] == pytest.approx(1.5)
    assert found["near [m]"] >= 1.75
    assert "far [m]" not in found


@pytest.mark.parametrize("name", ["no such", "wheels-only"])
def test_an_unknown_solver_is_refused_with_those_that_exist(name: str) -> None:
    with pytest.raises(ValueError, match=rf"^unknown solver '{name}'; installed are: .*daqp, osqp") as caught:
        SolverSettings(name)
    assert warm_osqp.WARM_OSQP not in str(caught.value)


def test_a_solver_that_is_not_installed_is_told_with_the_command_that_installs_it() -> None:
    assert "gurobi" not in qpsolvers.available_solvers
    with pytest.raises(ValueError, match=r"'gurobi' is not installed: pip install 'qpsolvers\[gurobi\]'"):
        SolverSettings("gurobi")


def test_one_tally_counts_for_several_memories(monkeypatch: pytest.MonkeyPatch) -> None:
    name = installed(monkeypatch, "faulty", fails)
    tally = Tally()
    solve(_problem(1), SolverSettings(), Memory(tally))
    solve(_problem(1), SolverSettings(name), Memory(tally))
    assert tally == Tally(2, 1)
    assert tally.take() == (2, 1)
    assert tally == Tally()


def test_what_solves_changes_nothing_of_the_problem() -> None:
    for name in OURS:
        problem, twin = _problem(9, 15), _problem(9, 15)
        solve(problem, SolverSettings(name))
        for field in ("P", "q", "G", "h", "lower", "upper"):
            np.testing.assert_array_equal(getattr(problem, field), getattr(twin, field))
