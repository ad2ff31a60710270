"""sumo-gui on a screen of its own: egos are coloured and plans drawn, and the run stays what it is."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from cosim.cli import main
from cosim.errors import InputError
from cosim.sumo import connection
from cosim.sumo.window import EGO, PLAN

ROOT = Path(__file__).resolve().parents[3]
SCREEN = ["xvfb-run", "--auto-servernum", "--server-args=-screen 0 1280x800x24"]

needs_screen = pytest.mark.skipif(
    shutil.which("xvfb-run") is None or shutil.which("xauth") is None,
    reason="no xvfb-run: apt-get install xvfb xauth",
)


def on_a_screen(*arguments: str) -> None:
    """Run Python with these arguments on a screen of its own."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [*SCREEN, sys.executable, *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr


def has_colour(picture: np.ndarray, colour: tuple[int, int, int, int]) -> bool:
    """Return whether some pixel has that colour, apart from rounding."""
    return bool((np.abs(picture.astype(int) - np.array(colour[:3])).max(axis=2) <= 3).any())


@needs_screen
@pytest.mark.sumo
def test_the_window_shows_who_the_ego_is_and_what_it_plans(tmp_path: Path) -> None:
    on_a_screen(str(Path(__file__).with_name("window_session.py")), str(tmp_path / "seen.json"))
    seen = json.loads((tmp_path / "seen.json").read_text())
    assert seen["plans"] > 200
    assert seen["wrong"] == []
    assert seen["colours"] == [list(EGO)]
    assert seen["lines_without_ego"] == []
    with Image.open(tmp_path / "seen.png") as image:
        picture = np.asarray(image.convert("RGB"))
    assert has_colour(picture, EGO)
    assert has_colour(picture, PLAN)


@needs_screen
@pytest.mark.sumo
def test_a_run_in_the_window_has_the_same_bytes_as_one_without(tmp_path: Path) -> None:
    arguments = ["run", "midblock_zebra", "--set", "warmup_s=10", "--duration-s", "20"]
    on_a_screen("-m", "cosim.cli", *arguments, "--gui", "--out", str(tmp_path / "with"))
    assert main([*arguments, "--out", str(tmp_path / "without")]) == 0
    for name in ("egos.parquet", "neighbours.parquet", "plans.parquet", "map.json", "encounters.csv"):
        assert (tmp_path / "with" / name).read_bytes() == (tmp_path / "without" / name).read_bytes(), name


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="DISPLAY is Linux's way to name a screen")
def test_without_a_screen_the_window_is_refused_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)

    def loaded(module: str) -> None:
        raise AssertionError(f"{module} was loaded")

    monkeypatch.setattr(connection, "_load", loaded)
    with pytest.raises(InputError, match="DISPLAY is not set; without a screen: xvfb-run"):
        connection.start([], gui=True)
