"""Routes that end on an edge which a vehicle passes within one step."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
import sumo

from cosim.running.request import RunRequest
from cosim.running.simulation import run

pytestmark = pytest.mark.sumo

NODES = """<nodes><node id="a" x="0" y="0"/><node id="b" x="150" y="0"/><node id="c" x="156" y="0"/>
<node id="d" x="300" y="0"/></nodes>"""
EDGES = """<edges><edge id="ab" from="a" to="b" speed="13.9"/><edge id="bc" from="b" to="c" speed="13.9"/>
<edge id="cd" from="c" to="d" speed="13.9"/></edges>"""
CARS = '<routes><flow id="car" begin="0" end="30" period="5"><route edges="ab bc"/></flow></routes>'


@pytest.mark.parametrize("controller", ["sumo", "aeb"])
def test_egos_that_arrive_there_were_not_teleported(tmp_path: Path, controller: str) -> None:
    for name, text in (("n.nod", NODES), ("e.edg", EDGES), ("cars.rou", CARS)):
        (tmp_path / f"{name}.xml").write_text(text)
    netconvert = str(Path(sumo.SUMO_HOME) / "bin" / "netconvert")
    command = [netconvert, "-n", "n.nod.xml", "-e", "e.edg.xml", "-o", "street.net.xml"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    scenario = tmp_path / "street.sumocfg"
    scenario.write_text(
        '<configuration><net-file value="street.net.xml"/><route-files value="cars.rou.xml"/>'
        '<step-length value="1"/></configuration>'
    )
    request = RunRequest(str(scenario), controller, ego_share=1.0, duration_s=40.0, out=tmp_path / "run")
    result = run(request)
    assert result.valid, result.invalid_reason
