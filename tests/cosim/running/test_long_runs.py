"""A quarter of an hour at a crossing, with seeds at which an ego once stood until it was given up.

It stood behind a blocking vehicle, half turned into the next lane, or beside a vehicle that let it in. Shorter
runs end before anybody has waited long.
"""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from cosim.cli import main

pytestmark = [pytest.mark.sumo, pytest.mark.slow]


@pytest.mark.parametrize(("seed", "vehicles"), [(9101, 600), (9102, 600), (9102, 1000)])
def test_no_ego_stands_until_it_is_given_up(seed: int, vehicles: int, tmp_path: Path) -> None:
    demand = ["--set", f"vehicles_per_hour={vehicles}", "--set", "pedestrians_per_hour=300"]
    words = ["run", "midblock_zebra", "--controller", "vo_mpc", "--seed", str(seed), *demand]
    assert main([*words, "--out", str(tmp_path / "run")]) == 0
    with (tmp_path / "run" / "runs.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    assert int(row["n_entered"]) >= 30
    expected = {"valid": "1", "n_egos_given_up": "0", "deadlock": "0", "n_collisions": "0"}
    assert {name: row[name] for name in expected} == expected
