"""Pages that list something list all of it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cosim.cli.command_line import app
from cosim.conformance.suite import cases
from cosim.inspection.inspection import inspect
from sumo_scenarios import library
from sumo_scenarios.sumo_installation import packaged_file
from tests.cosim.inspection.test_findings import BRAUNSCHWEIG
from tests.documentation.command_blocks import ROOT

MISHAPS = (
    "n_teleports",
    "n_routes_restored",
    "n_steps_off_the_way",
    "egos_given_up",
    "cars_not_taken",
    "egos_on_detours",
    "n_others_teleported",
    "solvers",
)


def test_every_conformance_case_has_a_row() -> None:
    page = (ROOT / "docs/coupling.md").read_text("utf-8")
    assert [case.key for case in cases() if f"\n| {case.key} |" not in page] == []


def test_every_command_has_a_row() -> None:
    page = (ROOT / "docs/commands.md").read_text("utf-8")
    names = [command.name for command in app.registered_commands if not command.hidden]
    assert [name for name in names if f"\n| `{name}` |" not in page] == []


def test_every_built_in_scenario_has_a_row() -> None:
    page = (ROOT / "docs/scenarios.md").read_text("utf-8")
    assert [name for name in library.names() if f"\n| `{name}` |" not in page] == []


def test_every_check_of_inspect_is_explained() -> None:
    page = (ROOT / "docs/inspect.md").read_text("utf-8")
    heads = [line.split("|")[1] for line in page.splitlines() if line.startswith("| ")]
    explained = {name.strip() for head in heads for name in head.split(",")}
    assert {finding.check for finding in inspect(packaged_file(BRAUNSCHWEIG)).findings} <= explained


@pytest.mark.parametrize("key", MISHAPS)
def test_what_a_run_says_of_itself_is_explained(key: str) -> None:
    assert f"`{key}`" in (ROOT / "docs/architecture.md").read_text("utf-8")


SPELLED_OUT = {
    "TTC": "time to collision",
    "PET": "post-encroachment time",
    "DRAC": "deceleration rate to avoid",
}


@pytest.mark.parametrize("page", [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))])
def test_a_page_spells_an_abbreviation_out_where_it_first_uses_it(page: Path) -> None:
    text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text("utf-8"), flags=re.DOTALL)
    for short, long in SPELLED_OUT.items():
        first = re.search(rf"\b{short}\b", text)
        before = "" if first is None else " ".join(text[: first.end() + 60].lower().split())
        assert first is None or long in before, short


def test_the_first_page_of_the_documentation_leads_to_every_other_one() -> None:
    folder = ROOT / "docs"
    named = set(re.findall(r"\]\(([\w-]+\.md)", (folder / "index.md").read_text("utf-8")))
    assert named == {path.name for path in folder.glob("*.md")} - {"index.md"}
