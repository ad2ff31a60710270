"""The recipes of CONTRIBUTING.md for a scenario and a recorded column, followed literally in a copy."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from tests.documentation.command_blocks import ROOT

pytestmark = pytest.mark.long

PACKAGES = ("cosim", "controllers", "analysis", "sumo_scenarios", "studies", "tests")
FILE = re.compile(r"^`([\w.]+)`[^\n]*:\n\n```\w+\n(.*?)^```$", re.DOTALL | re.MULTILINE)
LINE = re.compile(
    r"^Below the \w+ of `(\w+)` in the \w+ `(\w+)` of `([^`]+)`[^\n]*:\n\n```text\n(.*?)^```$",
    re.DOTALL | re.MULTILINE,
)


def section(title: str) -> str:
    """Return a section of CONTRIBUTING.md."""
    return (ROOT / "CONTRIBUTING.md").read_text("utf-8").partition(f"## {title}\n")[2].partition("\n## ")[0]


def insert(project: Path, recipe: str) -> None:
    """Insert the line that a recipe gives below the one that it names."""
    ((name, variable, file, new),) = LINE.findall(recipe)
    lines = (project / file).read_text("utf-8").splitlines(keepends=True)
    top = next(number for number, line in enumerate(lines) if line.startswith(f"{variable} = "))
    place = next(number for number in range(top, len(lines)) if f'"{name}",' in lines[number])
    indent = lines[place][: -len(lines[place].lstrip())]
    lines.insert(place + 1, indent + new)
    (project / file).write_text("".join(lines), "utf-8")


def succeeds(project: Path, *command: str) -> str:
    """Run a command in the copy and return what it prints."""
    done = subprocess.run(
        command,
        cwd=project,
        env={**os.environ, "PYTHONPATH": str(project), "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def module(project: Path, name: str, *arguments: str) -> str:
    """Run a module of the copy."""
    return succeeds(project, sys.executable, "-m", name, *arguments)


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of this project after both recipes."""
    copy = tmp_path_factory.mktemp("recipes")
    for name in PACKAGES:
        shutil.copytree(ROOT / name, copy / name)  # with the bytecode, which takes seconds to be made again
    for name in ("pyproject.toml", "docs/metrics.md"):
        (copy / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, copy / name)
    recipe = section("Add a scenario")
    (folder,) = re.findall(r"`(sumo_scenarios/\w+)/`", recipe)
    (copy / folder).mkdir()
    for name, content in FILE.findall(recipe):
        (copy / folder / name).write_text(content, "utf-8")
    insert(copy, recipe)
    recipe = section("Add a recorded column")
    insert(copy, recipe)
    ((page, out),) = re.findall(r"`python -m ([\w.]+) (\S+)`", recipe)
    module(copy, page, out)
    return copy


def test_the_new_scenario_is_listed(project: Path) -> None:
    listed = module(project, "cosim.cli", "list", "scenarios")
    assert re.search(r"quiet_street .*Street of 200 m with one zebra crossing", listed)


@pytest.mark.sumo
def test_the_new_scenario_runs_and_the_new_column_is_recorded(project: Path, tmp_path: Path) -> None:
    run = ("run", "quiet_street", "--controller", "aeb", "--duration-s", "5")
    module(project, "cosim.cli", *run, "--out", str(tmp_path / "run"))
    egos = pq.read_table(tmp_path / "run/egos.parquet")
    assert egos["time_s"].to_pylist()[-1] == pytest.approx(5.0)
    # Length 4.5 m, of which 0.95 m are behind the rear axle.
    assert egos["front_m"].to_pylist() == pytest.approx([3.55] * len(egos))
    assert pq.read_metadata(tmp_path / "run/neighbours.parquet").num_rows > 0


def test_the_new_column_has_its_unit_and_meaning_on_the_page_of_metrics(project: Path) -> None:
    page = (project / "docs/metrics.md").read_text("utf-8").partition("## egos.parquet")[2]
    (row,) = [line for line in page.splitlines() if line.startswith("| `front_m` ")]
    cells = [cell.strip() for cell in row.split("|")]
    assert "m" in cells
    assert "distance from the rear axle to the front bumper" in cells


def test_the_copy_passes_the_linters(project: Path) -> None:
    tools = Path(sys.executable).parent
    succeeds(project, str(tools / "ruff"), "check", "--no-cache", ".")
    succeeds(project, str(tools / "ruff"), "format", "--no-cache", "--check", ".")
    succeeds(project, str(tools / "lint-imports"), "--no-cache")


@pytest.mark.sumo
def test_the_copy_passes_the_tests_of_scenarios_and_recordings(project: Path) -> None:
    files = (
        "tests/sumo_scenarios/test_library.py",
        "tests/sumo_scenarios/test_in_sumo.py::test_vehicles_move_and_pedestrians_cross[quiet_street]",
        "tests/cosim/recording/test_recorder.py",
        "tests/analysis/results/test_files.py::test_the_metrics_page_is_current",
    )
    said = module(project, "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *files)
    assert re.search(r"\d+ passed", said)
    assert "skipped" not in said
