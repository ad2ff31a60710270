"""Every controller of the catalogue drives through SUMO, and what is written about it is valid.

The quick part lets each of them drive one ego for some seconds, among people and vehicles, in one of the
scenarios by turns; the slow part has all of them in every scenario, to its end.
"""

from __future__ import annotations

import csv
import itertools
import json
import warnings
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from controllers import catalog
from cosim.cli import main

pytestmark = pytest.mark.sumo

SCENARIOS = ("midblock_zebra", "midblock_unmarked", "signalised_junction")
BUSY = ("ego_count=1", "pedestrians_per_hour=800", "vehicles_per_hour=200")
WARMUP_S, DURATION_S = 30.0, 55.0
TURNING_CAR = "1695567735341236"
"""It turns right in the measured intersection, over a crossing, while people walk."""

every_controller = pytest.mark.parametrize("name", catalog.names())


def _run(folder: Path, scenario: str, name: str, settings: tuple[str, ...] = (), *flags: str) -> None:
    given = [text for setting in settings for text in ("--set", setting)]
    assert main(["run", scenario, "--controller", name, *given, *flags, "--out", str(folder)]) == 0


def _assert_valid(folder: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """Check the CSV files against their data package, and return the run's row."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its own dependencies warn on import
        import frictionless

        monkeypatch.chdir(folder)
        result = frictionless.Package("datapackage.json").validate()
    assert result.valid, result.flatten(["type", "rowNumber", "fieldName", "message"])
    assert json.loads((folder / "run.json").read_text(encoding="utf-8"))["valid"] is True
    with (folder / "runs.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    return row


def _ends(folder: Path) -> dict[str, float]:
    """Return how far each ego came [m]."""
    track = pq.read_table(folder / "egos.parquet", columns=["ego_id", "route_position_m"]).to_pandas()
    ends: dict[str, float] = track.groupby("ego_id")["route_position_m"].max().to_dict()
    return ends


@pytest.mark.parametrize(
    ("name", "scenario"), list(zip(catalog.names(), itertools.cycle(SCENARIOS), strict=False))
)
def test_it_drives_among_people_and_vehicles(
    name: str, scenario: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _run(
        tmp_path / "run",
        scenario,
        name,
        (*BUSY, f"warmup_s={WARMUP_S}"),
        "--duration-s",
        f"{DURATION_S - WARMUP_S:g}",
    )
    row = _assert_valid(tmp_path / "run", monkeypatch)
    assert int(row["n_encounters"]) > 0
    assert max(_ends(tmp_path / "run").values()) > 50.0


@pytest.mark.slow
@every_controller
@pytest.mark.parametrize("scenario", SCENARIOS)
def test_it_drives_to_the_end_of_the_scenario(
    name: str, scenario: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _run(tmp_path / "run", scenario, name, ("ego_count=1",))
    row = _assert_valid(tmp_path / "run", monkeypatch)
    assert int(row["n_encounters"]) > 0


@pytest.mark.slow
@every_controller
def test_it_drives_one_car_of_a_measured_intersection(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _run(tmp_path / "run", "braunschweig", name, (), "--ego-vehicle", TURNING_CAR)
    row = _assert_valid(tmp_path / "run", monkeypatch)
    assert int(row["ego_count"]) == 1
    assert int(row["n_encounters"]) > 0
