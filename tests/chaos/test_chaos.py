"""A few rounds of chaos; ``make chaos`` runs many."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.chaos.rounds import Chaos

ROUNDS, SEED = 5, 1


@pytest.mark.sumo
def test_a_disturbed_batch_is_finished_like_an_undisturbed_one(tmp_path: Path) -> None:
    result = Chaos(tmp_path, SEED).run(ROUNDS)
    assert result.wrong == []
    assert result.endings.total() == ROUNDS
