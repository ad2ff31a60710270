"""From a case to the rows of the CSV files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from analysis import schema
from analysis.case import Case
from analysis.encounters import Encounter
from analysis.metric_catalog import find_metrics

Row = Mapping[str, Any]

_PRIORITY = {"zebra": "ped", "unmarked": "ego"}


def encounter_and_run_rows(case: Case) -> tuple[Sequence[Row], Row]:
    """Return the rows of encounters.csv and the row of runs.csv."""
    columns: dict[str, Any] = {}
    summary: dict[str, Any] = {}
    for metric in find_metrics():
        values = metric.compute(case)
        if metric.scope == "run":
            summary.update(values)
            continue
        columns.update(values)
        if metric.summarise is not None:
            summary.update(metric.summarise(case, values))
    rows = [
        _plain(
            schema.ENCOUNTERS,
            {**_described(case, number, one), **{name: values[number] for name, values in columns.items()}},
        )
        for number, one in enumerate(case.encounters)
    ]
    return rows, _plain(schema.RUNS, {**_run(case), **summary})


def _plain(table: schema.Table, row: Row) -> dict[str, Any]:
    """Return the row with the table's types, and ``None`` for what is undefined."""
    plain = {name: value.item() if isinstance(value, np.generic) else value for name, value in row.items()}
    known = {
        name: None if isinstance(value, float) and not np.isfinite(value) else value
        for name, value in plain.items()
    }
    for column in table.columns:
        if column.kind == "boolean" and known.get(column.name) is not None:
            known[column.name] = bool(known[column.name])
    return known


def overlap_rows(case: Case) -> Sequence[Row]:
    """Return the rows of vehicle_overlaps.csv."""
    return [
        _plain(
            schema.VEHICLE_OVERLAPS,
            {
                "schema_version": schema.SCHEMA_VERSION,
                "run_id": case.run.meta["run_id"],
                "overlap_id": number,
                "ego_id": one.ego_id,
                "vehicle_id": one.vehicle_id,
                "vehicle_type": one.vehicle_type,
                "t_start_s": one.start,
                "t_end_s": one.end,
                "depth_m": one.depth,
                "closed_by": one.closed_by,
                "ego_closing_mps": one.ego_closing,
                "other_closing_mps": one.other_closing,
                "ego_speed_mps": one.ego_speed,
                "other_speed_mps": one.other_speed,
                "x_m": one.x,
                "y_m": one.y,
            },
        )
        for number, one in enumerate(case.overlaps, start=1)
    ]


def _origin(case: Case) -> dict[str, Any]:
    meta = case.run.meta
    return {
        "schema_version": schema.SCHEMA_VERSION,
        "run_id": meta["run_id"],
        "config_id": meta["config_id"],
        "scenario_id": meta["scenario_id"],
        "seed": meta["seed"],
        "actuation": meta.get("actuation") or "unknown",
        "sensing": meta.get("sensing") or "unknown",
    }


def _described(case: Case, number: int, one: Encounter) -> dict[str, Any]:
    priority = _PRIORITY.get(one.crossing_kind, "none") if one.crossing_id else "ego"
    return {
        **_origin(case),
        "encounter_id": number + 1,
        "ego_id": one.ego.name,
        "ped_id": one.person.name,
        "ped_type": one.person.kind,
        "crossing_id": one.crossing_id,
        "crossing_type": one.crossing_kind,
        "priority": priority,
        "passage_id": one.passage_id,
        "t_start_s": case.grid.time[one.first],
        "t_end_s": case.grid.time[one.last],
        "censored": one.censored,
        "conflict_type": _conflict_type(case, one),
        "first_user": _first_user(one),
        "ego_length_m": one.ego.length,
        "ego_width_m": one.ego.width,
        "ped_radius_m": 0.5 * one.person.width,
        "entered": bool(case.entered[number]),
        "x_conflict_m": None if one.area is None else one.area.x,
        "y_conflict_m": None if one.area is None else one.area.y,
    }


def _first_user(one: Encounter) -> str:
    """Return who left the conflict area first; who is still inside leaves last."""
    if one.area is None:
        return "none"
    ego, person = one.area.ego, one.area.person
    leaves_ego, leaves_person = np.nan_to_num([ego.leave, person.leave], nan=np.inf)
    if leaves_ego == leaves_person:
        return "ego" if ego.enter <= person.enter else "ped"
    return "ego" if leaves_ego < leaves_person else "ped"


def _conflict_type(case: Case, one: Encounter) -> str:
    """Return turning for an ego that turns before or inside the area, else by the angle of the paths."""
    limits = case.thresholds
    first, last = one.first - one.ego.first, one.last - one.ego.first
    if one.area is not None:
        first, last = min(first, one.area.ego.first), one.area.ego.last
    heading = one.ego.heading[first : last + 1]
    if np.ptp(heading) > np.radians(limits.turning_angle_deg):
        return "turning"
    if one.area is None:  # listed because of a crossing
        return "crossing"
    person = slice(one.area.person.first, one.area.person.last + 1)
    x, y = one.person.x[person], one.person.y[person]
    dx, dy = float(x[-1] - x[0]), float(y[-1] - y[0])
    if np.hypot(dx, dy) < 1e-6:
        return "crossing"
    across = abs(np.sin(np.arctan2(dy, dx) - heading[-1]))
    return "longitudinal" if across < np.sin(np.radians(limits.longitudinal_angle_deg)) else "crossing"


def _run(case: Case) -> dict[str, Any]:
    meta = case.run.meta
    wall, duration = meta.get("wall_s"), meta.get("duration_s")
    return {
        **_origin(case),
        "controller": meta["controller"],
        "tool_version": meta.get("tool_version"),
        "git_sha": meta.get("git_sha"),
        "sumo_version": meta.get("sumo_version"),
        "wall_start_utc": meta.get("start_utc"),
        "wall_s": wall,
        "wall_rtf": duration / wall if wall and duration is not None else None,
        "step_s": case.run.step_s,
        "warmup_s": meta.get("warmup_s"),
        "duration_s": duration,
        "valid": bool(meta.get("valid", False)),
        "invalid_reason": meta.get("invalid_reason"),
        "n_teleports": meta.get("n_teleports"),
    }


def _decimals(value: float) -> str:
    """Return a number with six decimals at most."""
    return f"{value:.6f}".rstrip("0").rstrip(".")


def cells(
    table: schema.Table, rows: Sequence[Row], number: Callable[[float], str] = _decimals
) -> list[list[str]]:
    """Return the texts of a CSV file, without its header.

    Parameters
    ----------
    table, rows
        What to write.
    number
        Makes the text of a number that is no whole one.

    Raises
    ------
    KeyError
        For a value that no column of the table has.
    """
    known = set(table.names())
    for row in rows:
        if foreign := set(row) - known:
            raise KeyError(f"{table.file} has no column {sorted(foreign)}")
    return [[_cell(column, row.get(column.name), number) for column in table.columns] for row in rows]


def _cell(column: schema.Column, value: Any, number: Callable[[float], str]) -> str:
    """Return one cell: empty for undefined, booleans 0 or 1."""
    if value is None:
        if column.required:
            raise ValueError(f"column {column.name} must not be empty")
        return ""
    if column.kind == "boolean":
        return "1" if value else "0"
    if column.kind == "integer":
        return str(int(value))
    if column.kind == "number":
        text = number(float(value))
        return "0" if text == "-0" else text
    return str(value)
