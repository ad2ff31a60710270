"""The crossing study's numbers on frames that can be checked by hand."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.errors import StudyError
from studies.crossings.page import write_page
from studies.crossings.summary import KEYS, POOLED, passages, summary
from studies.crossings.table import markdown

DEMAND = {"scenario_id": "road", "vehicles_per_hour": 600.0, "pedestrians_per_hour": 300.0}
COUNTS = [
    "n_stopped_on_crossing",
    "deadlock",
    "n_vehicle_overlaps",
    "n_vehicle_overlaps_ego_closed",
    "n_lane_changes",
    "n_straight",
    "n_lane_change",
    "n_autonomous",
    "n_solver_fail",
    "n_interventions",
]


def _runs() -> pd.DataFrame:
    delays = {"sumo": (20.0, 30.0, 40.0), "vo_mpc": (18.0, 26.0, 34.0)}
    rows = [
        DEMAND
        | {"controller": name, "seed": seed, "ego_count": 2, "ego_delay_mean_s": delay}
        | {"slack_share": 0.0, "compute_p95_ms": 1.0}
        | dict.fromkeys(COUNTS, 0)
        for name, values in delays.items()
        for seed, delay in enumerate(values, 1)
    ]
    return pd.DataFrame(rows)


def _encounters() -> pd.DataFrame:
    rows = []
    for seed in (1, 2, 3):
        for number, (clearance, hit, entered) in enumerate([(2.0, 0, 1), (1.5, 1, 1), (0.1, 0, 0)]):
            rows.append(
                DEMAND
                | {"controller": "vo_mpc", "seed": seed, "passage_id": "ego_0|c|1", "encounter_id": number}
                | {"entered": entered, "n_collisions": hit, "clearance_min_m": clearance}
                | {"min_ttc_s": 1.0 if hit else np.nan, "ego_max_decel_mps2": 2.0 + number}
                | {"ego_max_abs_jerk_mps3": 3.0, "late_entry": 0, "side_changes": 1}
            )
    return pd.DataFrame(rows)


def test_a_passage_is_as_bad_as_its_worst_encounter_and_who_never_entered_is_none() -> None:
    met = passages(_encounters())
    assert len(met) == 3
    assert set(met["clearance_m"]) == {1.5}
    assert set(met["max_decel_mps2"]) == {3.0}
    assert set(met["encounters"]) == {2}


def test_delays_are_compared_by_seed() -> None:
    table = summary(_runs(), _encounters()).set_index("controller")
    # Differences −2, −4, −6: mean −4, standard deviation 2, t(0.975, 2) = 4.303.
    row = table.loc["vo_mpc"]
    assert row["delay_minus_sumo_s"] == pytest.approx(-4.0)
    assert row["delay_minus_sumo_high_s"] == pytest.approx(-4.0 + 4.303 * 2.0 / np.sqrt(3.0), abs=1e-3)
    assert row["pairs"] == 3
    own = table.loc["sumo", ["delay_minus_sumo_s", "delay_minus_sumo_low_s", "delay_minus_sumo_high_s"]]
    assert list(own) == [0.0, 0.0, 0.0]


def test_rates_carry_their_exact_upper_bound() -> None:
    table = summary(_runs(), _encounters()).set_index("controller")
    assert table.loc["vo_mpc", "contacts"] == 3
    assert table.loc["vo_mpc", "contact_upper_95"] == pytest.approx(1.0)
    assert np.isnan(float(str(table.loc["sumo", "contact_upper_95"])))


def test_the_table_has_a_block_for_all_demands_and_one_for_each() -> None:
    runs, encounters = _runs(), _encounters()
    pooled = summary(runs, encounters, ["scenario_id", "controller"])
    text = markdown(summary(runs, encounters), pooled)
    assert text.index("### road, all demands") < text.index("### road, 600 veh/h")
    assert "-4.0 (-9.0 … +1.0)" in text


def test_the_tables_are_written_into_the_folder_of_the_study(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="no runs"):
        write_page(tmp_path)
    runs, encounters = _runs(), _encounters()
    for (name, seed), mine in runs.groupby(["controller", "seed"]):
        folder = tmp_path / "runs" / f"{name}-{seed}"
        folder.mkdir(parents=True)
        about = {"controller": name, "parameters": {"scenario": DEMAND}}
        (folder / "run.json").write_text(json.dumps(about))
        known = KEYS[1:]
        mine.drop(columns=known).to_csv(folder / "runs.csv", index=False)
        met = encounters[(encounters["controller"] == name) & (encounters["seed"] == seed)]
        met.drop(columns=known).to_csv(folder / "encounters.csv", index=False)
    text = write_page(tmp_path)
    assert (tmp_path / "study.md").read_text() == text
    assert text == markdown(summary(runs, encounters), summary(runs, encounters, POOLED))
    assert len(pd.read_csv(tmp_path / "study.csv")) == 2
