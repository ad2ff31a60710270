"""No command writes what a user's configuration makes SUMO write, and those that run it say so once."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pytest

from tests.cosim.batches.studies import write_study
from tests.cosim.cli.commands import ended
from tests.cosim.inspection.towns import build, configure

pytestmark = pytest.mark.sumo

OUTPUTS = (
    '<input><additional-files value="det.add.xml"/></input><output><tripinfo value="trips.xml"/>'
    '<fcd-output value="fcd.xml"/></output><report><error-log value="errors.txt"/></report>'
)
NOTE = "5 outputs of SUMO that the inputs ask for were not written: error-log, …"
CARS = (
    '<vType id="seen"><param key="has.ssm.device" value="true"/></vType>'
    '<flow id="f" type="seen" begin="0" end="20" period="4" from="east_1" to="east_2"/>'
)
SCENARIO = """description = "d"
duration_s = 12.0
sumocfg = "town.sumocfg"
[egos]
vehicles = ["f.0"]
"""


@pytest.fixture
def town(tmp_path: Path) -> Path:
    folder = tmp_path / "town"
    folder.mkdir()
    build(folder)
    configure(folder, CARS, OUTPUTS)
    (folder / "det.add.xml").write_text(
        '<additional><edgeData id="e" file="edges.xml"/>'
        '<inductionLoop id="l" lane="east_1_0" pos="10" period="5" file="loops.xml"/></additional>'
    )
    (folder / "scenario.toml").write_text(SCENARIO)
    return folder


def contents(folder: Path) -> Mapping[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_a_run_says_once_what_it_did_not_write(town: Path, tmp_path: Path) -> None:
    before, out = contents(town), tmp_path / "out"
    done = ended("run", town, "--controller", "sumo", "--out", out, folder=town)
    assert contents(town) == before
    assert done.stderr.count("outputs of SUMO") == 1
    assert NOTE in done.stderr
    names = json.loads((out / "run.json").read_text())["outputs_left_out"]
    loose = ["edgeData in det.add.xml", "inductionLoop in det.add.xml"]
    assert names == ["error-log", "fcd-output", "tripinfo-output", *loose]


@pytest.mark.long
def test_two_workers_of_a_batch_write_nothing_there_and_it_is_said_once(town: Path, tmp_path: Path) -> None:
    before = contents(town)
    study = write_study(tmp_path / "study", scenarios=[str(town)], set={"duration_s": 8.0})
    done = ended("batch", study, "--out", tmp_path / "out", "--jobs", 2, folder=town)
    assert contents(town) == before
    assert done.stderr.count("outputs of SUMO") == 1
    assert NOTE in done.stderr


def test_inspection_writes_nothing_there(town: Path) -> None:
    before = contents(town)
    ended("inspect", town / "town.sumocfg", folder=town, code=1)
    assert contents(town) == before
