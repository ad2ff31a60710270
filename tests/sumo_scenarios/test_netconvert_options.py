"""What a scenario may ask of netconvert, against the list of netconvert's own options."""

from __future__ import annotations

import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest

from sumo_scenarios.errors import ScenarioError
from sumo_scenarios.netconvert_options import ALLOWED, check_options, is_allowed
from sumo_scenarios.schema import read_table
from sumo_scenarios.sumo_installation import netconvert

SCENARIO = """description = "d"
duration_s = 60.0
[network]
nodes = "n.nod.xml"
edges = "e.edg.xml"
netconvert = {words}
[demand]
routes = ["r.rou.xml"]
"""


def test_no_allowed_option_names_a_file(tmp_path: Path) -> None:
    template = tmp_path / "template.xml"
    subprocess.run([netconvert(), "--save-template", template], check=True, capture_output=True)
    options = {one.tag: one.get("type") for one in ElementTree.parse(template).iter() if one.get("type")}
    allowed = {name: kind for name, kind in options.items() if is_allowed(name)}
    assert {name for name, kind in allowed.items() if kind == "FILE"} == set()
    unknown = [start for start in ALLOWED if not any(name.startswith(start) for name in allowed)]
    assert unknown == []


@pytest.mark.parametrize(
    "words",
    [
        ["--plain-output-prefix", "/tmp/mine"],
        ["--output-file=/tmp/mine.net.xml"],
        ["--junctions.join-output", "/tmp/joins.xml"],
        ["--tls.layout", "opposites", "--log", "/tmp/log.txt"],
        ["-o", "/tmp/mine.net.xml"],
        ["-t/tmp/types.xml"],
        ["mine.netccfg"],
        ["--tls.layout", "opposites", "mine.netccfg"],
    ],
)
def test_an_option_that_names_a_file_is_refused_in_one_line(words: list[str], tmp_path: Path) -> None:
    file = tmp_path / "scenario.toml"
    file.write_text(SCENARIO.format(words=words))
    with pytest.raises(
        ScenarioError, match=r"scenario\.toml: network\.netconvert: .*(allowed|expected)"
    ) as told:
        read_table(file)
    assert "\n" not in str(told.value)


def test_options_of_how_a_network_is_built_are_taken() -> None:
    check_options(["--tls.layout", "opposites", "--offset.x", "-12.5", "--junctions.join", "--lefthand=true"])
