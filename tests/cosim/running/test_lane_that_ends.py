"""A lane that leads only to the right, a crossing at its end, and an ego in it that has to go straight on."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pandas as pd
import pytest
import sumo

from analysis.recording.reading import read_run
from cosim.running.request import RunRequest
from cosim.running.simulation import run

pytestmark = pytest.mark.sumo

NODES = (
    '<nodes><node id="a" x="0" y="0"/><node id="j" x="200" y="0" type="priority"/><node id="b" x="400" y="0"/>'
    '<node id="s" x="200" y="-200"/></nodes>'
)
EDGES = (
    '<edges><edge id="in" from="a" to="j" numLanes="2" speed="13.89" priority="3"/>'
    '<edge id="out" from="j" to="b" numLanes="1" speed="13.89" priority="3"/>'
    '<edge id="onward" from="b" to="j" numLanes="1" speed="13.89" priority="3"/>'
    '<edge id="back" from="j" to="a" numLanes="1" speed="13.89" priority="3"/>'
    '<edge id="right" from="j" to="s" numLanes="1" speed="13.89"/></edges>'
)
CONNECTIONS = (
    '<connections><connection from="in" to="right" fromLane="0" toLane="0"/>'
    '<connection from="in" to="out" fromLane="1" toLane="0"/>'
    '<connection from="onward" to="back"/>'
    '<crossing node="j" edges="in back" priority="true" width="4"/></connections>'
)
PLACES = (154, 142, 130, 118, 106, 94, 82)
ROUTE = '<route edges="in out"/>'


def _town(folder: Path) -> Path:
    for name, text in (("nod", NODES), ("edg", EDGES), ("con", CONNECTIONS)):
        (folder / f"{name}.xml").write_text(text)
    options = ["-n", "nod.xml", "-e", "edg.xml", "-x", "con.xml", "--sidewalks.guess", "--no-turnarounds"]
    options += ["--sidewalks.guess.max-speed", "20", "-o", "town.net.xml"]
    netconvert = str(Path(sumo.SUMO_HOME) / "bin" / "netconvert")
    subprocess.run([netconvert, *options], cwd=folder, check=True, capture_output=True)
    # Lanes 1 and 2: 0 is the pavement. Cars beside and behind the ego leave it no gap at first.
    column = "".join(
        f'<vehicle id="car{place}" type="car" depart="0" departLane="2" departPos="{place}" departSpeed="7">'
        f"{ROUTE}</vehicle>"
        for place in PLACES
    )
    (folder / "town.rou.xml").write_text(
        '<routes><vType id="car" vClass="passenger" sigma="0" speedDev="0" maxSpeed="7"/>'
        f'{column}<vehicle id="ego" type="car" depart="0" departLane="1" departPos="140" departSpeed="7">'
        f"{ROUTE}</vehicle></routes>"
    )
    path = folder / "town.sumocfg"
    path.write_text(
        '<configuration><input><net-file value="town.net.xml"/><route-files value="town.rou.xml"/></input>'
        '<time><end value="60"/><step-length value="0.1"/></time></configuration>'
    )
    return path


@pytest.mark.long
def test_an_ego_that_found_no_gap_leaves_the_lane_before_the_crossing_at_its_end(tmp_path: Path) -> None:
    out = tmp_path / "run"
    result = run(RunRequest(str(_town(tmp_path)), controller="vo_mpc", ego_vehicle="ego", out=out))
    assert result.valid, result.invalid_reason
    egos = pd.read_parquet(out / "egos.parquet")
    beside = {f"car{place}" for place in PLACES}
    assert beside & set(egos["because"].dropna())  # there was no gap at first
    changing = egos[egos["manoeuvre"] == "change_left"]
    assert changing["speed_mps"].iloc[0] < 1.0  # it had to wait, and had kept room to steer out
    crossing = min(area.shape[:, 0].min() for area in read_run(out).crossings())
    over_the_line = egos[egos["lane"] == "in_2"]
    assert over_the_line["front_x_m"].min() < crossing
    assert egos["edge"].iloc[-1] == "out"
    assert egos["front_x_m"].iloc[-1] > 380.0
