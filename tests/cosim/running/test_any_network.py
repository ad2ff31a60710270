"""Networks that are none of ours: a grid from netgenerate, with whatever else its configuration asks for."""

from __future__ import annotations

import gzip
import subprocess
from pathlib import Path

import pandas as pd
import pytest
import sumo

from cosim.running.request import RunRequest
from cosim.running.simulation import run

pytestmark = pytest.mark.sumo

TYPES = (
    '<vType id="car" vClass="passenger"/><vType id="bike" vClass="bicycle"/><vType id="bus" vClass="bus"/>'
    '<vType id="lorry" vClass="truck" length="12"/>'
)
DEMAND = """<routes>{types}
<flow id="across" type="car" begin="0" end="60" period="4" from="left1A1" to="B1right1" departLane="random"/>
<flow id="cyclists" type="bike" begin="0" end="60" period="9" from="left0A0" to="B0right0"/>
<personFlow id="walkers" begin="0" end="60" period="2"><walk from="left1A1" to="A1top0"/></personFlow>
<personFlow id="others" begin="0" end="60" period="3"><walk from="A0bottom0" to="A0A1"/></personFlow>
<flow id="turning" type="car" begin="1" end="60" period="6" from="left1A1" to="A1top0"/>
<flow id="lorries" type="lorry" begin="2" end="60" period="15" from="right1B1" to="A1left1"/>
<vehicle id="mine" type="car" depart="2"><route edges="left0A0 A0A1 A1B1 B1right1"/></vehicle>
<flow id="coaches" type="bus" begin="3" end="60" period="20" from="top0A1" to="A0bottom0"/>
</routes>"""
OWN_WILL = (
    '<processing><lateral-resolution value="0.8"/><collision.action value="remove"/>'
    '<time-to-teleport value="5"/><step-method.ballistic value="true"/></processing>'
    '<report><verbose value="true"/></report><traci_server><remote-port value="8813"/></traci_server>'
)
SUDDEN_CHANGES = (
    '<processing><lanechange.duration value="3"/><collision.action value="teleport"/></processing>'
)


@pytest.fixture(scope="module")
def grid(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a grid of two by two junctions, one with signals, and its demand."""
    folder = tmp_path_factory.mktemp("grid")
    size = ["--grid", "--grid.number", "2", "--grid.length", "120", "--grid.attach-length", "100", "-L", "2"]
    walks = ["--sidewalks.guess", "--crossings.guess", "--no-turnarounds", "--tls.set", "A1"]
    speed = ["--default.speed", "13.89", "--sidewalks.guess.max-speed", "20"]
    netgenerate = str(Path(sumo.SUMO_HOME) / "bin" / "netgenerate")
    command = [netgenerate, *size, *walks, *speed, "-o", "grid.net.xml"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    (folder / "packed.net.xml.gz").write_bytes(gzip.compress((folder / "grid.net.xml").read_bytes()))
    (folder / "demand.rou.xml").write_text(DEMAND.format(types=TYPES))
    return folder


def _configuration(folder: Path, net: str, step: str, extra: str) -> str:
    path = folder / f"grid{step}.sumocfg"
    path.write_text(
        f'<configuration><input><net-file value="{net}"/><route-files value="demand.rou.xml"/></input>'
        f'<time><end value="60"/><step-length value="{step}"/></time>{extra}</configuration>'
    )
    return str(path)


@pytest.mark.long
@pytest.mark.parametrize(
    ("net", "step", "extra", "request_"),
    [
        ("grid.net.xml", "0.05", "", {"ego_route": ("left1A1", "A1A0", "A0bottom0"), "controller": "vo_mpc"}),
        ("packed.net.xml.gz", "0.25", "", {"ego_share": 0.5, "controller": "vo_mpc"}),
        ("grid.net.xml", "1.0", OWN_WILL, {"ego_share": 0.5, "controller": "aeb"}),
        ("grid.net.xml", "0.5", SUDDEN_CHANGES, {"ego_vehicle": "mine", "controller": "vo_mpc"}),
        ("grid.net.xml", "0.5", "", {"ego_vehicle": "cyclists.0", "controller": "aeb"}),
        ("grid.net.xml", "0.5", "", {"ego_vehicle": "coaches.0", "controller": "vo_mpc"}),
        ("grid.net.xml", "0.25", "", {"ego_vehicle": "lorries.0", "controller": "aeb", "actuation": "move"}),
        ("grid.net.xml", "0.5", "", {"ego_share": 0.5, "controller": "sumo"}),
        ("grid.net.xml", "0.5", "", {"ego_vehicle": "mine", "controller": "constant_speed"}),
    ],
)
def test_egos_drive_in_it_to_the_end_of_the_run(
    grid: Path, tmp_path: Path, net: str, step: str, extra: str, request_: dict[str, object]
) -> None:
    scenario = _configuration(grid, net, step, extra)
    out = tmp_path / "run"
    result = run(RunRequest(scenario, duration_s=25.0, out=out, **request_))  # type: ignore[arg-type]
    assert result.valid, result.invalid_reason
    egos = pd.read_parquet(out / "egos.parquet")
    assert egos["ego_id"].nunique() >= (3 if "ego_share" in request_ else 1)
    assert egos["route_position_m"].max() > 60.0
    if request_["controller"] in ("vo_mpc", "aeb"):
        assert egos["solved"].dropna().all()
        # No ego exceeds its lane's limit by much; in bends it is the limit of the lane just entered.
        assert (egos["speed_mps"] <= 13.89 + 0.5).all()
    if request_.get("ego_vehicle") == "cyclists.0":
        assert egos["speed_mps"].max() < 7.0  # 20 km/h, and the speed factor that it came with
        assert egos["width_m"].max() < 1.0
