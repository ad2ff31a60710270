"""The Python blocks of the pages are programs: one after the other, in one process, in an empty folder."""

from __future__ import annotations

import json
import os
import re
import runpy
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from studies import notebook
from tests.documentation.command_blocks import ROOT, fences

SHORTER: Mapping[str, Mapping[str, str]] = {
    # So many pedestrians that an ego meets some of them at the first crossing.
    "docs/python.md": {
        "duration_s=40, warmup_s=20": "duration_s=22, warmup_s=10, pedestrians_per_hour=900",
        '"duration_s": 40, "warmup_s": 20': '"duration_s": 22, "warmup_s": 10, "pedestrians_per_hour": 900',
        '"duration_s": 30.0, "warmup_s": 10.0': '"duration_s": 8.0, "warmup_s": 2.0',
        # Two runs, for two processes.
        '"seeds": "1-2"': '"seeds": "1"',
    },
    "docs/gymnasium.md": {
        "time_limit_s=10.0, ": "time_limit_s=10.0, warmup_s=10.0, ",
        "time_limit_s=5.0)": "time_limit_s=5.0, warmup_s=5.0)",
    },
    # So long that an ego has met somebody.
    "docs/openscenario.md": {
        "duration_s=60, warmup_s=20": "duration_s=22, warmup_s=10, pedestrians_per_hour=900"
    },
}
"""What a page simulates, and what its test does: texts, which have to be there, and what takes their place."""
OF_A_PROCESS = ("docs/gymnasium.md",)
"""Pages with blocks that have to be the main program of a process: other processes import it."""
LONG, BRIEF = (
    '"duration_s": 60, "warmup_s": 20',
    '"duration_s": 22, "warmup_s": 10, "pedestrians_per_hour": 900',
)
"""The same of the notebook."""
CODE = re.compile(r"^```py\n.*?^```", re.DOTALL | re.MULTILINE)


@pytest.mark.long
@pytest.mark.sumo
@pytest.mark.parametrize("page", SHORTER)
def test_the_blocks_of_a_page_run_one_after_the_other(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    blocks = fences(page, "python")
    assert blocks
    code = "\n".join(blocks)
    for long, brief in SHORTER[page].items():
        assert long in code, f"{page} no longer says {long}"
        code = code.replace(long, brief)
    program = tmp_path / "page.py"
    program.write_text(code, "utf-8")
    if page not in OF_A_PROCESS:
        monkeypatch.chdir(tmp_path)
        runpy.run_path(str(program), run_name="__main__")
        return
    done = subprocess.run(
        [sys.executable, "-W", "error", str(program)],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT), "MPLBACKEND": "agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_page_of_the_notebook_is_of_its_cells() -> None:
    text, _ = notebook.page_of(notebook.read(ROOT / "docs" / notebook.SOURCE))
    page = (ROOT / "docs" / notebook.PAGE).read_text("utf-8")
    assert CODE.findall(page) == CODE.findall(text) != []


@pytest.mark.slow
@pytest.mark.sumo
def test_the_notebook_runs_and_gives_its_page(tmp_path: Path) -> None:
    source = (ROOT / "docs" / notebook.SOURCE).read_text("utf-8")
    long, brief = (json.dumps(text)[1:-1] for text in (LONG, BRIEF))  # as within a file of JSON
    assert long in source
    shorter = tmp_path / notebook.SOURCE
    shorter.write_text(source.replace(long, brief), "utf-8")
    executed, pictures = notebook.page_of(notebook.executed(shorter))
    text = executed.replace(BRIEF, LONG)
    page = (ROOT / "docs" / notebook.PAGE).read_text("utf-8")
    assert CODE.findall(page) == CODE.findall(text)
    assert re.findall(r"!\[.*", page) == re.findall(r"!\[.*", text)
    assert len(pictures) == 1
    for name, content in pictures.items():
        assert content[:4] == b"\x89PNG"
        assert (ROOT / "docs/images" / name).is_file()
    assert "against aeb" in page


def test_the_notebook_is_short_and_committed_without_outputs() -> None:
    cells = [one for one in notebook.read(ROOT / "docs" / notebook.SOURCE).cells if one.cell_type == "code"]
    assert sum(len(one.source.splitlines()) for one in cells) <= 10
    assert not any(one.outputs for one in cells)
