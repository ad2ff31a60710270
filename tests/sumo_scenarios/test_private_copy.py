"""What a run takes from a user's configuration, and that it writes nothing beside the user's files."""

from __future__ import annotations

import gzip
import re
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest
import sumo

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.library import LIBRARY, load, prepare
from sumo_scenarios.sumo_options import INPUT_FILES, kept_options, long_name

NETGENERATE = Path(sumo.SUMO_HOME) / "bin" / "netgenerate"
SUMO = Path(sumo.SUMO_HOME) / "bin" / "sumo"
DETECTORS = """<additional>
<inductionLoop id="loop" lane="A0A1_0" pos="10" period="10" file="loops.xml"/>
<instantInductionLoop id="instant" lane="A0A1_0" pos="12" file="instants.xml"/>
<laneAreaDetector id="area" lane="A0A1_0" pos="10" length="20" period="10" file="areas.xml"/>
<entryExitDetector id="ends" period="10" file="ends.xml">
    <detEntry lane="A0A1_0" pos="5"/><detExit lane="A0A1_0" pos="50"/></entryExitDetector>
<edgeData id="edges" period="10" file="edges.xml"/>
<routeProbe id="probe" edge="A0A1" period="10" file="probe.xml"/>
<vTypeProbe id="types" type="car" period="10" file="types.xml"/>
<timedEvent type="SaveTLSStates" source="B1" dest="states.xml"/>
<timedEvent type="SaveTLSSwitchTimes" source="B1" dest="switches.xml"/>
<timedEvent type="SaveTLSProgram" source="B1" dest="program.xml"/>
<calibrator id="count" lane="A0A1_0" pos="1" period="10" output="calibrated.xml"><route id="up" edges="A0A1"/>
    <flow begin="0" end="30" vehsPerHour="300" route="up"/></calibrator>
<tlLogic id="B1" type="actuated" programID="mine" offset="0">{phases}
    <param key="file" value="signals.xml"/></tlLogic>
<include href="{included}"/>
</additional>"""
INCLUDED = '<additional><laneData id="lanes" period="10" file="lanes.xml"/></additional>'
CARS = """<routes><vType id="car"><param key="has.ssm.device" value="true"/></vType>
<vType id="named"><param key="has.ssm.device" value="true"/><param key="device.ssm.file" value="ssm.xml"/>
<param key="has.toc.device" value="true"/><param key="device.toc.manualType" value="car"/>
<param key="device.toc.automatedType" value="named"/><param key="device.toc.file" value="toc.xml"/></vType>
<flow id="f" type="car" begin="0" end="30" period="3" from="A0A1" to="B1B0"/>
<flow id="g" type="named" begin="0" end="30" period="3" from="A0A1" to="B1B0"/></routes>"""
CONFIGURATION = """<configuration>
<input><net value="net/town.net.xml"/><r value="cars.rou.xml.gz, more.rou.xml"/>
<additional value="net/detectors.add.xml"/></input>
<time><begin value="0"/><end value="40"/></time>
<output>{outputs}<output-prefix value="mine-"/><save-state.times value="20"/>
<tripinfo-output.write-unfinished value="true"/></output>
<report><l value="log.txt"/><no-step-log value="true"/></report>
<processing><tls.all-off value="true"/></processing>
<gui_only><osg-view value="true"/><game value="true"/><start value="true"/></gui_only>
</configuration>"""


def sumos_options(tmp_path: Path) -> dict[str, list[str]]:
    """Return the names of the installed SUMO's options that take files: the long one, and all of them."""
    template = tmp_path / "template.xml"
    subprocess.run([SUMO, "--save-template", template], check=True, capture_output=True)
    elements = ElementTree.parse(template).iter()
    files = [one for one in elements if one.get("type") == "FILE" or one.tag.startswith("device.ssm.file")]
    return {one.tag: [one.tag, *one.get("synonymes", "").split()] for one in files}


@pytest.fixture
def town(tmp_path: Path) -> Path:
    folder = tmp_path / "user"
    (folder / "net").mkdir(parents=True)
    net = str(folder / "net" / "town.net.xml")
    command = [str(NETGENERATE), "--grid", "--grid.number", "2", "--tls.set", "B1", "-o", net]
    subprocess.run([*command, "--tls.default-type", "actuated"], check=True, capture_output=True)
    text = Path(net).read_text()
    logic = text[text.index("<tlLogic") : text.index("</tlLogic>")]
    phases = logic[logic.index("<phase") :]
    Path(net).write_text(text.replace("</tlLogic>", '<param key="file" value="of-network.xml"/></tlLogic>'))
    detectors = DETECTORS.format(included="more.add.xml", phases=phases)
    # As another program may write it: no name of an attribute is seen in its bytes.
    (folder / "net" / "detectors.add.xml").write_text(detectors, encoding="utf-16")
    (folder / "net" / "more.add.xml").write_text(INCLUDED)
    (folder / "cars.rou.xml.gz").write_bytes(gzip.compress(CARS.encode()))
    (folder / "more.rou.xml").write_text("<routes/>")
    written = {name: texts for name, texts in sumos_options(tmp_path).items() if name not in INPUT_FILES}
    left_out = ("configuration-file", "save-configuration", "save-template", "save-schema", "log")
    names = [texts[-1] for name, texts in written.items() if name not in left_out]
    outputs = "".join(f'<{name} value="{name}.xml"/>' for name in names)
    (folder / "town.sumocfg").write_text(CONFIGURATION.format(outputs=outputs))
    return folder


