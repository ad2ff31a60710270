"""Every gate of ``make check`` and ``make test`` can fail."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("cosim", "controllers", "analysis", "sumo_scenarios", "studies")

# File to write, and the contract of pyproject.toml that it breaks.
VIOLATIONS = {
    "nobody knows cosim": ("controllers/intruder.py", "import cosim.errors\n"),
    "nobody imports a study": ("analysis/intruder.py", "import studies.zoo\n"),
    "only cosim.sumo talks to SUMO": ("cosim/cli/intruder.py", "import libsumo\n"),
    "a floor knows only those below it": ("cosim/batches/intruder.py", "import cosim.checks\n"),
    "load no SUMO": ("cosim/step/world.py", "import traci\n"),
    "name the SUMO world": ("cosim/cli/second_intruder.py", "import cosim.sumo.first\n"),
    "name the catalogue": ("cosim/cli/third_intruder.py", "import controllers.catalog\n"),
    "walk by no model of a controller": (
        "cosim/pedestrians/intruder.py",
        "import controllers.strategies.first\n",
    ),
    "reached through the catalogue": ("cosim/running/compose.py", "import controllers.strategies.first\n"),
    "controllers are independent": (
        "controllers/strategies/second.py",
        "import controllers.strategies.first\n",
    ),
    "rooms of controllers": ("controllers/geometry/__init__.py", "import controllers.driving\n"),
    "formulations of the velocity-obstacle method": (
        "controllers/velocity_obstacle/paper/__init__.py",
        "import controllers.velocity_obstacle.mpc\n",
    ),
    "arithmetic know arrays only": (
        "controllers/velocity_obstacle/mpc/arithmetic/first.py",
        "import controllers.interface\n",
    ),
    "the optimisation room knows a solver": ("controllers/safety/__init__.py", "import qpsolvers\n"),
    "rooms of analysis": ("analysis/recording/first.py", "import analysis.encounters\n"),
    "metrics are independent": ("analysis/metrics/second.py", "import analysis.metrics.first\n"),
}
CLEAN = (
    "cosim/step/loop.py",
    "cosim/recording/first.py",
    "cosim/running/compose.py",
    "cosim/running/inventory.py",
    "cosim/step/world.py",
    "cosim/sumo/first.py",
    "studies/papers/__init__.py",
    "studies/zoo/__init__.py",
    "sumo_scenarios/__init__.py",
    "controllers/strategies/first.py",
    "controllers/strategies/second.py",
    "controllers/velocity_obstacle/mpc/arithmetic/first.py",
    "analysis/recording/first.py",
    "analysis/metrics/first.py",
    "analysis/metrics/second.py",
)
"""What the contracts and the violations name, beside the rooms."""


def skeleton(folder: Path) -> Path:
    """Return a small project with the walls of this one."""
    shutil.copy(ROOT / "pyproject.toml", folder)
    for name in (*CLEAN, *(f"{room}/__init__.py" for room in rooms())):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")
        for parent in path.relative_to(folder).parents[:-1]:
            (folder / parent / "__init__.py").touch()
    return folder


def rooms() -> list[str]:
    """Return the rooms that the contracts place on floors."""
    config = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    return [
        f"{container.replace('.', '/')}/{room.strip()}"
        for contract in config["tool"]["importlinter"]["contracts"]
        for container in contract.get("containers", ())
        for floor in contract["layers"]
        for room in floor.split("|")
    ]


def lint_imports(folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [Path(sys.executable).parent / "lint-imports", "--no-cache"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(folder), "COLUMNS": "200"},
    )


@pytest.mark.long
def test_the_walls_hold_in_a_clean_project_and_each_of_them_can_break(tmp_path: Path) -> None:
    project = skeleton(tmp_path)
    clean = lint_imports(project)
    assert clean.returncode == 0, clean.stdout + clean.stderr
    for name, text in VIOLATIONS.values():
        (project / name).write_text(text)
    broken = lint_imports(project)
    assert broken.returncode != 0
    for words in VIOLATIONS:
        assert re.search(rf"{words}.* BROKEN", broken.stdout), f"{words}\n{broken.stdout}"


def test_every_wall_has_a_violation_that_breaks_it() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    names = [contract["name"] for contract in settings["tool"]["importlinter"]["contracts"]]
    assert len(names) == len(VIOLATIONS)
    assert all(any(words in name for words in VIOLATIONS) for name in names)


OPEN = (
    "cosim/__init__.py",  # the public names, loaded at their first use
    "cosim/cli/__init__.py",  # the command `cosim` is installed by this name: `cosim.cli:main`
    "cosim/gym/__init__.py",  # importing it registers the environments
)
PLAIN = [
    path
    for name in PACKAGES
    for path in (ROOT / name).rglob("__init__.py")
    if path.relative_to(ROOT).as_posix() not in OPEN
]


@pytest.mark.parametrize("path", PLAIN)
def test_a_package_holds_a_docstring_and_nothing_else(path: Path) -> None:
    body = ast.parse(path.read_text()).body
    assert len(body) == 1, f"{path.relative_to(ROOT)} should hold a docstring only"
    assert isinstance(body[0], ast.Expr)
    assert isinstance(body[0].value, ast.Constant)


def test_ruff_refuses_an_unused_import_and_a_bad_layout(tmp_path: Path) -> None:
    bad = tmp_path / "bad.py"
    bad.write_text("import os\nx = [1,2]\n")
    settings = str(ROOT / "pyproject.toml")
    ruff = str(Path(sys.executable).parent / "ruff")
    for arguments in (["check"], ["format", "--check"]):
        command = [ruff, *arguments, "--no-cache", "--config", settings, str(bad)]
        assert subprocess.run(command, capture_output=True, check=False).returncode == 1


@pytest.mark.long
def test_mypy_refuses_a_function_without_types(tmp_path: Path) -> None:
    bad = tmp_path / "bad.py"
    bad.write_text("def double(x):\n    return 2 * x\n")
    command = [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "pyproject.toml"), str(bad)]
    result = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert result.returncode == 1
    assert "no-untyped-def" in result.stdout


@pytest.mark.long
def test_pytest_treats_a_warning_as_an_error(tmp_path: Path) -> None:
    bad = tmp_path / "test_bad.py"
    bad.write_text("import warnings\n\n\ndef test_warns():\n    warnings.warn('old', stacklevel=1)\n")
    options = ["-c", str(ROOT / "pyproject.toml"), "--rootdir", str(tmp_path), "-p", "no:cacheprovider"]
    command = [sys.executable, "-m", "pytest", "-q", *options, str(bad)]
    result = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert result.returncode == 1
    assert "UserWarning: old" in result.stdout


LONGEST = 80
"""Lines of a function, with its signature and its docstring."""


def too_long(source: str) -> list[str]:
    """Return the functions of a module that are longer."""
    return [
        f"{node.name}: {(node.end_lineno or node.lineno) - node.lineno + 1} lines"
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and (node.end_lineno or node.lineno) - node.lineno >= LONGEST
    ]


def test_a_function_of_one_line_more_is_too_long() -> None:
    body = "    pass\n" * (LONGEST - 1)
    assert too_long(f"def ends_in_time():\n{body}") == []
    assert too_long(f"def goes_on():\n{body}    pass\n") == [f"goes_on: {LONGEST + 1} lines"]


@pytest.mark.parametrize("package", [*PACKAGES, "benchmarks", "tests"])
def test_no_function_is_longer_than_what_is_read_at_a_glance(package: str) -> None:
    found = {
        f"{path.relative_to(ROOT)}: {one}"
        for path in sorted((ROOT / package).rglob("*.py"))
        for one in too_long(path.read_text("utf-8"))
    }
    assert not found
