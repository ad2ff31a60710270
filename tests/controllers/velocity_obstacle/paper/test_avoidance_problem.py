"""The velocity-obstacle paper's problem: derivatives, cones, optimality, the search, the septic path."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import nnls

from controllers.arrays import FloatArray
from controllers.driving.lanes.septic_path import PROFILE, SepticPath
from controllers.optimisation.settings import SolverSettings
from controllers.velocity_obstacle.cones import Cone
from controllers.velocity_obstacle.paper.cone_margins import People, clearances, cone_margins
from controllers.velocity_obstacle.paper.euler_bicycle import ALONG, SPEED, EulerBicycle
from controllers.velocity_obstacle.paper.genetic_algorithm import GeneticBudget, solve_genetically
from controllers.velocity_obstacle.paper.genetic_search import search
from controllers.velocity_obstacle.paper.passing_classes import QuadraticOptimiser, class_jumps
from controllers.velocity_obstacle.paper.problem import (
    AvoidanceProblem,
    InputLimits,
    Room,
    all_room,
    gradients,
    margins,
)
from controllers.velocity_obstacle.paper.sequential_programs import AvoidanceProgram

STEPS = 8
EXACTLY = SolverSettings("osqp", 1e-7)


def crossing(
    first_along: float = 40.0,
    *,
    cone: Cone = Cone.VO,
    steers: bool = True,
    side: float = 1.0,
    room: Room | None = None,
) -> AvoidanceProblem:
    """Return a scene with somebody who walks to the left and away."""
    walked = np.arange(float(STEPS))[None]
    one = np.ones((1, STEPS))
    who = People(first_along + walked, walked - 6.0, one, one, np.array([side]), 2.0 * one)
    return AvoidanceProblem(
        EulerBicycle(2.6, 1.0),
        np.array([0.0, 0.0, 0.0, 7.5, 0.0]),
        who,
        room or all_room(STEPS),
        cone=cone,
        steers=steers,
    )


def some_inputs(seed: int) -> FloatArray:
    drawn = np.random.default_rng(seed)
    return np.stack([drawn.normal(0.0, 0.5, STEPS), drawn.normal(0.0, 0.01, STEPS)])


@pytest.mark.parametrize("seed", range(5))
def test_the_states_sensitivities_are_their_finite_differences(seed: int) -> None:
    bicycle, start, inputs = EulerBicycle(2.6, 1.0), np.array([1.0, 0.2, 0.05, 7.0, 0.01]), some_inputs(seed)
    exact = bicycle.sensitivities(bicycle.states(start, inputs))
    for k in range(2 * STEPS):
        step = np.zeros(2 * STEPS)
        step[k] = 1e-6
        both = [bicycle.states(start, inputs + sign * step.reshape(2, -1))[:, 1:] for sign in (1.0, -1.0)]
        np.testing.assert_allclose(exact[:, :, k], (both[0] - both[1]) / 2e-6, atol=2e-6)


@pytest.mark.parametrize("cone", [Cone.VO, Cone.IVO, Cone.HYBRID])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_every_margins_gradient_is_its_finite_difference(cone: Cone, side: float) -> None:
    room = Room(np.full(STEPS, 60.0), np.full(STEPS, -5.0), np.full(STEPS, -4.0), np.full(STEPS, 4.0), 1.0)
    problem = crossing(cone=cone, side=side, room=room)
    inputs = some_inputs(3)
    exact = np.concatenate(gradients(problem, problem.states(inputs)).blocks())
    for k in range(2 * STEPS):
        step = np.zeros(2 * STEPS)
        step[k] = 1e-6
        both = [
            np.concatenate(margins(problem, problem.states(inputs + sign * step.reshape(2, -1))).blocks())
            for sign in (1.0, -1.0)
        ]
        np.testing.assert_allclose(exact[:, k], (both[0] - both[1]) / 2e-6, atol=1e-4)


@given(
    px=st.floats(-30.0, 30.0),
    py=st.floats(-30.0, 30.0),
    speed=st.floats(0.1, 15.0),
    heading=st.floats(-1.5, 1.5),
    vx=st.floats(-2.0, 2.0),
    vy=st.floats(-2.0, 2.0),
)
def test_the_two_half_planes_cover_exactly_the_complement_of_the_cone(
    px: float, py: float, speed: float, heading: float, vx: float, vy: float
) -> None:
    distance, radius = np.hypot(px, py), 2.0
    if distance < radius + 0.01:
        return
    states = np.zeros((5, 2))
    states[2, 1], states[3, 1] = heading, speed
    place, velocity = np.array([[px], [py]]), np.array([[vx], [vy]])
    both = []
    for side in (1.0, -1.0):
        who = People(
            place[:1], place[1:], velocity[:1], velocity[1:], np.array([side]), np.full((1, 1), radius)
        )
        both.append(float(cone_margins(Cone.VO, who, states)[0]))
    wx, wy = speed * np.cos(heading) - vx, speed * np.sin(heading) - vy
    turned = np.arctan2(wy, wx) - np.arctan2(py, px)
    off = abs((turned + np.pi) % (2.0 * np.pi) - np.pi)
    half = np.arcsin(radius / distance)
    if abs(off - half) > 1e-6 and np.hypot(wx, wy) > 1e-6:
        assert (max(both) >= 0.0) == (off >= half)


@pytest.mark.parametrize("behind", [0, 1])
@pytest.mark.parametrize("steers", [False, True])
def test_an_optimum_satisfies_the_optimality_conditions(behind: int, steers: bool) -> None:
    problem = crossing(steers=steers)
    plan = QuadraticOptimiser(passes=60, solver=EXACTLY).solve_class(
        problem, behind, class_jumps(problem)[1][behind]
    )
    assert plan.violation < 1e-4
    # The gradient of the objective is a sum of active margins' gradients with weights that are not negative.
    side = problem.people.side * (1.0 if behind == 0 else -1.0)
    fixed = problem.passed(side)
    n = STEPS * (2 if steers else 1)
    value = np.concatenate(margins(fixed, plan.states).blocks())
    slopes = np.concatenate(gradients(fixed, plan.states).blocks())[:, :n]
    objective = 2.0 * (problem.weights * plan.inputs).ravel()[:n]
    active = slopes[value < 2e-3]

    # Inputs at their own bounds carry weights as well; none of them is there in these scenes.
    low, high = problem.bounds()
    inner = (plan.inputs > low + 1e-4) & (plan.inputs < high - 1e-4)
    assert inner.ravel()[:n].all()
    _, residual = nnls(active.T, objective)
    assert residual < 2e-2 * max(float(np.linalg.norm(objective)), 1.0)


def test_the_cone_at_every_step_keeps_the_distance_in_between_as_well() -> None:
    problem = crossing(steers=False)
    plan = QuadraticOptimiser(passes=60, solver=EXACTLY).solve(problem, None)
    assert clearances(problem.people, plan.states, 1.0).min() > -1e-3


@pytest.mark.long
@given(seed=st.integers(0, 10_000))
def test_one_program_stays_within_the_bounds_and_never_makes_a_plan_worse(seed: int) -> None:
    problem = crossing().passed(np.array([-1.0]))
    program = AvoidanceProgram(STEPS, 1, True, 0)
    begun = np.clip(some_inputs(seed), *problem.bounds())
    first = program.solve(problem, begun, passes=0)
    plan = program.solve(problem, begun, passes=2)
    low, high = problem.bounds()
    assert (plan.inputs >= low - 1e-9).all()
    assert (plan.inputs <= high + 1e-9).all()
    assert plan.merit <= first.merit + 1e-9


def test_speed_stays_below_its_limit_and_gaps_are_kept() -> None:
    free = all_room(STEPS)
    leader = Room(15.0 + 3.0 * np.arange(1.0, STEPS + 1.0), free.behind, free.right, free.left, 1.0)
    problem = crossing(200.0, steers=False, room=leader)
    plan = QuadraticOptimiser(passes=10).solve(problem, None)
    assert (plan.states[ALONG, 1:] + plan.states[SPEED, 1:] <= leader.ahead + 1e-3).all()
    assert (plan.states[SPEED] <= InputLimits().speed).all()
    assert (plan.states[SPEED] >= -1e-6).all()


def test_the_search_gives_the_same_plan_for_the_same_seed_and_none_that_is_cheaper() -> None:
    pytest.importorskip("pymoo")
    problem = crossing(steers=False)
    best = QuadraticOptimiser(passes=60, solver=EXACTLY, classes=2).solve(problem, None)
    budget = GeneticBudget(40, 40)
    one, again, other = (solve_genetically(problem, budget, seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.inputs, again.inputs)
    assert (one.inputs != other.inputs).any()
    for plan in (one, other):
        assert plan.into_cones < 1e-6
        assert best.cost * (1.0 - 1e-3) <= plan.cost < 3.0 * best.cost


@pytest.mark.parametrize("population", [12, 13])
def test_the_search_is_that_of_pymoos_own_algorithm(population: int) -> None:
    """Only faster: its crossover, mutation, selection and survival, with the same random numbers."""
    ga = pytest.importorskip("pymoo.algorithms.soo.nonconvex.ga")
    functional = pytest.importorskip("pymoo.problems.functional")
    optimize = pytest.importorskip("pymoo.optimize")
    drawn = np.random.default_rng(3)
    first = drawn.uniform(-1.0, 1.0, (population, 5))

    def value(genes: FloatArray) -> tuple[FloatArray, FloatArray]:
        return (genes**2).sum(axis=1).round(1), np.maximum(0.3 - genes[:, 0], 0.0).round(1)

    problem = functional.FunctionalProblem(
        5,
        [lambda x: value(x[None])[0][0]],
        constr_ieq=[lambda x: value(x[None])[1][0]],
        xl=np.full(5, -1.0),
        xu=np.ones(5),
    )
    own = ga.GA(pop_size=population, sampling=first, eliminate_duplicates=False)
    found = optimize.minimize(problem, own, ("n_gen", 15), seed=7)
    genes = search(first, value, -np.ones(5), np.ones(5), 15, 7)
    np.testing.assert_array_equal(genes, found.pop.get("X"))


def test_the_septic_path_has_the_peaks_of_its_closed_form() -> None:
    path, speed = SepticPath(3.5, 29.5), 7.5
    assert path.lateral_speed(speed) == pytest.approx(1.95, abs=0.005)
    assert path.lateral_acceleration(speed) == pytest.approx(1.70, abs=0.005)
    assert np.degrees(path.steepest()) == pytest.approx(14.6, abs=0.1)
    share = np.linspace(0.0, 1.0, 200_001)
    assert PROFILE.deriv(1)(share).max() == pytest.approx(35.0 / 16.0, rel=1e-9)
    assert PROFILE.deriv(2)(share).max() == pytest.approx(84.0 / 5.0**1.5, rel=1e-8)
    for order in (1, 2, 3):
        assert PROFILE.deriv(order)(np.array([0.0, 1.0])) == pytest.approx([0.0, 0.0], abs=1e-9)
