"""Every controller of the catalogue drives through SUMO, and what is written about it is valid.

The quick part lets each of them drive one ego for some seconds, among people and vehicles, in one of the
scenarios by turns; the slow part has all of them in every scenario, to its end.
"""

from __future__ import annotations

import csv
import itertools
import json
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import MappingProxyType

import pandas as pd
import pyarrow.parquet as pq
import pytest

from controllers import catalog
from cosim.cli import main

pytestmark = [pytest.mark.sumo, pytest.mark.long]

SCENARIOS = ("midblock_zebra", "midblock_unmarked", "signalised_junction")
BY_TURNS = MappingProxyType(dict(zip(catalog.names(), itertools.cycle(SCENARIOS), strict=False)))
BUSY = ("ego_count=1", "pedestrians_per_hour=800", "vehicles_per_hour=200")
WARMUP_S, DURATION_S = 30.0, 16.0
NEARER = MappingProxyType({"signalised_junction": ("--ego-route", "south_approach east_exit")})
"""Where an ego of the quick part comes in, so that it meets people within these seconds."""
TURNING_CAR = "1695567735341236"
"""It turns right in the measured intersection, over a crossing, while people walk."""

PACKAGE = "datapackage.json"

every_controller = pytest.mark.parametrize("name", catalog.names())


def _run(folder: Path, scenario: str, name: str, settings: tuple[str, ...] = (), *flags: str) -> None:
    given = [text for setting in settings for text in ("--set", setting)]
    assert main(["run", scenario, "--controller", name, *given, *flags, "--out", str(folder)]) == 0


def _assert_described(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Check the CSV files against their data package."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its own dependencies warn on import
        import frictionless

        monkeypatch.chdir(folder)
        result = frictionless.Package(PACKAGE).validate()
    assert result.valid, result.flatten(["type", "rowNumber", "fieldName", "message"])


def _row(folder: Path) -> dict[str, str]:
    """Return the row of a run, which must be valid."""
    assert json.loads((folder / "run.json").read_text(encoding="utf-8"))["valid"] is True
    with (folder / "runs.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    return row


def _ends(folder: Path) -> dict[str, float]:
    """Return how far each ego came [m]."""
    track = pq.read_table(folder / "egos.parquet", columns=["ego_id", "route_position_m"]).to_pandas()
    ends: dict[str, float] = track.groupby("ego_id")["route_position_m"].max().to_dict()
    return ends


@pytest.fixture(scope="module")
def among_people(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return what gives a controller's folder of the quick part; each of them drives once."""
    folder = tmp_path_factory.mktemp("runs")
    flags = "--duration-s", f"{DURATION_S:g}"

    @cache
    def run(name: str) -> Path:
        nearer = NEARER.get(BY_TURNS[name], ())
        _run(folder / name, BY_TURNS[name], name, (*BUSY, f"warmup_s={WARMUP_S}"), *flags, *nearer)
        return folder / name

    return run


@every_controller
def test_it_drives_among_people_and_vehicles(name: str, among_people: Callable[[str], Path]) -> None:
    row = _row(among_people(name))
    assert int(row["n_encounters"]) > 0
    assert max(_ends(among_people(name)).values()) > 50.0


def test_what_all_of_them_wrote_is_valid_by_its_data_package(
    among_people: Callable[[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As one package: all are described alike, and it is the description that takes long to be read."""
    folders = [among_people(name) for name in catalog.names()]
    described = (folders[0] / PACKAGE).read_text("utf-8")
    assert all((folder / PACKAGE).read_text("utf-8") == described for folder in folders)
    (tmp_path / PACKAGE).write_text(described, "utf-8")
    for table in [one["path"] for one in json.loads(described)["resources"]]:
        first, *others = [(folder / table).read_text("utf-8").splitlines(keepends=True) for folder in folders]
        assert all(lines[0] == first[0] for lines in others)
        rows = [*first, *(line for lines in others for line in lines[1:])]
        (tmp_path / table).write_text("".join(rows), "utf-8")
    _assert_described(tmp_path, monkeypatch)
    assert len(pd.read_csv(tmp_path / "runs.csv")) == len(folders)


@pytest.mark.slow
@every_controller
@pytest.mark.parametrize("scenario", SCENARIOS)
def test_it_drives_to_the_end_of_the_scenario(
    name: str, scenario: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _run(tmp_path / "run", scenario, name, ("ego_count=1",))
    _assert_described(tmp_path / "run", monkeypatch)
    row = _row(tmp_path / "run")
    assert int(row["n_encounters"]) > 0


@pytest.mark.slow
@every_controller
def test_it_drives_one_car_of_a_measured_intersection(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _run(tmp_path / "run", "braunschweig", name, (), "--ego-vehicle", TURNING_CAR)
    _assert_described(tmp_path / "run", monkeypatch)
    row = _row(tmp_path / "run")
    assert int(row["ego_count"]) == 1
    assert int(row["n_encounters"]) > 0
