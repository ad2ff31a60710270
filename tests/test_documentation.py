"""What the texts say exists."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SOURCES = [
    path
    for name in ("cosim", "controllers", "analysis", "sumo_scenarios")
    for path in (ROOT / name).rglob("*.py")
]
PAGES = (
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "docs/architecture.md",
    "docs/conventions.md",
    "docs/references.md",
)
CITATION = re.compile(r"\[([A-Z][A-Za-z]*[A-Za-z0-9.-]*)\]_")
ENTRY = re.compile(r"^[-*]?\s*\*{0,2}\[([^\]]+)\]", re.MULTILINE)


def test_every_cited_key_has_an_entry_in_the_references() -> None:
    entries = set(ENTRY.findall((ROOT / "docs/references.md").read_text()))
    cited = {key: path for path in SOURCES for key in CITATION.findall(path.read_text())}
    missing = {key: str(path.relative_to(ROOT)) for key, path in cited.items() if key not in entries}
    assert not missing, f"not in docs/references.md: {missing}"


@pytest.mark.parametrize("name", PAGES)
def test_links_between_the_texts_lead_somewhere(name: str) -> None:
    page = ROOT / name
    for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text()):
        assert (page.parent / target).exists(), f"{name} links to {target}, which does not exist"
