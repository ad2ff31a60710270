"""Every script of ``make bench`` runs, says how each bar was met, and writes its part of the page."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "benchmarks"
QUICK = ("other_methods",)
"""The others take more than some seconds."""
SECTIONS = {"batch_throughput": "batch"}
"""Where a script's section has another name."""


def scripts() -> list[str]:
    """Return what ``make bench`` runs, in its order."""
    found = re.search(r"^BENCHMARKS := (.+)$", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert found
    return found[1].split()


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(FOLDER / arguments[0]), *arguments[1:]]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env=environment)


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder for the results of all scripts, each in one of its own."""
    return tmp_path_factory.mktemp("results")


@cache
def quick_run(script: str, out: Path) -> tuple[subprocess.CompletedProcess[str], Path]:
    """Run a script once, and return what it said and the folder that it wrote."""
    folder = out / script
    folder.mkdir()
    return run(f"{script}.py", "--quick", "--out", str(folder)), folder


@pytest.mark.long
@pytest.mark.sumo
@pytest.mark.parametrize(
    "script",
    [
        pytest.param(name, marks=() if name in QUICK else pytest.mark.slow)
        for name in scripts()
        if name != "bars"
    ],
)
def test_a_quick_run_prints_its_bars_and_writes_its_section(script: str, out: Path) -> None:
    if script == "instructions" and shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed")
    done, folder = quick_run(script, out)
    assert done.returncode == 0, done.stderr
    section = json.loads((folder / "results.json").read_text(encoding="utf-8"))[SECTIONS.get(script, script)]
    lines = [line for line in done.stdout.splitlines() if line.startswith("bar: ")]
    assert len(lines) == len(section["bars"])
    for line, bar in zip(lines, section["bars"], strict=True):
        assert bar["what"] in line
        assert re.search(r": (met|MISSED by \S+|too few pairs, \d+ expected)$", line)
    page = (folder / "results.md").read_text(encoding="utf-8")
    assert page.startswith("# Results of `make bench`")
    assert page.count("\n## ") >= 1 + bool(lines)


def test_bars_are_collected_from_all_sections_at_the_end() -> None:
    done = run("bars.py")
    assert done.returncode == 0, done.stderr
    everything = json.loads((FOLDER / "results.json").read_text(encoding="utf-8"))
    count = sum(len(section.get("bars", ())) for section in everything.values())
    missed = done.stdout.count(": MISSED by ")
    assert f"{count} bars, {missed} missed" in done.stdout
    assert done.stdout.count("bar: ") == count


@pytest.mark.long
@pytest.mark.skipif(importlib.util.find_spec("casadi") is None, reason="casadi is not installed")
def test_the_non_linear_program_has_our_optimum(out: Path) -> None:
    done, folder = quick_run("other_methods", out)
    assert done.returncode == 0, done.stderr
    found = json.loads((folder / "results.json").read_text(encoding="utf-8"))["other_methods"]
    # The quick run's eight plans; none may have been given up.
    assert found["agreement"]["compared"] == 8
    assert found["ipopt_unsolved"] == 0
    assert found["agreement"]["speed_mps"] < 0.01
    assert found["agreement"]["steering_rad"] < 1e-4
    assert found["agreement"]["cost_relative"] < 1e-4


@pytest.mark.long
def test_a_method_that_is_not_installed_is_skipped_in_one_line(tmp_path: Path) -> None:
    # Imported first: what the script itself needs has to be found.
    code = (
        f"import importlib.util, sys; sys.path.insert(0, {str(FOLDER)!r}); import other_methods\n"
        "importlib.util.find_spec = lambda name, package=None: None\n"
        f"sys.argv = ['other_methods.py', '--quick', '--out', {str(tmp_path)!r}]\n"
        "other_methods.main()\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [
        "skipped: CasADi/IPOPT, as casadi is not installed (extra `bench`)",
        "skipped: pymoo GA, as pymoo is not installed (extra `bench`)",
    ]
    assert not list(tmp_path.iterdir())


def test_what_earlier_code_measured_and_this_cannot_show_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "results.json").write_text('{"memory": {"bars": [], "of old": 1}}', encoding="utf-8")
    counted = {"case": "30/5", "first": 10, "steps": 5, "counts": {"osqp": 2e6}}
    lines = (
        "from pathlib import Path",
        "from measuring import results",
        f"results.publish('instructions', {counted}, (), Path({str(tmp_path)!r}))",
    )
    command = [sys.executable, "-c", "; ".join(lines)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=FOLDER)
    assert done.returncode == 0, done.stderr
    everything = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    assert "memory" not in everything
    assert "## Instructions" in (tmp_path / "results.md").read_text(encoding="utf-8")
