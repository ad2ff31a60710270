"""The Python blocks of the pages are programs: one after the other, in one process, in an empty folder."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from studies import notebook
from tests.documentation.command_blocks import ROOT, fences

PAGES = ("docs/python.md", "docs/gymnasium.md", "docs/openscenario.md")


@pytest.mark.sumo
@pytest.mark.parametrize("page", PAGES)
def test_the_blocks_of_a_page_run_one_after_the_other(page: str, tmp_path: Path) -> None:
    blocks = fences(page, "python")
    assert blocks
    program = tmp_path / "page.py"
    program.write_text("\n".join(blocks), "utf-8")
    done = subprocess.run(
        [sys.executable, "-W", "error", str(program)],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT), "MPLBACKEND": "agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.sumo
def test_the_notebook_runs_and_its_page_is_of_the_same_cells() -> None:
    source = ROOT / "docs" / notebook.SOURCE
    text, pictures = notebook.page_of(notebook.executed(source))
    page = (ROOT / "docs" / notebook.PAGE).read_text("utf-8")
    code = re.compile(r"^```py\n.*?^```", re.DOTALL | re.MULTILINE)
    assert code.findall(page) == code.findall(text)
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
