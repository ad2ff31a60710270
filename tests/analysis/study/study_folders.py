"""Folders of finished runs whose numbers are written by hand; what a test does not say is 0 or a default."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from analysis.results.origin import SCHEMA_VERSION
from analysis.results.run_tables import ENCOUNTERS, RUNS
from analysis.tables.cells import cells
from analysis.tables.column import Column, Table

Row = Mapping[str, Any]

_DEFAULTS: dict[str, Any] = {
    "schema_version": SCHEMA_VERSION,
    "actuation": "hybrid",
    "sensing": "perfect",
    "valid": True,
    "priority": "ego",
    "conflict_type": "crossing",
    "first_user": "ped",
    "ttc_status": "ok",
    "pet_status": "ok",
    "drac_status": "ok",
    "mdrac_status": "ok",
    "evasive_status": "none",
    "severity": "none",
    "controller_status": "ok",
    "entered": True,
    "step_s": 0.1,
}


def write_study_run(
    folder: Path,
    controller: str,
    seed: int,
    *,
    numbers: Row | None = None,
    encounters: Sequence[Row] = (),
    parameters: Row | None = None,
    setting: Row | None = None,
    scenario: str = "road",
    invalid: str = "",
    analysed: bool = True,
    run_id: str | None = None,
    thresholds: Row | None = None,
) -> Path:
    """Write the files of a finished run that a study reads, and return its folder."""
    folder.mkdir(parents=True, exist_ok=True)
    setting, parameters = dict(setting or {}), dict(parameters or {})
    text = json.dumps([scenario, setting, parameters], sort_keys=True)
    config_id = f"{controller}-{sum(text.encode()):x}"
    origin = {
        "run_id": run_id or f"{config_id}-{seed}",
        "config_id": config_id,
        "scenario_id": scenario,
        "seed": seed,
    }
    description = {
        **origin,
        "controller": controller,
        "versions": {"sumo-cosim": "0"},
        "valid": not invalid,
        "invalid_reason": invalid or None,
        "parameters": {"scenario": setting, "controller": parameters},
        "egos": {"count": 1},
        "inputs": {"network": "abc"},
        "step_s": 0.1,
        "warmup_s": 0.0,
        "requested_duration_s": 60.0,
        "duration_s": 60.0,
        "actuation": "hybrid",
        "sensing": "perfect",
    }
    (folder / "run.json").write_text(json.dumps(description))
    if not analysed:
        return folder
    rows = [{**origin, "encounter_id": i, **row} for i, row in enumerate(encounters, start=1)]
    run = {
        **origin,
        "controller": controller,
        "valid": not invalid,
        "invalid_reason": invalid or None,
        "ego_count": 1,
        "ego_dist_km": 1.0,
        "ego_time_h": 0.1,
        "n_encounters": len(rows),
        **(numbers or {}),
    }
    _write(folder, RUNS, [run])
    _write(folder, ENCOUNTERS, rows)
    (folder / "config.json").write_text(json.dumps({"thresholds": thresholds or {"hard_brake_mps2": 4.0}}))
    return folder


def _write(folder: Path, table: Table, rows: Sequence[Row]) -> None:
    full = [{column.name: _default(column) for column in table.columns} | dict(row) for row in rows]
    with (folder / table.file).open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table.names())
        writer.writerows(cells(table, full))


def _default(column: Column) -> Any:
    if column.name in _DEFAULTS:
        return _DEFAULTS[column.name]
    if not column.required:
        return None
    return "x" if column.kind == "string" else 0
