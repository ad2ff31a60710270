"""The columns that say which run a row belongs to, the same in every file of a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from analysis.tables.column import Column, text

SCHEMA_VERSION = "2"
"""Version of the CSV files; changes whenever a column changes its name or meaning."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Description of a run, from its run.json."""

    meta: Mapping[str, Any]
    """``run.json``."""
    schema_version: ClassVar[str] = SCHEMA_VERSION

    @property
    def actuation(self) -> str:
        """How the ego was moved."""
        return self.meta.get("actuation") or "unknown"

    @property
    def sensing(self) -> str:
        """Sensing model of the ego."""
        return self.meta.get("sensing") or "unknown"


IDENTITY = (
    text("schema_version", "version of this table's schema", source="origin.schema_version", required=True),
    text("run_id", "hash of the run's inputs", source="origin.meta.run_id", required=True),
)
CONFIGURATION = (
    text(
        "config_id",
        "controller, its parameters, scenario and setting, without the seed",
        source="origin.meta.config_id",
        required=True,
    ),
    text("scenario_id", "scenario", source="origin.meta.scenario_id", required=True),
    Column("seed", "integer", "1", "seed of the run", "origin.meta.seed", required=True),
)
CONDITIONS = (
    text("actuation", "how the ego was moved", source="origin.actuation", required=True),
    text("sensing", "what the ego could sense", source="origin.sensing", required=True),
)
