"""The data dictionary: a Frictionless Data Package that describes the CSV files."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from analysis.files import harmless
from analysis.tables.column import Column, Table


def describe(tables: Sequence[Table], title: str) -> dict[str, Any]:
    """Return the content of datapackage.json."""
    return {
        "name": "sumo-cosim-report",
        "title": f"Safety report of {title}",
        "description": "Texts that a spreadsheet would take for a formula begin with an apostrophe; "
        "so do those that begin with one already, with a second one.",
        "profile": "tabular-data-package",
        "resources": [_resource(table, tables) for table in tables],
    }


def _resource(table: Table, tables: Sequence[Table]) -> dict[str, Any]:
    keys: dict[str, Any] = {"primaryKey": list(table.key)}
    if table.name != "runs" and "run_id" in table.names() and any(one.name == "runs" for one in tables):
        keys["foreignKeys"] = [
            {"fields": ["run_id"], "reference": {"resource": "runs", "fields": ["run_id"]}}
        ]
    return {
        "name": table.name,
        "path": table.file,
        "profile": "tabular-data-resource",
        "description": table.description,
        "format": "csv",
        "mediatype": "text/csv",
        "encoding": "utf-8",
        "dialect": {"delimiter": ",", "lineTerminator": "\n", "header": True},
        "schema": {
            "fields": [_field(column) for column in table.columns],
            "missingValues": [""],
            **keys,
        },
    }


def _field(column: Column) -> dict[str, Any]:
    field: dict[str, Any] = {
        "name": column.name,
        "type": column.kind,
        "description": column.description,
    }
    if column.unit:
        field["unit"] = column.unit
    if column.kind == "boolean":
        field["trueValues"], field["falseValues"] = ["1"], ["0"]
    constraints: dict[str, Any] = {}
    if column.required:
        constraints["required"] = True
    if column.minimum is not None:
        constraints["minimum"] = int(column.minimum) if column.kind == "integer" else column.minimum
    if column.maximum is not None:
        constraints["maximum"] = column.maximum
    if column.choices:
        constraints["enum"] = [harmless(choice) for choice in column.choices]  # as in the cells
    if constraints:
        field["constraints"] = constraints
    return field
