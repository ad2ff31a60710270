"""The documentation as a site: a warning is an error, every page is in the navigation, it needs no network."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page

from tests.browsers import started
from tests.documentation.command_blocks import ROOT

pytestmark = pytest.mark.long

LOADED = re.compile(
    r"<(?:script|img|iframe|source)\b[^>]*\bsrc=[\"']?([^\"'> ]+)"
    r"|<link\b(?=[^>]*\brel=[\"']?(?:stylesheet|icon|preconnect|preload))[^>]*\bhref=[\"']?([^\"'> ]+)"
)
"""What a page loads by itself, other than by a click."""


def build(source: Path, site: Path) -> subprocess.CompletedProcess[str]:
    """Build the site as ``make docs`` does."""
    return subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(site)],
        cwd=source,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        check=False,
    )


def sources(folder: Path) -> Path:
    """Return a copy of what the site is made of: the first page, and the headings of the other texts."""
    shutil.copytree(ROOT / "docs", folder / "docs", ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "benchmarks").mkdir()
    shutil.copy(ROOT / "mkdocs.yml", folder)
    texts = [str(path.relative_to(ROOT)) for path in (ROOT / "docs").glob("*.md") if path.stem != "index"]
    for name in (*texts, "CHANGELOG.md", "CONTRIBUTING.md", "benchmarks/results.md"):
        lines = (ROOT / name).read_text("utf-8").splitlines()
        (folder / name).write_text("\n\n".join(line for line in lines if line.startswith("#")), "utf-8")
    return folder


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("site")
    done = build(ROOT, place)
    assert done.returncode == 0, done.stdout + done.stderr
    return place


def test_every_text_is_a_page_and_leads_to_the_others_within_the_site(site: Path) -> None:
    texts = {path.stem for path in (ROOT / "docs").glob("*.md")}
    pages = {path.stem: path.read_text("utf-8") for path in site.glob("*.html")}
    assert texts | {"changelog", "contributing", "benchmarks"} == pages.keys() - {"404"}
    assert 'href="changelog.html"' in pages["conventions"]
    assert 'href="benchmarks.html"' in pages["performance"]
    assert 'href="architecture.html"' in pages["contributing"]
    assert not list(site.rglob("*.py"))


def test_no_page_loads_anything_from_a_network(site: Path) -> None:
    for page in site.rglob("*.html"):
        text = page.read_text("utf-8")
        loaded = [first or second for first, second in LOADED.findall(text)]
        assert loaded, page.name
        assert not [address for address in loaded if re.match(r"(\w+:)?//", address)], page.name
    for sheet in site.rglob("*.css"):
        assert not re.search(r"url\([\"']?(https?:)?//|@import", sheet.read_text("utf-8")), sheet.name


def test_reasons_of_commands_that_are_not_run_are_not_shown(site: Path) -> None:
    text = (site / "plots.html").read_text("utf-8")
    assert "--gui" in text
    assert "no-run" not in re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)


def test_each_kind_of_mistake_fails_the_build(tmp_path: Path) -> None:
    mistakes = {
        "gone.md": "[gone](gone.md)",
        "no-such-heading": "[gone](metrics.md#no-such-heading)",
        "gone.toml": "[gone](../studies/gone.toml)",
        "gone.png": "![gone](images/gone.png)",
    }
    folder = sources(tmp_path / "copy")
    with (folder / "docs/index.md").open("a", encoding="utf-8") as file:
        file.write("\n\n".join(["", *mistakes.values()]))
    (folder / "docs/lonely.md").write_text("# In no navigation\n")
    done = build(folder, tmp_path / "site")
    assert done.returncode != 0
    warnings = [line for line in done.stderr.splitlines() if "WARNING" in line or line.startswith("  -")]
    for words in (*mistakes, "lonely.md"):
        assert any(words in line for line in warnings), f"{words}: {done.stderr}"
    assert "5 warnings" in done.stderr + done.stdout


@pytest.fixture
def page() -> Iterator[Page]:
    with started() as browser:
        yield browser.new_page()


@pytest.mark.browser
def test_the_site_is_read_and_searched_from_disk(site: Path, page: Page) -> None:
    said: list[str] = []
    page.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
    page.on("pageerror", lambda error: said.append(f"error: {error}"))
    page.on("request", lambda request: said.append(request.url) if request.url[:5] != "file:" else None)
    page.goto((site / "index.html").as_uri())
    page.get_by_role("link", name="Quick start").first.click()
    page.wait_for_url("**/quick-start.html")
    page.keyboard.press("/")
    page.keyboard.type("netgenerate")
    result = page.locator(".md-search-result__link").first
    result.wait_for()
    assert "own-network.html" in str(result.get_attribute("href"))
    assert said == []
