"""Whole runs with SUMO in which egos do not know the truth."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import pandas as pd
import pytest

from cosim.cli import main
from cosim.sensing import catalog
from sumo_scenarios import library

pytestmark = [pytest.mark.sumo, pytest.mark.long]

FIRST_STOP = (
    "bus_stop_occlusion",
    "--duration-s",
    "25",
    "--set",
    "ego_count=1",
    "--set",
    "warmup_s=10",
    "--set",
    "vehicles_per_hour=0",
)
"""One ego passes the first bus, before which a pedestrian steps out."""
NAME = "first_stop#ego_0"
RECORDED = ("egos", "neighbours", "plans")


def _run(out: Path, scenario: str, *flags: str) -> Path:
    assert main(["run", scenario, "--controller", "constant_speed", *flags, "--out", str(out)]) == 0
    return out


def _sensing(folder: Path) -> pd.DataFrame:
    table = pd.read_parquet(folder / "sensing.parquet")
    mine = table[(table.ego_id == "ego_0") & (table.object_id == NAME)]
    return mine.set_index(mine.time_s.round(2))


def _encounter(folder: Path) -> dict[str, str]:
    with (folder / "encounters.csv").open(encoding="utf-8", newline="") as file:
        (row,) = [row for row in csv.DictReader(file) if row["ped_id"] == NAME]
    return row


def test_the_bus_hides_them_and_a_unit_across_the_road_does_not(tmp_path: Path) -> None:
    rows, tables = {}, {}
    for model in ("onboard", "roadside", "fused"):
        folder = _run(tmp_path / model, *FIRST_STOP, "--sensing", model)
        rows[model], tables[model] = _encounter(folder), _sensing(folder)
        description = json.loads((folder / "run.json").read_text())
        assert description["sensing"] == rows[model]["sensing"] == model
        assert set(description["parameters"]["sensing"]) == set(catalog.parameters(model))
    # The ego holds its speed in all three, so the truth is the same.
    assert len({row["t_min_dist_s"] for row in rows.values()}) == 1
    assert len({row["collision"] for row in rows.values()}) == 1
    seen = {model: float(row["visible_before_conflict_s"]) for model, row in rows.items()}
    assert seen["onboard"] < 2.0
    assert seen["roadside"] > 4.0
    assert seen["fused"] > 4.0
    onboard = tables["onboard"]
    hidden = onboard[onboard.state == "hidden"]
    assert len(hidden) > 20
    # A pedestrian who was never seen is not reported; errors are of the size of the noise.
    first = onboard[onboard.state == "visible"].index[0]
    assert not onboard[onboard.index < first].told.any()
    assert tables["roadside"][tables["roadside"].told].error_m.median() < 0.6


def test_nothing_hides_them_when_nothing_stands_there(tmp_path: Path) -> None:
    flags = (*FIRST_STOP, "--sensing", "onboard", "--set", "miss_probability=0", "--set", "hidden_by=nothing")
    table = _sensing(_run(tmp_path / "run", *flags))
    assert "hidden" not in set(table.state)
    assert set(table.state) <= {"visible", "out_of_range"}


def test_a_roadside_unit_without_faults_is_perfect(tmp_path: Path) -> None:
    ideal = (
        "unit_position_noise_m=0",
        "unit_velocity_noise_mps=0",
        "unit_miss_probability=0",
        "latency_ms=0",
    )
    flags = [text for one in (*ideal, "unit_range_m=500") for text in ("--set", one)]
    folder = _run(tmp_path / "roadside", *FIRST_STOP, "--sensing", "roadside", *flags, "--controller", "aeb")
    truth = _run(tmp_path / "truth", *FIRST_STOP, "--controller", "aeb")
    for name in RECORDED:
        assert (folder / f"{name}.parquet").read_bytes() == (truth / f"{name}.parquet").read_bytes()
    table = pd.read_parquet(folder / "sensing.parquet")
    assert table.told.all()
    assert table.error_m.max() == 0.0
    assert not (truth / "sensing.parquet").exists()


def test_the_same_seed_gives_the_same_bytes_and_sensing_is_perfect_by_itself(tmp_path: Path) -> None:
    short = (
        "midblock_zebra",
        "--duration-s",
        "10",
        "--set",
        "warmup_s=20",
        "--set",
        "pedestrians_per_hour=800",
    )
    default, named = _run(tmp_path / "a", *short), _run(tmp_path / "b", *short, "--sensing", "perfect")
    for name in RECORDED:
        assert (default / f"{name}.parquet").read_bytes() == (named / f"{name}.parquet").read_bytes()
    assert not (default / "sensing.parquet").exists()
    runs = [
        _run(tmp_path / f"{seed}-{again}", *short, "--sensing", "fused", "--seed", seed)
        for seed, again in (("1", 0), ("1", 1), ("2", 0))
    ]
    first, second, other = ((folder / "sensing.parquet").read_bytes() for folder in runs)
    assert first == second != other


def test_the_noise_of_one_seed_is_the_same_for_every_controller(tmp_path: Path) -> None:
    short = ("--sensing", "onboard", "--set", "confirm_hits=1", "--set", "confirm_looks=1", "--seed", "4")
    tables = []
    for controller in ("constant_speed", "aeb"):
        out = tmp_path / controller
        assert main(["run", *FIRST_STOP, *short, "--controller", controller, "--out", str(out)]) == 0
        tables.append(_sensing(out))
    one, other = tables
    # The first detection of a track is the bare measurement; both tracks begin with the same one if the
    # pedestrian appears at the same step, which happens while both egos drive alike.
    first = one[one.told].index[0]
    assert first == other[other.told].index[0]
    assert one.loc[first, "error_m"] == pytest.approx(other.loc[first, "error_m"], abs=1e-9)


def test_a_building_hides_what_is_behind_it(tmp_path: Path) -> None:
    """A wall between the lane and the sidewalk: the people who walk along are hidden, but for the last metres."""
    folder = tmp_path / "walled"
    shutil.copytree(library.LIBRARY / "bus_stop_occlusion", folder / "walled")
    shutil.copytree(library.LIBRARY / "road_users", folder / "road_users")
    place = folder / "walled"
    wall = (
        '<additional><poly id="house" type="building.yes" color="gray" '
        'shape="0,-6.30 700,-6.30 700,-6.35 0,-6.35"/></additional>'
    )
    (place / "house.add.xml").write_text(wall)
    text = (place / "scenario.toml").read_text()
    (place / "scenario.toml").write_text(
        text.replace('"standing.add.xml"]', '"standing.add.xml", "house.add.xml"]')
    )
    out = tmp_path / "out"
    flags = ("--sensing", "onboard", "--set", "pedestrians_per_hour=1200", "--set", "hidden_by=nothing")
    _run(out, str(place), "--duration-s", "25", "--set", "warmup_s=20", *flags)
    table = pd.read_parquet(out / "sensing.parquet")
    walkers = table[table.object_id.str.startswith("along") & (table.state != "out_of_range")]
    assert len(walkers) > 50
    assert set(walkers.state) == {"hidden"}
    # The pedestrian waits behind the wall and walks through it.
    mine = list(_sensing(out).state)
    out_of_it = mine.index("visible")
    assert set(mine[:out_of_it]) <= {"hidden", "out_of_range"}
    assert mine[:out_of_it].count("hidden") > 10
