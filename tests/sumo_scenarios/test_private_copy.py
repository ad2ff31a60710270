"""What a run takes from a user's configuration, and that it writes nothing beside the user's files."""

from __future__ import annotations

import gzip
import subprocess
from pathlib import Path

import pytest
import sumo

from sumo_scenarios.library import load, prepare

NETGENERATE = Path(sumo.SUMO_HOME) / "bin" / "netgenerate"
SUMO = Path(sumo.SUMO_HOME) / "bin" / "sumo"
DETECTORS = """<additional>
<inductionLoop id="loop" lane="A0A1_0" pos="10" period="10" file="loops.xml"/>
<laneAreaDetector id="area" lane="A0A1_0" pos="10" length="20" period="10" file="areas.xml"/>
<edgeData id="edges" period="10" file="edges.xml"/>
<routeProbe id="probe" edge="A0A1" period="10" file="probe.xml"/>
<include href="{included}"/>
</additional>"""
INCLUDED = '<additional><laneData id="lanes" period="10" file="lanes.xml"/></additional>'
CARS = """<routes><vType id="car"><param key="has.ssm.device" value="true"/>
<param key="device.ssm.file" value="ssm.xml"/></vType>
<flow id="f" type="car" begin="0" end="30" period="3" from="A0A1" to="B1B0"/></routes>"""
CONFIGURATION = """<configuration>
<input><net-file value="net/town.net.xml"/><route-files value="cars.rou.xml.gz, more.rou.xml"/>
<additional-files value="net/detectors.add.xml"/></input>
<time><begin value="0"/><end value="40"/></time>
<output><tripinfo-output value="trips.xml"/><fcd-output value="fcd.xml"/><summary-output value="summary.xml"/>
<netstate-dump value="dump.xml"/><output-prefix value="mine-"/></output>
<report><log value="log.txt"/><no-step-log value="true"/></report>
<processing><tls.all-off value="true"/></processing>
<gui_only><osg-view value="true"/><game value="true"/><start value="true"/></gui_only>
</configuration>"""


@pytest.fixture
def town(tmp_path: Path) -> Path:
    folder = tmp_path / "user"
    (folder / "net").mkdir(parents=True)
    net = str(folder / "net" / "town.net.xml")
    command = [str(NETGENERATE), "--grid", "--grid.number", "2", "-o", net]
    subprocess.run(command, check=True, capture_output=True)
    (folder / "net" / "detectors.add.xml").write_text(DETECTORS.format(included="more.add.xml"))
    (folder / "net" / "more.add.xml").write_text(INCLUDED)
    (folder / "cars.rou.xml.gz").write_bytes(gzip.compress(CARS.encode()))
    (folder / "more.rou.xml").write_text("<routes/>")
    (folder / "town.sumocfg").write_text(CONFIGURATION)
    return folder


def test_a_run_writes_nothing_into_the_users_folder(town: Path, tmp_path: Path) -> None:
    before = sorted(town.rglob("*"))
    work = tmp_path / "work"
    work.mkdir()
    prepared = prepare(load(str(town / "town.sumocfg")), 1, work)
    done = subprocess.run([SUMO, *prepared.options], cwd=town, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "Error" not in done.stderr
    assert sorted(town.rglob("*")) == before


def test_the_copy_keeps_what_the_configuration_asks_for(town: Path, tmp_path: Path) -> None:
    prepared = prepare(load(str(town / "town.sumocfg")), 1, tmp_path)
    text = Path(prepared.options[1]).read_text()
    assert '<tls.all-off value="true"/>' in text
    assert str(town / "net" / "town.net.xml") in text
    assert "osg-view" not in text
    assert "output" not in text
    assert str(town / "more.rou.xml") in text


def test_the_hashes_are_those_of_the_users_files(town: Path, tmp_path: Path) -> None:
    inputs = prepare(load(str(town / "town.sumocfg")), 1, tmp_path).inputs
    assert {"town.sumocfg", "net/town.net.xml", "cars.rou.xml.gz", "net/detectors.add.xml"} <= set(inputs)
    (town / "net" / "more.add.xml").write_text("<additional/>")
    assert prepare(load(str(town / "town.sumocfg")), 1, tmp_path).inputs != inputs
