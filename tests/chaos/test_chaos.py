"""A few rounds of chaos; ``make chaos`` runs many."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.chaos.disturbances import DISTURBANCES
from tests.chaos.rounds import Chaos

ROUNDS, SEED = 3, 1
"""One of each kind of disturbance."""


@pytest.mark.sumo
def test_a_disturbed_batch_is_finished_like_an_undisturbed_one(tmp_path: Path) -> None:
    assert len(DISTURBANCES) == ROUNDS
    result = Chaos(tmp_path, SEED).run(ROUNDS)
    assert result.wrong == []
    assert {kind for kind, _ in result.endings} == {one.__name__ for one in DISTURBANCES}
