"""One network cache for all tests of a session."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(autouse=True)
def network_cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    cache = tmp_path_factory.getbasetemp() / "networks"
    monkeypatch.setenv("COSIM_CACHE_DIR", str(cache))
    return cache
