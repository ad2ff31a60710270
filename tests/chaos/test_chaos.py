"""A round of chaos of each kind; ``make chaos`` runs many."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.chaos.disturbances import DISTURBANCES
from tests.chaos.rounds import Chaos

SEED = 1


@pytest.mark.slow
@pytest.mark.sumo
def test_a_disturbed_batch_is_finished_like_an_undisturbed_one(tmp_path: Path) -> None:
    result = Chaos(tmp_path, SEED).run(len(DISTURBANCES))
    assert result.wrong == []
    assert {kind for kind, _ in result.endings} == {one.__name__ for one in DISTURBANCES}
