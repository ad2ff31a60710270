"""Comparison of controllers at crossings: one row per scenario, demand and controller.

It reads only the CSV files of recorded runs. A passage is an ego's drive over a crossing with at least one
pedestrian who entered its path. Clearances and times to collision are the smallest of a passage,
decelerations and jerks the largest.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analysis.files import read_json
from analysis.manifest import read_verified
from analysis.statistics.intervals import mean_interval, share_upper_bound
from analysis.thresholds import LOW_TTC_S

KEYS = ["scenario_id", "vehicles_per_hour", "pedestrians_per_hour", "controller"]
BASELINE = "sumo"
POOLED = ["scenario_id", "controller"]
"""Keys of rows that pool all demands."""
PAIR = ["vehicles_per_hour", "pedestrians_per_hour", "seed"]
"""Columns by which runs of two controllers are paired."""


def read_study(folders: Iterable[Path]) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the rows of runs.csv and encounters.csv of all folders, with the demand as columns."""
    runs: list[pd.DataFrame] = []
    encounters: list[pd.DataFrame] = []
    for folder in sorted(folders):
        description = read_json(folder / "run.json")
        demand = description["parameters"]["scenario"]
        for name, rows in (("runs.csv", runs), ("encounters.csv", encounters)):
            frame = pd.read_csv(BytesIO(read_verified(folder / name)))
            if frame.empty:
                continue
            in_one_piece = frame.copy()  # pandas warns of adding columns to what it has read in many pieces
            rows.append(
                in_one_piece.assign(
                    controller=description["controller"],
                    vehicles_per_hour=demand["vehicles_per_hour"],
                    pedestrians_per_hour=demand["pedestrians_per_hour"],
                )
            )
    return pd.concat(runs, ignore_index=True), pd.concat(encounters, ignore_index=True)


def passages(encounters: pd.DataFrame) -> pd.DataFrame:
    """Return one row per passage with a pedestrian who entered the ego's path."""
    met = encounters[(encounters["entered"] == 1) & encounters["passage_id"].notna()]
    return (
        met.groupby([*KEYS, "seed", "passage_id"])
        .agg(
            encounters=("encounter_id", "size"),
            contacts=("n_collisions", "sum"),
            clearance_m=("clearance_min_m", "min"),
            min_ttc_s=("min_ttc_s", "min"),
            max_decel_mps2=("ego_max_decel_mps2", "max"),
            max_jerk_mps3=("ego_max_abs_jerk_mps3", "max"),
            late_entry=("late_entry", "max"),
            side_changes=("side_changes", "sum"),
        )
        .reset_index()
    )


def summary(runs: pd.DataFrame, encounters: pd.DataFrame, keys: Sequence[str] = tuple(KEYS)) -> pd.DataFrame:
    """Return one row per scenario, demand and controller, or by other keys that end with the controller."""
    met, by = passages(encounters), list(keys)
    rows = []
    for key, group in runs.groupby(by):
        mine = met[(met[by] == list(key)).all(axis=1)]
        same = (runs[by[:-1]] == list(key[:-1])).all(axis=1)
        base = runs[same & (runs["controller"] == BASELINE)]
        rows.append(dict(zip(by, key, strict=True)) | _row(group, mine, base))
    return pd.DataFrame(rows)


def _row(runs: pd.DataFrame, met: pd.DataFrame, base: pd.DataFrame) -> dict[str, Any]:
    n = len(met)
    contacts = int((met["contacts"] > 0).sum())
    near = int((met["min_ttc_s"] < LOW_TTC_S).sum())
    mild = met[(met["max_decel_mps2"] > 4.5) & (met["late_entry"] != 1)]
    difference, low, high, pairs = _paired(runs, base)
    return {
        "runs": len(runs),
        "egos": int(runs["ego_count"].sum()),
        "passages": n,
        "encounters": int(met["encounters"].sum()),
        "contacts": contacts,
        "contact_upper_95": _upper(contacts, n),
        "ttc_lt_1p5": near,
        "ttc_lt_1p5_share": near / n if n else np.nan,
        "ttc_lt_1p5_upper_95": _upper(near, n),
        "clearance_min_m": met["clearance_m"].min(),
        "clearance_p01_m": met["clearance_m"].quantile(0.01),
        "clearance_p05_m": met["clearance_m"].quantile(0.05),
        "decel_p50_mps2": met["max_decel_mps2"].quantile(0.5),
        "decel_p95_mps2": met["max_decel_mps2"].quantile(0.95),
        "decel_max_mps2": met["max_decel_mps2"].max(),
        "decel_gt_4p5_not_late": len(mild),
        "jerk_p50_mps3": met["max_jerk_mps3"].quantile(0.5),
        "jerk_p95_mps3": met["max_jerk_mps3"].quantile(0.95),
        "delay_mean_s": _per_ego(runs, "ego_delay_mean_s"),
        "delay_minus_sumo_s": difference,
        "delay_minus_sumo_low_s": low,
        "delay_minus_sumo_high_s": high,
        "pairs": pairs,
        "slack_share": _per_ego(runs, "slack_share"),
        "side_changes_per_passage": met["side_changes"].sum() / n if n else np.nan,
        "stopped_on_crossing": int(runs["n_stopped_on_crossing"].sum()),
        "deadlocks": int(runs["deadlock"].sum()),
        "vehicle_overlaps": int(runs["n_vehicle_overlaps"].sum()),
        "vehicle_overlaps_ego_closed": int(runs["n_vehicle_overlaps_ego_closed"].sum()),
        "lane_changes": int(runs["n_lane_changes"].sum()),
        "straight": int(runs["n_straight"].sum()),
        "lane_change": int(runs["n_lane_change"].sum()),
        "autonomous": int(runs["n_autonomous"].sum()),
        "unsolved": int(runs["n_solver_fail"].sum()),
        "interventions": int(runs["n_interventions"].sum()),
        "compute_p95_ms": runs["compute_p95_ms"].median(),
    }


def _per_ego(runs: pd.DataFrame, column: str) -> float:
    known = runs[runs[column].notna()]
    return float(np.average(known[column], weights=known["ego_count"])) if len(known) else np.nan


def _upper(count: int, n: int) -> float:
    """Return the one-sided exact 95 % upper bound of a share."""
    bound = share_upper_bound(count, n)
    return np.nan if bound is None else bound


def _paired(runs: pd.DataFrame, base: pd.DataFrame) -> tuple[float, float, float, int]:
    """Return mean and 95 % t interval of the delay difference to the baseline, paired by demand and seed."""
    mine = runs.set_index(PAIR)["ego_delay_mean_s"]
    difference = (mine - base.set_index(PAIR)["ego_delay_mean_s"]).dropna().to_numpy(dtype=np.float64)
    n = len(difference)
    mean = float(difference.mean()) if n else np.nan
    if n < 2:
        return mean, np.nan, np.nan, n
    interval = mean_interval(difference)
    # Without an interval, all differences are equal, as for the baseline itself.
    return (mean, mean, mean, n) if interval is None else (mean, interval.low, interval.high, n)
