"""Proposals: the same answers lead to the same ones, and a search that learns beats chance."""

from __future__ import annotations

from collections.abc import Callable
from statistics import median

import pytest

from analysis.search.axes import Axis, Point
from cosim.errors import InputError
from cosim.search import search as search_module
from cosim.search.proposals import GENERATION, METHODS, first_generations, propose

AXES = (*(Axis(f"x{number}") for number in range(3)), Axis("side", choices=("left", "right")))


def bowl(point: Point) -> float:
    """Return a margin that is negative in 0.1 % of the space, with a slope around that."""
    far = max(abs(float(point[f"x{number}"]) - 0.8) for number in range(3)) - 0.063
    return far + (0.3 if point["side"] == "left" else 0.0)


def search(method: str, seed: int, budget: int, margin: Callable[[Point], float]) -> list[Point]:
    proposer = propose(method, AXES, seed, budget)
    found: list[Point] = []
    while len(found) < budget:
        points = proposer.ask(min(GENERATION, budget - len(found)))
        proposer.tell(points, [margin(one) for one in points])
        found += points
    return found


@pytest.mark.long
@pytest.mark.parametrize("method", METHODS)
def test_the_same_seed_and_answers_give_the_same_proposals_and_another_seed_others(method: str) -> None:
    first = search(method, 1, 80, bowl)
    assert search(method, 1, 80, bowl) == first
    assert search(method, 2, 80, bowl) != first
    assert all(0.0 <= float(one["x0"]) <= 1.0 and one["side"] in ("left", "right") for one in first)


def test_the_first_trials_cover_the_space_and_depend_on_no_answer() -> None:
    even = first_generations("cma-es", 200)
    assert even == 50
    first = search("cma-es", 1, 200, bowl)[:even]
    assert first == search("cma-es", 1, 200, lambda _: 0.5)[:even]
    assert sum(one["side"] == "left" for one in first) in range(22, 29)


@pytest.mark.long
def test_with_a_slope_the_search_finds_a_small_fault_sooner_than_chance() -> None:
    def first_failure(method: str, seed: int) -> int:
        found = search(method, seed, 300, bowl)
        return next((number for number, one in enumerate(found, 1) if bowl(one) < 0.0), 301)

    guided = median(first_failure("cma-es", seed) for seed in range(5))
    chance = median(first_failure("random", seed) for seed in range(5))
    assert guided < 0.5 * chance


def test_an_unknown_method_is_refused() -> None:
    with pytest.raises(InputError, match="--method cmaes: did you mean"):
        propose("cmaes", AXES, 1, 100)


@pytest.mark.parametrize("package", ["optuna", "cmaes", "SALib"])
def test_without_the_extra_a_search_does_not_begin(package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search_module, "find_spec", lambda name: None if name == package else object())
    with pytest.raises(
        InputError, match=rf"^{package} is not installed; run: pip install optuna cmaes SALib"
    ):
        search_module.prepared(search_module.FalsifyRequest("jaywalk_arterial", "aeb"))
