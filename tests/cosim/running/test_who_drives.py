"""Egos that have to wait before they are taken over, and cars that are no egos although they could be."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pandas as pd
import pytest
import sumo

import cosim
from tests.cosim.tracks import networks

pytestmark = pytest.mark.sumo

DEMAND = """<routes><vType id="car" length="4.5"/>
<flow id="f" type="car" begin="0" end="200" period="8"><route edges="e1 e2"/></flow>
<vehicle id="parked" type="car" depart="2" departPos="5"><route edges="w1 w2"/>
<stop lane="w1_1" startPos="5" endPos="20" duration="15"/></vehicle></routes>"""


def configured(folder: Path, begin_s: float = 0.0, state: str = "") -> Path:
    networks.street(folder)
    (folder / "r.rou.xml").write_text(DEMAND)
    path = folder / "street.sumocfg"
    path.write_text(
        f'<configuration><net-file value="street.net.xml"/><route-files value="r.rou.xml"/>{state}'
        f'<begin value="{begin_s:g}"/><end value="40"/><step-length value="0.1"/></configuration>'
    )
    return path


def test_a_run_does_not_end_while_a_vehicle_that_is_to_be_an_ego_stands_at_its_stop(tmp_path: Path) -> None:
    configured(tmp_path)
    program = Path(sumo.SUMO_HOME) / "bin" / "sumo"
    options = ("--lateral-resolution", "0.4", "--save-state.times", "10", "--save-state.files", "state.xml")
    subprocess.run(
        [str(program), "-c", "street.sumocfg", *options, "--end", "11"],
        cwd=tmp_path,
        check=True,
        capture_output=True,
    )
    path = configured(tmp_path, 10.0, '<load-state value="state.xml"/>')
    run = cosim.run(path, controller="sumo", ego_vehicle="parked", out=tmp_path / "run")
    assert run.valid
    egos = pd.read_parquet(tmp_path / "run" / "egos.parquet")
    assert set(egos["ego_id"]) == {"parked"}
    assert egos["front_x_m"].min() < 100.0


def test_a_recorded_vehicle_is_no_ego_of_a_share(tmp_path: Path) -> None:
    configured(tmp_path)
    rows = "".join(
        f"recorded,passenger,e1,{0.1 * k:.1f},{20 + 0.8 * k:.2f},-1.6,0,8,4.5,1.8\n" for k in range(6, 90)
    )
    heads = "vehicle,class,edge,time_s,x_m,y_m,heading_rad,speed_mps,length_m,width_m\n"
    (tmp_path / "v.csv").write_text(heads + rows)
    (tmp_path / "scenario.toml").write_text(
        'description = "one recorded car"\nduration_s = 15.0\nsumocfg = "street.sumocfg"\n'
        'recorded_vehicles = "v.csv"\n'
    )
    run = cosim.run(tmp_path, controller="aeb", ego_share=1.0, out=tmp_path / "run", record="everybody")
    assert run.valid
    assert "recorded" not in set(pd.read_parquet(tmp_path / "run" / "egos.parquet")["ego_id"])
    assert "recorded" in set(pd.read_parquet(tmp_path / "run" / "traffic.parquet")["object_id"])
