"""An ego that comes to a stop sign with nobody near: it stops, and drives on."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pandas as pd
import pytest
import sumo

from cosim.running.request import RunRequest
from cosim.running.simulation import run

pytestmark = pytest.mark.sumo


@pytest.mark.parametrize("controller", ["vo_mpc", "aeb"])
def test_an_ego_stops_at_the_sign_and_drives_on(controller: str, tmp_path: Path) -> None:
    netgenerate = Path(sumo.SUMO_HOME) / "bin" / "netgenerate"
    options = ["--grid", "--grid.number=3", "--grid.length=100", "--default-junction-type=allway_stop"]
    walks = ["--sidewalks.guess", "--crossings.guess", "--no-turnarounds"]
    net = ["-o", str(tmp_path / "town.net.xml")]
    subprocess.run([str(netgenerate), *options, *walks, *net], check=True, capture_output=True)
    (tmp_path / "town.rou.xml").write_text(
        '<routes><vehicle id="ego" depart="0"><route edges="B0B1 B1B2"/></vehicle></routes>'
    )
    config = tmp_path / "town.sumocfg"
    config.write_text(
        '<configuration><input><net-file value="town.net.xml"/><route-files value="town.rou.xml"/></input>'
        '<time><end value="60"/><step-length value="0.1"/></time></configuration>'
    )
    out = tmp_path / "run"
    ran = run(RunRequest(str(config), controller=controller, ego_vehicle="ego", out=out))
    assert ran.valid, ran.invalid_reason
    egos = pd.read_parquet(out / "egos.parquet")
    before = egos[egos["edge"] == "B0B1"]
    assert before["speed_mps"].min() < 0.3
    assert before["front_y_m"].iloc[before["speed_mps"].argmin()] == pytest.approx(
        before["front_y_m"].max(), abs=4.0
    )
    assert egos["edge"].iloc[-1] == "B1B2"
    standing = egos[egos["speed_mps"] < 0.3]
    assert standing["time_s"].max() - standing["time_s"].min() < 5.0, "it does not wait for nobody"
