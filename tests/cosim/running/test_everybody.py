"""Runs that record everybody near the crossings, with egos and without."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.files import read_csv, read_json
from cosim.errors import InputError
from cosim.running.execution import execute
from cosim.running.request import RunRequest
from cosim.running.simulation import run
from cosim.sumo.everybody import CELL, PERSON_RANGE, VEHICLE_RANGE

DEMAND = {"vehicles_per_hour": "900", "pedestrians_per_hour": "400", "warmup_s": "20"}


def made(out: Path, **keys: object) -> Path:
    request = RunRequest("midblock_zebra", "aeb", 1, DEMAND, duration_s=37.0, out=out, **keys)  # type: ignore[arg-type]
    assert execute(request).invalid_reason == ""
    return out


@pytest.fixture(scope="module")
def everybody(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.mktemp("everybody") / "run", record="everybody")


@pytest.mark.long
@pytest.mark.sumo
def test_recording_everybody_changes_no_byte_of_what_is_said_of_egos(tmp_path: Path, everybody: Path) -> None:
    egos = made(tmp_path / "egos")
    for name in ("egos.parquet", "neighbours.parquet", "encounters.csv", "vehicle_overlaps.csv"):
        assert (egos / name).read_bytes() == (everybody / name).read_bytes(), name
    assert not (egos / "traffic.parquet").exists()
    assert (read_json(egos / "run.json")["record"], read_json(everybody / "run.json")["record"]) == (
        "egos",
        "everybody",
    )


@pytest.mark.sumo
def test_a_vehicle_that_was_named_and_never_comes_is_told(tmp_path: Path) -> None:
    request = RunRequest(
        "midblock_zebra",
        "aeb",
        1,
        DEMAND,
        duration_s=5.0,
        ego_vehicle="ghost",
        record="everybody",
        out=tmp_path,
    )
    result = run(request)
    assert 'vehicle "ghost" did not depart' in result.invalid_reason
    assert (tmp_path / "traffic.parquet").exists()


@pytest.mark.long
@pytest.mark.sumo
def test_other_drivers_are_judged_beside_the_egos(everybody: Path) -> None:
    rows = read_csv(everybody / "traffic_encounters.csv")
    drivers = {(row["is_ego"], row["controller"]) for row in rows}
    assert drivers == {("1", "aeb"), ("0", "sumo")}
    egos = {row["ego_id"] for row in read_csv(everybody / "encounters.csv")}
    assert {row["vehicle_id"] for row in rows if row["is_ego"] == "1"} <= egos
    assert not {row["vehicle_id"] for row in rows if row["is_ego"] == "0"} & egos
    assert [int(row["traffic_encounter_id"]) for row in rows] == list(range(1, len(rows) + 1))


@pytest.mark.long
@pytest.mark.sumo
def test_who_is_recorded_is_near_a_crossing_and_where_the_egos_recording_has_them(everybody: Path) -> None:
    traffic = pd.read_parquet(everybody / "traffic.parquet")
    areas = read_json(everybody / "map.json")["areas"]
    axes = [np.array(one["shape_m"]) for one in areas if one["kind"] == "crossing"]
    points = np.concatenate([np.linspace(axis[0], axis[-1], 50) for axis in axes])
    for kind, reach in (("pedestrian", PERSON_RANGE), ("vehicle", VEHICLE_RANGE)):
        places = traffic[traffic.object_kind == kind][["x_m", "y_m"]].drop_duplicates().to_numpy()
        assert len(places) > 100
        apart = np.hypot(*(places[:, None] - points).transpose(2, 0, 1)).min(axis=1)
        assert reach - 5.0 < apart.max() < reach + 2.5 * CELL
    seen = pd.read_parquet(everybody / "neighbours.parquet")
    seen = seen[seen.object_kind == "pedestrian"].assign(step=lambda rows: rows.time_s.round(3))
    walkers = traffic[traffic.object_kind == "pedestrian"].assign(step=lambda rows: rows.time_s.round(3))
    both = walkers.merge(seen, on=["step", "object_id"], suffixes=("", "_seen"))
    assert len(both) > 100
    assert np.abs(both.x_m - both.x_m_seen).max() <= 5.1e-4
    assert np.abs(both.y_m - both.y_m_seen).max() <= 5.1e-4
    assert (both.phase == both.phase_seen).all()


@pytest.mark.long
@pytest.mark.sumo
def test_a_run_without_egos_judges_everybody(tmp_path: Path) -> None:
    out = made(tmp_path / "run", record="everybody", ego_share=0.0)
    rows = read_csv(out / "traffic_encounters.csv")
    assert {row["controller"] for row in rows} == {"sumo"}
    assert any(row["entered"] == "1" for row in rows)
    assert read_csv(out / "encounters.csv") == []
    (run,) = read_csv(out / "runs.csv")
    assert run["n_encounters"] == "0"


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"record": "all"}, "--record: expected egos or everybody, got 'all'"),
        ({"ego_share": 0.0}, "--ego-share 0: a run without egos has to record everybody"),
    ],
)
def test_what_cannot_be_recorded_is_refused(keys: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        RunRequest("midblock_zebra", **keys)  # type: ignore[arg-type]
