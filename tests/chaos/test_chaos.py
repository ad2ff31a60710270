"""A few rounds of chaos; ``make chaos`` runs many."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.chaos.disturbances import DISTURBANCES
from tests.chaos.rounds import Chaos

SEED = 1
ALL_KINDS = len(DISTURBANCES)


@pytest.mark.long
@pytest.mark.sumo
@pytest.mark.parametrize("rounds", [1, pytest.param(ALL_KINDS, marks=pytest.mark.slow)])
def test_a_disturbed_batch_is_finished_like_an_undisturbed_one(rounds: int, tmp_path: Path) -> None:
    result = Chaos(tmp_path, SEED).run(rounds)
    assert result.wrong == []
    assert {kind for kind, _ in result.endings} == {one.__name__ for one in DISTURBANCES[:rounds]}
