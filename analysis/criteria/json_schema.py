"""The JSON schema of a criterion, for editors: the keys that `analysis.criteria.reading` reads."""

from __future__ import annotations

from typing import Any

from analysis.criteria.criterion import OPERATORS, SCOPES, STATISTICS
from analysis.criteria.reading import KEYS
from analysis.results.measures import encounter_measures, run_measures
from analysis.results.run_tables import ENCOUNTERS, RUNS

_MEANINGS = {
    "id": "Name of the criterion; none given: its text.",
    "scope": "What is judged: every encounter, every run, or a statistic over the runs of a configuration.",
    "metric": "Column of encounters.csv or runs.csv, or measure of configs.csv.",
    "statistic": "Of a configuration: what is taken of the measure.",
    "kind": "Of a configuration: which measure, where a name is one of each run and of each encounter.",
    "operator": "How the value has to be to the threshold.",
    "threshold": "What the value is held against, in the unit of the metric.",
    "where": "Of encounters and runs: only rows with these values in these columns.",
    "controllers": "Only these controllers; none given: all.",
    "scenarios": "Only these scenarios; none given: all.",
    "allow_undefined": "Whether an undefined value does not count instead of failing.",
}


def criterion_schema() -> dict[str, Any]:
    """Return the schema of one ``[[criteria]]`` table."""
    measured = {one.name for one in (*run_measures(), *encounter_measures())}
    columns = {one.name for table in (ENCOUNTERS, RUNS) for one in table.columns if one.kind != "string"}
    names = {"type": "array", "items": {"type": "string"}, "minItems": 1}
    kinds: dict[str, dict[str, Any]] = {
        "scope": {"enum": list(SCOPES)},
        "metric": {"enum": sorted(measured | columns)},
        "statistic": {"enum": list(STATISTICS)},
        "kind": {"type": "string"},
        "operator": {"enum": list(OPERATORS)},
        "threshold": {"type": ["number", "boolean"]},
        "where": {"type": "object", "additionalProperties": {"type": ["boolean", "number", "string"]}},
        "controllers": names,
        "scenarios": names,
        "allow_undefined": {"type": "boolean", "default": False},
        "id": {"type": "string"},
    }
    return {
        "type": "object",
        "additionalProperties": False,
        "required": ["scope", "metric", "operator", "threshold"],
        "properties": {key: {**kinds[key], "description": _MEANINGS[key]} for key in KEYS},
    }
