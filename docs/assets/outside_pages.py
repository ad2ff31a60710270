"""Takes texts from outside this folder into the site, so that links to them work there and on a git host.

A hook of mkdocs (``mkdocs.yml``).
"""

from __future__ import annotations

import os.path
import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

OUTSIDE = {
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "benchmarks/results.md": "benchmarks.md",
}
LINK = re.compile(r"\]\(([^)#:\s]+)")


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the texts to the pages."""
    for source, page in OUTSIDE.items():
        text = (Path(config.config_file_path).parent / source).read_text(encoding="utf-8")
        files.append(File.generated(config, page, content=text))
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let links between the two sides lead to the pages of the site."""
    places = {name: source for source, name in OUTSIDE.items()}
    here = places.get(page.file.src_uri, f"docs/{page.file.src_uri}")

    def in_site(found: re.Match[str]) -> str:
        target = os.path.normpath(os.path.join(os.path.dirname(here), found[1]))
        return f"]({OUTSIDE.get(target, target.removeprefix('docs/'))}"

    return LINK.sub(in_site, markdown)
