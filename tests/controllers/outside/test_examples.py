"""The programs of docs/outside-controllers.md drive, where Node.js or a compiler is installed."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

import cosim
from tests.documentation.command_blocks import fences

pytestmark = [pytest.mark.sumo, pytest.mark.long]
PAGE = "docs/outside-controllers.md"


def drives(controller: str, folder: Path) -> None:
    settings = {"duration_s": 25.0, "warmup_s": 15.0, "ego_count": 1, "pedestrians_per_hour": 900.0}
    ran = cosim.run(
        "midblock_zebra",
        controller=controller,
        out=folder / "run",
        deadline_ms=5000.0,
        patience_s=20.0,
        **settings,  # type: ignore[arg-type]  # parameters of the scenario
    )
    assert ran.valid, ran.invalid_reason
    assert ran.numbers["n_solver_fail"] == 0
    speed = ran.egos["speed_mps"]
    assert speed.max() > 5.0
    assert ran.egos["commanded_acceleration_mps2"].nunique() > 5  # it was the program that drove


def test_the_example_in_javascript_drives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if shutil.which("node") is None:
        pytest.skip("Node.js is not installed")
    monkeypatch.chdir(tmp_path)
    (code,) = fences(PAGE, "js")
    Path("drive.js").write_text(code)
    drives("process:node drive.js", tmp_path)


def test_the_example_in_cpp_drives(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compiler = shutil.which("g++") or shutil.which("clang++")
    if compiler is None:
        pytest.skip("no C++ compiler is installed")
    monkeypatch.chdir(tmp_path)
    (code,) = fences(PAGE, "cpp")
    Path("my_controller.cpp").write_text(code)
    subprocess.run(
        [compiler, "-Wall", "-Werror", "-O2", "-o", "my_controller", "my_controller.cpp"], check=True
    )
    drives("process:./my_controller", tmp_path)
