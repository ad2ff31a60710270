"""JSON schemas of the files that users write, generated from the models that read them.

``python -m cosim.checks.schemas docs/schemas`` writes them all.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from analysis.criteria.json_schema import criterion_schema
from analysis.files import json_text
from cosim.batches.study import StudyTable
from sumo_scenarios.schema import ScenarioTable

DIALECT = "https://json-schema.org/draft/2020-12/schema"
MODELS: Mapping[str, type[BaseModel]] = {"scenario": ScenarioTable, "study": StudyTable}
NAMES = (*MODELS, "criteria")


def schema(name: str) -> dict[str, Any]:
    """Return the schema of ``scenario.toml``, of a study file, or of a file for ``--criteria``.

    Parameters
    ----------
    name : one of `NAMES`
    """
    criteria = {"type": "array", "items": criterion_schema()}
    if name == "criteria":
        found: dict[str, Any] = {
            "type": "object",
            "title": "Criteria",
            "additionalProperties": False,
            "required": ["criteria"],
            "properties": {"criteria": criteria},
        }
    else:
        found = MODELS[name].model_json_schema(by_alias=True)
        described = found["properties"]["criteria"].get("description", "")
        found["properties"]["criteria"] = {**criteria, "description": described}
    return {"$schema": DIALECT, **found}


def file_name(name: str) -> str:
    """Return the name of the file of a schema."""
    return f"{name}.schema.json"


def text(name: str) -> str:
    """Return the text of a schema file."""
    return json_text(schema(name))


if __name__ == "__main__":
    for each in NAMES:
        (Path(sys.argv[1]) / file_name(each)).write_text(text(each), encoding="utf-8", newline="\n")
