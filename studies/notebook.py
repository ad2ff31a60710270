"""Executes docs/first-runs.ipynb and writes it as a page with its pictures.

``python -m studies.notebook docs`` writes docs/notebook.md and docs/images/notebook-*.png.
"""

from __future__ import annotations

import base64
import re
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import nbformat
from nbclient import NotebookClient

from analysis.files import completing, write_text

SOURCE = "first-runs.ipynb"
PAGE = "notebook.md"
_HEAD = """# A notebook

This page is a notebook as it was executed by `python -m studies.notebook docs`; download it: \
[first-runs.ipynb](first-runs.ipynb). It needs `pip install '.[report]' jupyter`. \
[Use it from Python](python.md) explains the functions.
"""


def read(notebook: Path) -> Any:
    """Return a notebook."""
    return nbformat.read(notebook, as_version=4)  # type: ignore[no-untyped-call]  # it has no annotations


def executed(notebook: Path) -> Any:
    """Return a notebook after running all of its cells in an empty folder; an error in a cell is raised."""
    content = read(notebook)
    with TemporaryDirectory() as folder:
        NotebookClient(content, timeout=300, resources={"metadata": {"path": folder}}).execute()
    return content


def page_of(notebook: Any) -> tuple[str, dict[str, bytes]]:
    """Return an executed notebook as Markdown, and its pictures by file name."""
    parts, pictures = [_HEAD], dict[str, bytes]()
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```py\n{cell.source}\n```")
        for output in cell.outputs:
            parts += _output(output, pictures)
    return "\n\n".join(part.strip() for part in parts) + "\n", pictures


def _output(output: Any, pictures: dict[str, bytes]) -> list[str]:
    if output.output_type == "stream":
        return [f"```text\n{output.text.rstrip()}\n```"]
    data = output.data
    if "image/png" in data:
        name = f"notebook-{len(pictures) + 1}.png"
        pictures[name] = base64.b64decode(data["image/png"])
        return [f"![Figure {len(pictures)} of the notebook](images/{name})"]
    if "text/html" in data:
        # Styles of the notebook's frontend have no effect on the page; a blank line would end the HTML.
        text = re.sub(r"<style.*?</style>", "", data["text/html"], flags=re.DOTALL)
        return [re.sub(r"\n\s*\n", "\n", text)]
    return [f"```text\n{data['text/plain'].rstrip()}\n```"]


def main(docs: Path) -> None:
    """Write the page and its pictures."""
    text, pictures = page_of(executed(docs / SOURCE))
    for name, content in pictures.items():
        with completing(docs / "images" / name) as part:
            part.write_bytes(content)
    write_text(docs / PAGE, text)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
