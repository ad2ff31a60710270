"""The numbers of the velocity-obstacle paper's experiments, with an independent solver as the judge."""

from __future__ import annotations

import numpy as np
import pytest

from controllers.velocity_obstacle.cones import Cone
from studies.papers.velocity_obstacle import scenes
from studies.papers.velocity_obstacle.oracle import Task, best_of
from studies.papers.velocity_obstacle.scenes import AHEAD, BEHIND, E1, E2, Scene


@pytest.mark.long
@pytest.mark.parametrize(
    ("scene", "ahead", "behind"), [(E1, 2.7408, 6.0912), (E2, 17.2094, 1.4663)], ids=["E1", "E2"]
)
def test_the_optima_are_the_best_known_ones(scene: Scene, ahead: float, behind: float) -> None:
    problem = scenes.problem(scene)
    for which, side, known in ((AHEAD, 1.0, ahead), (BEHIND, -1.0, behind)):
        plan = scenes.optimum(problem, which)
        assert plan.cost == pytest.approx(known, abs=2e-4)
        assert best_of(Task(scene.steps, scene.first_y, side), 4, 1).cost == pytest.approx(known, abs=2e-4)


def test_the_first_experiment_accelerates_in_one_jump() -> None:
    plan = scenes.optimum(scenes.problem(E1), AHEAD)
    assert plan.states[3, 1] == pytest.approx(9.1555, abs=1e-3)
    assert plan.states[0, 6] == pytest.approx(53.28, abs=0.01)
    assert scenes.arrival(plan.states, 46.0) == pytest.approx(5.21, abs=0.01)


def test_the_second_experiment_brakes_and_arrives_late() -> None:
    plan = scenes.optimum(scenes.problem(E2), BEHIND)
    assert plan.states[3, -1] == pytest.approx(6.289, abs=1e-3)
    assert scenes.arrival(plan.states, 56.0) == pytest.approx(8.71, abs=0.01)


def test_a_motion_that_has_stopped_never_arrives() -> None:
    stopped = np.array([[0.0, 4.0, 4.0], [0.0] * 3, [0.0] * 3, [4.0, 0.0, 0.0]])
    assert scenes.arrival(stopped, 2.0) == pytest.approx(0.5 * scenes.STEP)
    assert scenes.arrival(stopped, 5.0) == np.inf


def test_the_other_reading_of_the_list_makes_braking_the_smaller_change() -> None:
    problem = scenes.problem(E1, listed_at=scenes.LISTED_AT_ZERO)
    assert scenes.optimum(problem, BEHIND).cost == pytest.approx(3.04, abs=0.01)
    assert scenes.optimum(problem, AHEAD).cost == pytest.approx(22.06, abs=0.01)


def test_the_hybrid_cone_asks_for_less() -> None:
    assert scenes.optimum(scenes.problem(E1, cone=Cone.HYBRID), AHEAD).cost == pytest.approx(1.4583, abs=2e-3)
    assert scenes.optimum(scenes.problem(E2, cone=Cone.HYBRID), BEHIND).cost == pytest.approx(
        0.5534, abs=2e-3
    )


@pytest.mark.parametrize(("scene", "best"), [(E1, 2.7408), (E2, 1.4663)], ids=["E1", "E2"])
@pytest.mark.parametrize("passes", [1, 2])
def test_driven_step_by_step_with_one_or_two_programs_it_stays_within_a_hundredth(
    scene: Scene, best: float, passes: int
) -> None:
    assert scenes.driven_cost(scenes.problem(scene), passes) == pytest.approx(best, rel=0.01)


@pytest.mark.slow
def test_the_lane_change_with_five_programs_a_step_is_at_its_optimum() -> None:
    problem = scenes.lane_change(1.0)
    best = min(scenes.optimum(problem, which).merit for which in (AHEAD, BEHIND))
    assert best == pytest.approx(2.7409, abs=1e-3)
    independent = best_of(Task(12, 40.0, 1.0, steers=True, end_x=3.5), 4, 1)
    assert best <= independent.cost * 1.001
    assert scenes.driven_cost(problem, 5) == pytest.approx(best, rel=0.01)
