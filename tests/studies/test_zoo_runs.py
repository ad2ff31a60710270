"""Six small networks of the zoo, driven from end to end."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from studies.zoo.__main__ import main

SEED = "1"
SMALL = ("grid-short", "grid-left-hand", "random-short", "roundabouts", "refuges", "rilsa1")


@pytest.mark.sumo
@pytest.mark.parametrize("name", SMALL)
def test_a_small_network_is_driven_to_its_end_and_counted(name: str, tmp_path: Path) -> None:
    few = ["--networks", name, "--controllers", "vo_mpc", "--runs", "1", "--jobs", "1"]
    short = ["--duration-s", "40", "--ego-share", "0.4"]
    assert main(["all", SEED, *few, *short, "--out", str(tmp_path)]) == 0
    with (tmp_path / "networks.csv").open() as file:
        (row,) = csv.DictReader(file)
    assert (row["network"], row["driver"], row["valid runs"]) == (name, "vo_mpc", "1 of 1")
    assert f"### {name}" in (tmp_path / "zoo.md").read_text("utf-8")
