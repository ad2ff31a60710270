"""What a release consists of: citation, schemas, package data, install lines."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml  # type: ignore[import-untyped]  # it has no annotations

from cosim.checks import scenario_page, schemas
from sumo_scenarios.schema import ScenarioTable

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
FILES = {
    "scenario": sorted(ROOT.glob("sumo_scenarios/*/scenario.toml")),
    "study": sorted(
        path for path in ROOT.glob("studies/**/*.toml") if "seeds" in tomllib.loads(path.read_text("utf-8"))
    ),
}


def test_the_citation_is_valid_and_of_this_version() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    schema = json.loads((ROOT / "tests/data/cff-1.2.0.schema.json").read_text("utf-8"))
    jsonschema.Draft7Validator(schema).validate(citation)
    assert citation["version"] == PROJECT["version"]
    assert citation["title"] == PROJECT["name"]
    references = (ROOT / "docs/references.md").read_text("utf-8")
    for one in citation["references"]:
        (key,) = re.findall(r"cited as (\w+)", one["notes"])
        assert f"**[{key}]**" in references
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.Draft7Validator(schema).validate({**citation, "authors": []})


@pytest.mark.parametrize("name", schemas.NAMES)
def test_the_schemas_in_the_documentation_are_current(name: str) -> None:
    there = (ROOT / "docs/schemas" / schemas.file_name(name)).read_text("utf-8")
    assert there == schemas.text(name), "python -m cosim.checks.schemas docs/schemas writes it"
    jsonschema.Draft202012Validator.check_schema(schemas.schema(name))


def test_the_page_of_scenario_files_is_current() -> None:
    there = (ROOT / "docs/scenario-files.md").read_text("utf-8")
    assert there == scenario_page.render(), "python -m cosim.checks.scenario_page docs/scenario-files.md"


@pytest.mark.parametrize(
    ("kind", "path"),
    [(kind, path) for kind, paths in FILES.items() for path in paths],
    ids=lambda value: value if isinstance(value, str) else value.parent.name,
)
def test_built_in_files_name_their_schema_and_fit_it(kind: str, path: Path) -> None:
    text = path.read_text("utf-8")
    first = text.partition("\n")[0]
    assert first.startswith("#:schema ")
    assert (path.parent / first.removeprefix("#:schema ")).resolve() == (
        ROOT / "docs/schemas" / schemas.file_name(kind)
    )
    jsonschema.Draft202012Validator(schemas.schema(kind)).validate(tomllib.loads(text))


@pytest.mark.parametrize(
    "wrong",
    [
        {"duraton_s": 3.0},
        {"duration_s": -1},
        {"actuation": "fly"},
        {"egos": {"share": 2.0}},
        {"criteria": [{"scope": "run", "metric": "n_collision", "operator": "==", "threshold": 0}]},
        {"criteria": [{"scope": "run", "metric": "n_collisions", "operator": "="}]},
    ],
)
def test_a_schema_refuses_what_the_reader_refuses(wrong: dict[str, Any]) -> None:
    good = {"description": "a", "duration_s": 60.0, "sumocfg": "town.sumocfg"}
    validator = jsonschema.Draft202012Validator(schemas.schema("scenario"))
    assert validator.is_valid(good)
    assert not validator.is_valid(good | wrong)


@pytest.mark.parametrize("name", schemas.MODELS)
def test_every_key_of_a_file_has_a_meaning(name: str) -> None:
    found = schemas.schema(name)
    for model in (found, *found.get("$defs", {}).values()):
        assert [key for key, one in model["properties"].items() if not one.get("description")] == []
    assert set(ScenarioTable.model_fields) == set(schemas.schema("scenario")["properties"])


def test_no_text_names_a_package_index_that_has_no_sumo_cosim() -> None:
    texts = [
        *ROOT.glob("*.md"),
        *ROOT.glob("docs/*.md"),
        *(path for name in ("cosim", "controllers", "analysis") for path in ROOT.glob(f"{name}/**/*.py")),
    ]
    wrong = [
        str(path.relative_to(ROOT))
        for path in texts
        if re.search(r"pip install[^\n]*sumo-cosim", path.read_text("utf-8"))
    ]
    assert wrong == []


def test_the_packages_say_that_they_are_typed() -> None:
    for name in ("cosim", "controllers", "analysis", "sumo_scenarios"):
        assert (ROOT / name / "py.typed").is_file()