def test_every_option_of_sumo_that_takes_a_file_is_an_input_or_left_out(tmp_path: Path) -> None:
    options = sumos_options(tmp_path)
    assert set(options) >= INPUT_FILES
    for name, texts in options.items():
        for text in texts:
            assert long_name(text) == name
        assert bool(kept_options({name: "x"})) == (name in INPUT_FILES), name


def test_sumo_started_on_the_users_own_configuration_writes_there(town: Path) -> None:
    before = set(town.rglob("*"))
    text = (town / "town.sumocfg").read_text()
    (town / "town.sumocfg").write_text(re.sub("<gui_only>.*</gui_only>|<osg.*?>", "", text))
    subprocess.run([SUMO, "town.sumocfg"], cwd=town, capture_output=True, check=False)
    made = {path.name.removeprefix("mine-") for path in set(town.rglob("*")) - before}
    assert len(made) > 40, "or the test below would show nothing"
    assert {"tripinfo.xml", "log.txt", "loops.xml", "switches.xml", "signals.xml", "of-network.xml"} <= made


def test_a_run_writes_nothing_into_the_users_folder(town: Path, tmp_path: Path) -> None:
    before = sorted(town.rglob("*"))
    work = tmp_path / "work"
    work.mkdir()
    prepared = prepare(load(str(town / "town.sumocfg")), 1, work)
    made = sorted(work.rglob("*"))
    done = subprocess.run([SUMO, *prepared.options], cwd=town, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "Error" not in done.stderr
    assert sorted(town.rglob("*")) == before
    assert sorted(work.rglob("*")) == made
    for name in ("tripinfo-output", "log", "laneData in more.add.xml", "device.toc.file in cars.rou.xml.gz"):
        assert name in prepared.left_out
    assert "tripinfo-output.write-unfinished" not in prepared.left_out


def test_demand_of_a_scenario_of_our_own_writes_nothing_either(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    shutil.copytree(LIBRARY / "midblock_zebra", folder)
    shutil.copytree(LIBRARY / "road_users", tmp_path / "road_users")
    definition = (folder / "scenario.toml").read_text()
    stolen = tmp_path / "stolen.xml"
    (folder / "more.add.xml").write_text(
        f'<additional><edgeData id="edges" file="{stolen}"/><edgeData id="up" file="../../up.xml"/></additional>'
    )
    definition = definition.replace("additional = [", 'additional = ["more.add.xml", ')
    (folder / "scenario.toml").write_text(definition)
    prepared = prepare(load(str(folder)), 1, tmp_path / "work")
    assert prepared.left_out == ("edgeData in more.add.xml",)
    subprocess.run([SUMO, *prepared.options, "--end", "5"], cwd=tmp_path, check=True, capture_output=True)
    assert not stolen.exists()
    assert not list(tmp_path.rglob("up.xml"))


def test_a_file_that_includes_itself_is_refused(town: Path, tmp_path: Path) -> None:
    (town / "net" / "more.add.xml").write_text('<additional><include href="detectors.add.xml"/></additional>')
    with pytest.raises(ScenarioError, match="includes itself"):
        prepare(load(str(town / "town.sumocfg")), 1, tmp_path)


def test_the_copy_keeps_what_the_configuration_asks_for(town: Path, tmp_path: Path) -> None:
    prepared = prepare(load(str(town / "town.sumocfg")), 1, tmp_path)
    text = Path(prepared.options[1]).read_text()
    assert '<tls.all-off value="true"/>' in text
    assert "town.net.xml" in text
    assert "osg-view" not in text
    assert not set(re.findall(r"<([\w.-]*output[\w.-]*) ", text)) - INPUT_FILES
    assert str(town / "more.rou.xml") in text


def test_the_hashes_are_those_of_the_users_files(town: Path, tmp_path: Path) -> None:
    inputs = prepare(load(str(town / "town.sumocfg")), 1, tmp_path).inputs
    assert {"town.sumocfg", "net/town.net.xml", "cars.rou.xml.gz", "net/detectors.add.xml"} <= set(inputs)
    (town / "net" / "more.add.xml").write_text("<additional/>")
    assert prepare(load(str(town / "town.sumocfg")), 1, tmp_path).inputs != inputs
