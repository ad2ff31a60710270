"""Types of road users in the place of those that a configuration declares."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest

from sumo_scenarios.library import ScenarioError, load, prepare

CONFIGURATION = """<configuration><input><net-file value="a.net.xml"/>
<additional-files value="t.add.xml,other.add.xml"/></input></configuration>"""


def write(folder: Path, types: str) -> Path:
    (folder / "a.net.xml").write_text("<net/>")
    (folder / "t.add.xml").write_text('<additional><vType id="car" accel="9"/><vType id="bus"/></additional>')
    (folder / "other.add.xml").write_text("<additional/>")
    (folder / "a.sumocfg").write_text(CONFIGURATION)
    (folder / "own.add.xml").write_text(f"<additional>{types}</additional>")
    (folder / "scenario.toml").write_text(
        'description = "a"\nduration_s = 10.0\nstep_s = 0.1\nsumocfg = "a.sumocfg"\ntypes = "own.add.xml"\n'
    )
    return folder


def test_the_types_replace_those_of_their_ids_and_are_part_of_the_inputs(tmp_path: Path) -> None:
    write(tmp_path, '<vType id="car" accel="1.5"/>')
    prepared = prepare(load(str(tmp_path)), 1, tmp_path / "work")
    copy = Path(prepared.options[1])
    (names,) = (one.get("value", "") for one in ElementTree.parse(copy).getroot().iter("additional-files"))
    roots = [ElementTree.parse(copy.parent / name).getroot() for name in names.split(",")]
    types = [(one.get("id"), one.get("accel")) for root in roots for one in root.iter("vType")]
    assert types == [("car", "1.5"), ("bus", None)]
    assert "types" in prepared.inputs
    assert 'accel="9"' in (tmp_path / "t.add.xml").read_text()


def test_types_that_replace_nothing_or_are_missing_are_refused(tmp_path: Path) -> None:
    write(tmp_path, '<vType id="tram"/>')
    with pytest.raises(ScenarioError, match="'tram' replaces nothing"):
        prepare(load(str(tmp_path)), 1, tmp_path / "work")
    (tmp_path / "own.add.xml").unlink()
    with pytest.raises(ScenarioError, match=r"own\.add\.xml"):
        prepare(load(str(tmp_path)), 1, tmp_path / "work")


def test_a_network_of_plain_sources_has_its_types_in_the_demand(tmp_path: Path) -> None:
    (tmp_path / "scenario.toml").write_text(
        'description = "a"\nduration_s = 10.0\ntypes = "own.add.xml"\n'
        '[network]\nnodes = "n"\nedges = "e"\n[demand]\nroutes = ["r"]\n'
    )
    with pytest.raises(ScenarioError, match="'types' belongs to a configuration"):
        load(str(tmp_path))
