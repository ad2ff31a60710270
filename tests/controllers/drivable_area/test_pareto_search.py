"""NSGA-II over two genes."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from controllers.arrays import FloatArray
from controllers.drivable_area.pareto_search import Budget, Front, search
from controllers.optimisation.packages import require_pymoo

LOWER, UPPER = np.array([-2.0, 0.0]), np.array([2.0, 10.0])


def _judge(genes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two distances, to (-1, 3) and to (1, 3); only genes with a speed of 5 at most are possible."""
    one = np.hypot(genes[:, 0] + 1.0, genes[:, 1] - 3.0)
    other = np.hypot(genes[:, 0] - 1.0, genes[:, 1] - 3.0)
    return np.column_stack((one, other)), genes[:, 1:] - 5.0


def _found(seed: int, budget: Budget | None = None, hints: FloatArray | None = None) -> Front:
    no_hints = np.zeros((0, 2))
    return search(
        _judge, (2, 1), LOWER, UPPER, no_hints if hints is None else hints, budget or Budget(), seed
    )


def test_the_front_is_the_line_between_the_two_best() -> None:
    front = _found(3, Budget(40, 60))
    np.testing.assert_allclose(front.genes[:, 1], 3.0, atol=0.15)
    assert front.genes[:, 0].min() == pytest.approx(-1.0, abs=0.1)
    assert front.genes[:, 0].max() == pytest.approx(1.0, abs=0.1)
    costs, _ = _judge(front.genes)
    np.testing.assert_array_equal(costs, front.costs)
    dominated = (costs[:, None] >= costs).all(axis=2) & (costs[:, None] > costs).any(axis=2)
    assert not dominated.any()


def test_the_seed_decides_and_nothing_else() -> None:
    before = np.random.default_rng(0)
    first, again, other = _found(1), _found(1), _found(2)
    np.testing.assert_array_equal(first.genes, again.genes)
    assert first.genes.shape != other.genes.shape or np.abs(first.genes - other.genes).max() > 1e-6
    assert before.random() == np.random.default_rng(0).random()


def test_the_budget_is_kept() -> None:
    assert _found(1, Budget(12, 5)).looked_at == 60


def test_a_hint_that_is_best_survives() -> None:
    front = _found(1, Budget(6, 1), np.array([[-1.0, 3.0], [9.0, 9.0]]))
    assert front.costs[:, 0].min() == 0.0
    assert (front.genes <= UPPER).all()


def test_nothing_possible_is_an_empty_front() -> None:
    def hopeless(genes: FloatArray) -> tuple[FloatArray, FloatArray]:
        costs, _ = _judge(genes)
        return costs, np.ones((len(genes), 1))

    front = search(hopeless, (2, 1), LOWER, UPPER, np.zeros((0, 2)), Budget(8, 3), 1)
    assert front.genes.shape == (0, 2)
    assert front.costs.shape == (0, 2)


def test_without_pymoo_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pymoo", None)
    with pytest.raises(ValueError, match=r"needs pymoo: pip install pymoo"):
        require_pymoo()
